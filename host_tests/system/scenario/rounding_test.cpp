// Gyros with noise of a fifth, of half and of a whole step, rounded and truncated, whose biases lie
// anywhere within a step: the interval of the heading holds, and says no more than there is.
// The table stands in docs/design/sample-model.md.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/support/repetitions.hpp"
#include "host_tests/system/scenario/play.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::scenario {
namespace {

constexpr double kStep_dps = 0.1;
constexpr double kBiasInstability_dph = 9.0;
constexpr auto kPeriod = core::Duration::milliseconds(20);
constexpr double kPeriod_s = 0.02;
constexpr std::size_t kStop = 1500;   ///< samples
constexpr std::size_t kDrive = 3000;  ///< samples
constexpr std::size_t kDrives = 3;
constexpr std::uint64_t kWorlds = 20;  ///< 60 in `./test --slow`

constexpr core::ModelShape kShape =
    core::with_hypotheses(core::ModelShape{.decaying = 6}, model::kMostHypotheses);
using RoundingNode = app::GyroNode<kShape>;

/// How a gyro makes whole steps of a rate.
enum class Steps : std::uint8_t {
  rounded,      ///< nearest step
  lower,        ///< step below
  toward_zero,  ///< step toward zero, which the node does not undo
  undone        ///< step toward zero, which the node undoes
};
constexpr std::array<const char*, 4> kNames{"rounded", "cut down", "cut toward zero", "undone"};

struct Gyro {
  double noise_in_steps = 1.0;
  Steps steps = Steps::rounded;
  double noise_of_model_in_steps = 1.0;
  bool model_states_step = false;  ///< table [quantization]
  double largest_bias_in_steps = 10.0;

  [[nodiscard]] double counts_of(double in_steps) const {
    if (steps == Steps::rounded) return std::round(in_steps);
    return steps == Steps::lower ? std::floor(in_steps) : std::trunc(in_steps);
  }
};

RoundingNode::Params params_of(const Gyro& gyro) {
  model::SensorModel sensor;
  sensor.name = "coarse";
  sensor.white.angle_random_walk_rad_per_sqrt_s =
      gyro.noise_of_model_in_steps * kStep_dps * kDps * std::sqrt(kPeriod_s);
  sensor.flicker =
      model::Flicker{.bias_instability_rad_s = kBiasInstability_dph / 3600.0 * kDps, .decades = 6};
  if (gyro.model_states_step || gyro.steps == Steps::undone) {
    sensor.quantization = model::Quantization{.step_rad_s = kStep_dps * kDps,
                                              .method = gyro.steps == Steps::undone
                                                            ? model::QuantizationMethod::truncation
                                                            : model::QuantizationMethod::rounding};
  }
  const auto tick = core::Duration::milliseconds(500);
  return {.model = model::make_node_model<kShape>(sensor, kPeriod, tick)};
}

/// Heading errors of drives and what the interval says of them.
struct Score {
  double drives = 0.0;
  double covered = 0.0;
  double squares_rad2 = 0.0;
  double variances_rad2 = 0.0;

  [[nodiscard]] double coverage() const { return covered / drives; }
  [[nodiscard]] double rms_deg() const { return std::sqrt(squares_rad2 / drives) / kDps; }
  [[nodiscard]] double sigma_deg() const { return std::sqrt(variances_rad2 / drives) / kDps; }
};

class World {
 public:
  World(const Gyro& gyro, const RoundingNode::Params& params, std::uint64_t number)
      : gyro_(gyro), node_(params), random_(number) {
    const std::size_t samples = kDrives * (kStop + kDrive);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::vector<simulate::Effect> slow{
          simulate::ConstantBias{
              .bias_rad_s =
                  std::uniform_real_distribution<double>{
                      -gyro.largest_bias_in_steps, gyro.largest_bias_in_steps}(random_)*kStep_dps *
                  kDps},
          simulate::FlickerNoise{.bias_instability_rad_s = kBiasInstability_dph / 3600.0 * kDps}};
      const random::RandomStream stream{number, axis};
      bias_rad_s_[axis] = simulate::simulate({samples, kPeriod_s}, slow, stream).rate_rad_s;
    }
  }

  /// Drives, and scores the newest drive.
  void run(Score& score) {
    for (std::size_t drive = 0; drive < kDrives; ++drive) {
      for (std::size_t k = 0; k < kStop; ++k) (void)step(false);
      node_.finish_learning();
      const core::Instant from = now();
      std::array<double, 3> drift_rad{};
      std::array<core::HeadingPrediction, 3> heading;
      const auto length = kPeriod * std::int64_t{kDrive};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        heading[axis] = node_.predict_heading(app::Predictor::kalman, axis, from, from + length);
      }
      for (std::size_t k = 0; k < kDrive; ++k) {
        const std::array<double, 3> errors = step(true);
        for (std::size_t axis = 0; axis < 3; ++axis) drift_rad[axis] += errors[axis] * kPeriod_s;
      }
      if (drive + 1 < kDrives) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) take(drift_rad[axis], heading[axis], score);
    }
  }

 private:
  [[nodiscard]] core::Instant now() const {
    return core::Instant::from_ns(static_cast<std::int64_t>(sample_) * kPeriod.ns());
  }
  /// @return errors of the samples
  std::array<double, 3> step(bool drives) {
    const double step_rad_s = kStep_dps * kDps;
    core::GyroSample sample;
    std::array<double, 3> errors{};
    std::normal_distribution<double> white{0.0, gyro_.noise_in_steps * step_rad_s};
    const double time_s = static_cast<double>(sample_) * kPeriod_s;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double pace = 0.3 + 0.1 * static_cast<double>(axis);
      const double rate_rad_s = drives ? 10.0 * kDps * std::sin(pace * time_s) : 0.0;
      const double in_steps =
          (rate_rad_s + bias_rad_s_[axis][sample_] + white(random_)) / step_rad_s;
      sample.rate[axis] =
          core::rad_per_s(static_cast<float>(gyro_.counts_of(in_steps) * step_rad_s));
      const core::AngularRate taken = node_.params().model.corrected(sample.rate[axis], axis);
      errors[axis] = double{taken.in(core::rad_per_s)} - rate_rad_s;
    }
    ++sample_;
    sample.time = now();
    if (drives && sample_ % 5 == 0) node_.pulse(now());
    (void)node_.step(sample);
    return errors;
  }
  /// White noise of the drive, with that of rounding a rate that crosses many steps.
  void take(double drift_rad, const core::HeadingPrediction& heading, Score& score) const {
    const double step2 = std::pow(kStep_dps * kDps, 2);
    const double of_sample = step2 * (std::pow(gyro_.noise_in_steps, 2) + 1.0 / 12.0);
    const double variance = double{heading.variance_rad2} +
                            of_sample * kPeriod_s * kPeriod_s * static_cast<double>(kDrive);
    const double error = drift_rad - double{heading.angle_rad};
    score.drives += 1.0;
    score.squares_rad2 += error * error;
    score.variances_rad2 += variance;
    score.covered += error * error <= 1.959964 * 1.959964 * variance ? 1.0 : 0.0;
  }

  Gyro gyro_;
  RoundingNode node_;
  std::mt19937_64 random_;
  std::array<std::vector<double>, 3> bias_rad_s_;
  std::size_t sample_ = 0;
};

Score score_of(const Gyro& gyro) {
  const RoundingNode::Params params = params_of(gyro);
  Score score;
  for (std::uint64_t world = 1; world <= testing::repetitions(kWorlds); ++world) {
    World{gyro, params, world}.run(score);
  }
  std::printf(
      "noise %.1f step (model %.1f, %s), biases to %.1f steps, %s: %.0f drives, coverage %.3f, "
      "rms %.3f deg, sigma %.3f deg\n",
      gyro.noise_in_steps, gyro.noise_of_model_in_steps,
      gyro.model_states_step ? "step stated" : "no step", gyro.largest_bias_in_steps,
      kNames.at(static_cast<std::size_t>(gyro.steps)), score.drives, score.coverage(),
      score.rms_deg(), score.sigma_deg());
  return score;
}

/// The interval holds for 93 % of the drives and more, but for three standard deviations of the
/// share of so many drives.
void expect_honest(const Score& score) {
  constexpr double kLeast = 0.93;
  EXPECT_GE(score.coverage(), kLeast - 3.0 * std::sqrt(kLeast * (1.0 - kLeast) / score.drives));
  EXPECT_LE(score.sigma_deg(), 4.0 * score.rms_deg());
}

/// Verifies SR-INT-10.
TEST(CoarseGyro, HoldsItsHeadingIntervalAtAnyNoise) {
  for (const double noise : {0.1, 0.2, 0.5, 1.0}) {
    for (const Steps steps : {Steps::rounded, Steps::lower}) {
      for (const bool states : {false, true}) {
        expect_honest(score_of({noise, steps, noise, states}));
      }
    }
  }
}
TEST(CoarseGyro, HoldsItsHeadingIntervalUnderWrongModels) {
  for (const double noise : {0.1, 0.2, 0.5}) {
    for (const Steps steps : {Steps::rounded, Steps::lower}) {
      expect_honest(score_of({noise, steps, 2.0 * noise, false}));
      expect_honest(score_of({noise, steps, 0.5 * noise, true}));
    }
  }
}
TEST(GyroThatCutsTowardZero, HoldsItsIntervalWhereThatIsUndone) {
  for (const double noise : {0.1, 0.2, 0.5, 1.0}) {
    for (const double bias : {1.0, 10.0}) {
      expect_honest(score_of({noise, Steps::undone, noise, true, bias}));
    }
  }
}
TEST(GyroThatCutsTowardZero, DriftsByHalfAStepWhereThatIsNotUndone) {
  const Score cut = score_of({1.0, Steps::toward_zero, 1.0, true});
  const Score undone = score_of({1.0, Steps::undone, 1.0, true});
  EXPECT_GT(cut.rms_deg(), 3.0 * undone.rms_deg());
}

}  // namespace
}  // namespace zerorate::scenario
