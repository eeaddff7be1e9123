// Traces of drives that were written by hand: faults of single drives are found in them.

#include "host_tools/lib/diagnose/drive/trace_effect.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::int64_t kRow_ns = 50'000'000;
constexpr double kDrive_s = 60.0;
constexpr int kDrives = 8;

std::int64_t ns(double time_s) {
  return std::llround(time_s * 1e9);
}

/// Heading of a vehicle that turns by a right angle in the middle of each minute, left and right in
/// turn, within 4 s.
double heading_rad(double time_s) {
  constexpr double kTurn_s = 4.0;
  double heading = 0.0;
  for (int drive = 0; drive < kDrives; ++drive) {
    const double share = (time_s - kDrive_s * (drive + 0.5)) / kTurn_s + 0.5;
    const double done =
        0.5 - 0.5 * std::cos(std::numbers::pi * std::min(std::max(share, 0.0), 1.0));
    heading += (drive % 2 == 0 ? 0.5 : -0.5) * std::numbers::pi * done;
  }
  return heading;
}

/// @param reference_rad heading by the reference at a time
Trace trace_of(const std::function<double(double)>& reference_rad) {
  Trace trace{.longest_ns = ns(2.0),
              .row_interval_s = units::seconds(kRow_ns),
              .reference_interval_s = units::seconds(kRow_ns)};
  for (std::int64_t time_ns = 0; time_ns <= ns(kDrive_s * kDrives); time_ns += kRow_ns) {
    trace.gyro_rad.add(time_ns, heading_rad(units::seconds(time_ns)));
    trace.reference_rad.add(time_ns, reference_rad(units::seconds(time_ns)));
  }
  for (int k = 0; k < kDrives; ++k) {
    trace.drives.push_back({.number = static_cast<std::size_t>(k),
                            .all = {ns(kDrive_s * k), ns(kDrive_s * (k + 1))},
                            .moving = {ns(kDrive_s * k + 5.0), ns(kDrive_s * (k + 1) - 5.0)}});
  }
  return trace;
}

TEST(TraceByHand, EqualTurnsShowNothing) {
  EXPECT_TRUE(find_in_trace(trace_of(heading_rad)).empty());
}

TEST(TraceByHand, AScaleFactorIsNoFault) {
  EXPECT_TRUE(
      find_in_trace(trace_of([](double time_s) { return 1.04 * heading_rad(time_s); })).empty());
}

TEST(TraceByHand, ADelayIsFoundInBothSenses) {
  for (const double delay_s : {0.3, -0.3, 1.5}) {
    const auto late = [&](double time_s) { return heading_rad(time_s - delay_s); };
    // Turns that differ from drive to drive, so that there is a scatter.
    const auto findings = find_in_trace(trace_of([&](double time_s) {
      return late(time_s) * (1.0 + 1e-3 * std::floor(time_s / kDrive_s));
    }));
    ASSERT_EQ(findings.size(), 1) << delay_s;
    EXPECT_EQ(findings[0].effect, "reference_delay");
    EXPECT_NEAR(findings[0].parameters.at(0).value, delay_s, 0.02);
    EXPECT_TRUE(findings[0].drives.empty());
  }
}

TEST(TraceByHand, AJumpSpoilsItsDrive) {
  const double at_s = 2.0 * kDrive_s + 20.0;
  const auto findings = find_in_trace(trace_of([&](double time_s) {
    return heading_rad(time_s) + (time_s > at_s ? 3.0 * units::kRadPerDeg : 0.0);
  }));
  ASSERT_EQ(findings.size(), 1);
  EXPECT_EQ(findings[0].effect, "reference_fault");
  EXPECT_EQ(findings[0].drives, std::vector<std::size_t>{2});
}

TEST(TraceByHand, AJumpOfTheGyroIsNoFaultOfTheReference) {
  Trace trace = trace_of(heading_rad);
  truth::Series jumping;
  for (std::size_t k = 0; k < trace.gyro_rad.size(); ++k) {
    const double jump_rad = k > 4000 ? 0.2 : 0.0;
    jumping.add(trace.gyro_rad.time_ns(k), trace.gyro_rad.value(k) + jump_rad);
  }
  trace.gyro_rad = jumping;
  EXPECT_TRUE(find_in_trace(trace).empty());
}

TEST(TraceByHand, AReferenceThatStandsSpoilsItsDrive) {
  const auto findings = find_in_trace(trace_of([](double time_s) {
    const bool stands = time_s > 3.0 * kDrive_s && time_s < 3.0 * kDrive_s + 50.0;
    return heading_rad(stands ? 3.0 * kDrive_s : time_s);
  }));
  ASSERT_EQ(findings.size(), 1);
  EXPECT_EQ(findings[0].drives, std::vector<std::size_t>{3});
  EXPECT_EQ(findings[0].parameters.at(0).name, "frozen_drives");
}

TEST(TraceByHand, AGapCountsOnlyInATurn) {
  Trace trace = trace_of(heading_rad);
  const double turn_s = 1.5 * kDrive_s;
  trace.gaps = {{ns(turn_s - 0.5), ns(turn_s + 0.5)}, {ns(turn_s + 10.0), ns(turn_s + 11.0)}};
  const auto findings = find_in_trace(trace);
  ASSERT_EQ(findings.size(), 1);
  EXPECT_EQ(findings[0].effect, "gap_in_turn");
  EXPECT_EQ(findings[0].drives, std::vector<std::size_t>{1});
}

}  // namespace
}  // namespace zerorate::diagnose
