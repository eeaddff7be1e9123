/// @file
/// A small node, its samples, and the comparison of two node states.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "firmware/app/gyro_node.hpp"
#include "host_tests/support/sample_modes.hpp"
#include "host_tools/lib/simulate/random_stream.hpp"

namespace zerorate::app::testing {

using Node = GyroNode<4, 0>;

inline constexpr core::Duration kSamplePeriod = core::Duration::milliseconds(10);
inline constexpr core::Duration kTick = core::Duration::milliseconds(100);
inline constexpr float kWhiteSigmaRadS = 1e-3F;

[[nodiscard]] inline core::Instant at_ms(std::int64_t ms) {
  return core::Instant::from_ns(ms * 1'000'000);
}

/// Flicker far below the white noise of a sample; 100 Hz into 10 Hz.
[[nodiscard]] inline Node::Params node_params() {
  auto flicker = zerorate::testing::flicker_like<4>(kTick, 0.5);
  for (float& variance : flicker.variance_rad2_s2) variance *= 1e-9F;
  return {.modes = core::compose(kTick, core::Start::stationary, flicker),
          .white_variance_rad2_s2 = kWhiteSigmaRadS * kWhiteSigmaRadS,
          .sample_period = kSamplePeriod};
}

[[nodiscard]] inline drivers::GyroSample sample_at(core::Instant time, float rate_rad_s) {
  drivers::GyroSample sample{.time = time};
  for (std::size_t i = 0; i < 3; ++i) {
    sample.rate[i] = core::rad_per_s(rate_rad_s * static_cast<float>(i + 1));
  }
  return sample;
}

/// White noise around a bias that is 1, 2 and 3 times `bias` on x, y and z.
[[nodiscard]] inline drivers::GyroSample noisy_sample(core::Instant time, float bias_rad_s,
                                                      std::uint64_t seed = 1) {
  drivers::GyroSample sample = sample_at(time, bias_rad_s);
  for (std::size_t i = 0; i < 3; ++i) {
    const simulate::RandomStream noise{seed, i};
    sample.rate[i] = sample.rate[i] +
                     core::rad_per_s(kWhiteSigmaRadS * static_cast<float>(noise.normal(time.ns())));
  }
  return sample;
}

inline void expect_same(const core::CalibrationMean<4, 0>::State& a,
                        const core::CalibrationMean<4, 0>::State& b) {
  EXPECT_EQ(a.restart, b.restart);
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.age, b.age);
  EXPECT_EQ(a.reference_rad_s, b.reference_rad_s);
  EXPECT_EQ(a.sum_rad_s, b.sum_rad_s);
  EXPECT_EQ(a.lost_rad_s, b.lost_rad_s);
  EXPECT_EQ(a.white_variance_sum, b.white_variance_sum);
}

inline void expect_same(const core::KalmanPredictor<4, 0>::State& a,
                        const core::KalmanPredictor<4, 0>::State& b) {
  EXPECT_EQ(a.confirmations_left, b.confirmations_left);
  EXPECT_EQ(a.reference_rad_s, b.reference_rad_s);
  EXPECT_EQ(a.bias_rad_s, b.bias_rad_s);
  EXPECT_EQ(a.bias_variance, b.bias_variance);
  EXPECT_EQ(a.drift, b.drift);
  EXPECT_EQ(a.bias_covariance, b.bias_covariance);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j <= i; ++j) EXPECT_EQ(a.covariance(i, j), b.covariance(i, j));
  }
}

inline void expect_same(const core::MovingAverage<4, 0>::State& a,
                        const core::MovingAverage<4, 0>::State& b) {
  const auto blocks = [](const core::SuffixSums<>& sums) {
    std::vector<std::pair<std::uint32_t, float>> all;
    sums.for_each_newest_first([&](std::uint32_t size, float sum) {
      all.emplace_back(size, sum);
      return true;
    });
    return all;
  };
  EXPECT_EQ(a.restart, b.restart);
  EXPECT_EQ(a.age, b.age);
  EXPECT_EQ(a.reference_rad_s, b.reference_rad_s);
  EXPECT_EQ(a.white_variance_sum, b.white_variance_sum);
  EXPECT_EQ(a.sums.count(), b.sums.count());
  EXPECT_EQ(blocks(a.sums), blocks(b.sums));
}

inline void expect_same_held(Node::HoldBack a, Node::HoldBack b) {
  const auto items = [](Node::HoldBack& line) {
    std::vector<core::TickMean<3>> all;
    line.release_until(at_ms(1'000'000'000), [&](const auto& item) { all.push_back(item); });
    return all;
  };
  const auto of_a = items(a);
  const auto of_b = items(b);
  ASSERT_EQ(of_a.size(), of_b.size());
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    EXPECT_EQ(of_a[i].tick, of_b[i].tick);
    EXPECT_EQ(of_a[i].samples, of_b[i].samples);
    EXPECT_EQ(of_a[i].end, of_b[i].end);
    EXPECT_EQ(of_a[i].rate_rad_s, of_b[i].rate_rad_s);
  }
}

/// Every field, bit for bit; not memcmp, because padding has no value.
inline void expect_same(const core::OdometerCheck::State& a, const core::OdometerCheck::State& b) {
  EXPECT_EQ(a.level_rad_s, b.level_rad_s);
  using Bits = std::array<std::uint32_t, 3>;  // may be no number, which equals nothing
  EXPECT_EQ(std::bit_cast<Bits>(a.trusted_rad_s), std::bit_cast<Bits>(b.trusted_rad_s));
  EXPECT_EQ(a.sum_rad_s, b.sum_rad_s);
  EXPECT_EQ(a.steady_ticks, b.steady_ticks);
  EXPECT_EQ(a.needed_ticks, b.needed_ticks);
  EXPECT_EQ(a.window_ticks, b.window_ticks);
  EXPECT_EQ(a.bounced_ticks, b.bounced_ticks);
  EXPECT_EQ(a.stands, b.stands);
  EXPECT_EQ(a.turns, b.turns);
}

inline void expect_same(const Node::State& a, const Node::State& b) {
  EXPECT_EQ(a.newest_sample, b.newest_sample);
  EXPECT_EQ(a.has_sample, b.has_sample);
  EXPECT_EQ(a.stop_open, b.stop_open);
  EXPECT_EQ(a.odometer_fault, b.odometer_fault);
  EXPECT_EQ(a.measured_ticks, b.measured_ticks);
  EXPECT_EQ(a.lead, b.lead);
  EXPECT_EQ(a.standstill.last_pulse, b.standstill.last_pulse);
  EXPECT_EQ(a.standstill.silence, b.standstill.silence);
  expect_same(a.odometer, b.odometer);
  EXPECT_EQ(a.standstill.started, b.standstill.started);
  EXPECT_EQ(a.average.started, b.average.started);
  EXPECT_EQ(a.average.origin, b.average.origin);
  EXPECT_EQ(a.average.tick, b.average.tick);
  EXPECT_EQ(a.average.samples, b.average.samples);
  EXPECT_EQ(a.average.end, b.average.end);
  EXPECT_EQ(a.average.first_rad_s, b.average.first_rad_s);
  EXPECT_EQ(a.average.sum_rad_s, b.average.sum_rad_s);
  expect_same_held(a.held, b.held);
  for (std::size_t i = 0; i < 3; ++i) {
    expect_same(a.axes[i].kalman, b.axes[i].kalman);
    expect_same(a.axes[i].moving_average, b.axes[i].moving_average);
    expect_same(a.axes[i].calibration_mean, b.axes[i].calibration_mean);
    EXPECT_EQ(a.axes[i].monitor.count, b.axes[i].monitor.count);
    EXPECT_EQ(a.axes[i].monitor.mean_normalised_squared, b.axes[i].monitor.mean_normalised_squared);
  }
}

}  // namespace zerorate::app::testing
