// Scale factors found by turns by hand, through the node: does the interval hold, and how wide is
// it?

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/evidence/drives/made_noise.hpp"
#include "host_tools/lib/calibrate/calibration.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::drives {
namespace {

constexpr core::ModelShape kShape{.decaying = 6, .hypotheses = model::kMostHypotheses};
using Node = app::GyroNode<kShape, app::NodeCapacity{.axes = 1,
                                                     .held_ticks = 8,
                                                     .runs_moving_average = false,
                                                     .runs_calibration_mean = false}>;
constexpr double kRadPerDeg = double{core::kRadPerDeg};
constexpr double kPeriod_s = 0.04;
/// Samples: 90 s. A new node without an odometer can need half a minute to find its calm; a person
/// waits for the guide to be ready.
constexpr std::size_t kFirstRest = 2250;
constexpr std::size_t kRest = 625;   ///< samples: 25 s
constexpr std::size_t kRound = 100;  ///< samples: 4 s
constexpr std::size_t kCalibrations = 200;

struct Case {
  int turns;
  double mark_sigma_deg;
};

/// Sensor and person of one calibration.
struct Drawn {
  double scale;
  double asymmetry;
  std::vector<double> rate_rad_s;  ///< true
};

/// There and back, each round begun and ended slowly, from mark to mark with the error of each.
Drawn draw(const Case& made, const random::RandomStream& draws) {
  Drawn drawn{
      .scale = 0.005 * draws.normal(0), .asymmetry = 0.002 * draws.normal(1), .rate_rad_s = {}};
  double mark_deg = made.mark_sigma_deg * draws.normal(2);
  drawn.rate_rad_s.assign(kFirstRest, 0.0);
  for (const int sense : {1, -1}) {
    const double next_deg = made.mark_sigma_deg * draws.normal(5 + sense);
    const double turn_rad = (360.0 * made.turns * sense + next_deg - mark_deg) * kRadPerDeg;
    mark_deg = next_deg;
    const std::size_t samples = kRound * static_cast<std::size_t>(made.turns);
    for (std::size_t k = 0; k < samples; ++k) {
      const double phase = (static_cast<double>(k) + 0.5) / double{kRound};
      const double mean_rad_s = turn_rad / (static_cast<double>(samples) * kPeriod_s);
      drawn.rate_rad_s.push_back(2.0 * mean_rad_s *
                                 std::pow(std::sin(std::numbers::pi * phase), 2.0));
    }
    drawn.rate_rad_s.insert(drawn.rate_rad_s.end(), kRest, 0.0);
  }
  return drawn;
}

calibrate::Calibration calibrate_by_hand(const Case& made, const Drawn& drawn,
                                         const random::RandomStream& stream) {
  const auto period = core::Duration::milliseconds(40);
  const Node::Params params{
      .model = model::make_node_model<kShape>(model::find_model("lsm6dso"), period,
                                              core::Duration::milliseconds(520)),
      .standstill = {.source = core::StandstillSource::gyro}};
  Node node{params};
  calibrate::TurnGuide guide{{}};
  const std::vector<double> noise = rest_noise_rad_s(drawn.rate_rad_s.size(), kPeriod_s, stream);
  for (std::size_t k = 0; k < noise.size(); ++k) {
    const double rate = drawn.rate_rad_s[k];
    const double measured =
        noise[k] + (1.0 + drawn.scale) * rate + drawn.asymmetry * std::abs(rate);
    core::GyroSample sample{.time = core::Instant{} + period * static_cast<std::int64_t>(k)};
    sample.rate[0] = core::rad_per_s(static_cast<float>(measured));
    guide.take({.sequence = static_cast<std::uint32_t>(k), .message = node.step(sample)});
  }
  guide.finish();
  return calibrate::calibrate(guide, {.turns = made.turns,
                                      .mark_sigma_rad = made.mark_sigma_deg * kRadPerDeg,
                                      .tolerance = {.sigma = 0.005, .asymmetry_sigma = 0.002}});
}

class TurnsByHand : public ::testing::TestWithParam<Case> {};

// 200 calibrations: a coverage of 0.95 has a standard error of 0.015, and the lower bar is three of
// them. The bias part is an upper bound, so that the interval may be too wide where it is large.
// Refused are those in which the node finds no rest by the gyro alone within 90 s.
TEST_P(TurnsByHand, FindTheScaleFactorWithinTheInterval) {
  std::size_t refused = 0;
  std::size_t scale_inside = 0;
  std::size_t asymmetry_inside = 0;
  double half_width = 0.0;
  double squares = 0.0;
  for (std::size_t k = 0; k < kCalibrations; ++k) {
    const Drawn drawn = draw(GetParam(), random::RandomStream{77, k});
    const auto done = calibrate_by_hand(GetParam(), drawn, random::RandomStream{78, k});
    if (!done.fit || !done.fit->asymmetry) {
      ++refused;
      continue;
    }
    const double error = done.fit->scale.value - drawn.scale;
    scale_inside += std::abs(error) < done.fit->scale.half_width() ? 1U : 0U;
    asymmetry_inside +=
        std::abs(done.fit->asymmetry->value - drawn.asymmetry) < done.fit->asymmetry->half_width()
            ? 1U
            : 0U;
    half_width += done.fit->scale.half_width();
    squares += error * error;
  }
  const auto count = static_cast<double>(kCalibrations - refused);
  const double coverage = static_cast<double>(scale_inside) / count;
  const double of_asymmetry = static_cast<double>(asymmetry_inside) / count;
  std::printf(
      "%d turns, mark %.1f deg: +- %.3f %%, error %.3f %% rms, coverage %.3f and %.3f, refused "
      "%zu\n",
      GetParam().turns, GetParam().mark_sigma_deg, 100.0 * half_width / count,
      100.0 * std::sqrt(squares / count), coverage, of_asymmetry, refused);
  RecordProperty("coverage", std::to_string(coverage));
  EXPECT_LE(refused, 4U);
  EXPECT_GE(coverage, 0.95 - 0.046);
  EXPECT_GE(of_asymmetry, 0.95 - 0.046);
}
INSTANTIATE_TEST_SUITE_P(Of, TurnsByHand,
                         ::testing::Values(Case{5, 2.0}, Case{10, 2.0}, Case{20, 2.0}, Case{5, 0.5},
                                           Case{10, 0.5}, Case{20, 0.5}));

}  // namespace
}  // namespace zerorate::drives
