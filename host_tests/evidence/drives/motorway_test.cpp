// An hour of motorway without a stop, with a GNSS course each second: error of the bias in motion,
// beside that of a Kalman filter in double precision that has the true model of the noise.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

#include "host_tests/evidence/drives/turning_vehicle.hpp"

namespace zerorate::drives {
namespace {

constexpr std::size_t kRest = 1200;        // samples: a minute
constexpr std::size_t kHour = 72'000;      // samples
constexpr std::size_t kTick = 10;          // samples
constexpr std::size_t kLearning = 12'000;  // samples in motion before those that are scored
constexpr double kTick_s = static_cast<double>(kTick) * kPeriod_s;
constexpr double kCourse_rad = 0.7 * kRadPerDeg;
constexpr double kTolerance = 0.01;

/// Made noise of the sensor, white and slow apart.
struct Noise {
  std::vector<double> white_rad_s;
  std::vector<double> bias_rad_s;
};

Noise noise_of(std::uint64_t seed) {
  const model::SensorModel sensor = model::find_model("lsm6dso");
  const simulate::Signal signal{kRest + kHour, kPeriod_s};
  const std::vector<simulate::Effect> white{simulate::WhiteNoise{
      .angle_random_walk_rad_rt_s = sensor.white.angle_random_walk_rad_per_sqrt_s}};
  const std::vector<simulate::Effect> slow{
      simulate::ConstantBias{.bias_rad_s = 0.3 * kRadPerDeg},
      simulate::FlickerNoise{.bias_instability_rad_s = sensor.flicker->bias_instability_rad_s,
                             .order = 0.5}};
  return {simulate::simulate(signal, white, random::RandomStream{seed, 0}).rate_rad_s,
          simulate::simulate(signal, slow, random::RandomStream{seed, 1}).rate_rad_s};
}

/// The oracle: heading, scale factor, constant bias and the modes of the flicker noise, with dense
/// matrices.
class Oracle {
 public:
  explicit Oracle(const TurningNode::Params& params)
      : white_rad2_s2_(double{params.model.white_variance_rad2_s2} / static_cast<double>(kTick)) {
    covariance_(kScale, kScale) = kTolerance * kTolerance;
    covariance_(kConstant, kConstant) = 1.0;
    for (int i = 0; i < kModes; ++i) {
      const auto& mode = params.model.modes.decaying[static_cast<std::size_t>(i)];
      const int state = kConstant + 1 + i;
      kept_(state) = 1.0 - double{mode.one_minus_phi};
      noise_(state) = double{mode.noise_variance};
      covariance_(state, state) = double{mode.initial_variance};
    }
  }
  /// A tick in motion.
  void drive(double rate_rad_s) {
    Matrix transition = kept_.asDiagonal();
    transition(kHeading, kScale) = -rate_rad_s * kTick_s;
    transition.row(kHeading).tail(kBiases).setConstant(-kTick_s);
    advance(transition, white_rad2_s2_ * kTick_s * kTick_s);
    state_(kHeading) += rate_rad_s * kTick_s;
  }
  /// A tick at rest.
  void rest(double rate_rad_s) {
    advance(kept_.asDiagonal(), 0.0);
    Vector row = Vector::Zero();
    row.tail(kBiases).setOnes();
    update(row, rate_rad_s - row.dot(state_), white_rad2_s2_);
  }
  void take_course(double heading_rad) {
    constexpr double kVariance = kCourse_rad * kCourse_rad;
    if (!has_heading_) {
      has_heading_ = true;
      state_(kHeading) = heading_rad;
      covariance_.row(kHeading).setZero();
      covariance_.col(kHeading).setZero();
      covariance_(kHeading, kHeading) = kVariance;
      return;
    }
    update(Vector::Unit(kHeading), heading_rad - state_(kHeading), kVariance);
  }
  [[nodiscard]] double bias_rad_s() const { return state_.tail(kBiases).sum(); }

 private:
  static constexpr int kModes = static_cast<int>(kTurningShape.decaying);
  static constexpr int kBiases = kModes + 1;
  static constexpr int kHeading = 0;
  static constexpr int kScale = 1;
  static constexpr int kConstant = 2;
  static constexpr int kStates = kConstant + kBiases;
  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Matrix = Eigen::Matrix<double, kStates, kStates>;

  void advance(const Matrix& transition, double heading_noise_rad2) {
    state_ = transition * state_;
    covariance_ = transition * covariance_ * transition.transpose();
    covariance_.diagonal() += noise_;
    covariance_(kHeading, kHeading) += heading_noise_rad2;
  }
  void update(const Vector& row, double error, double variance) {
    const Vector gain = covariance_ * row / (row.dot(covariance_ * row) + variance);
    state_ += gain * error;
    covariance_ -= gain * (row.transpose() * covariance_);
  }

  double white_rad2_s2_;
  Vector kept_ = Vector::Ones();
  Vector noise_ = Vector::Zero();
  Vector state_ = Vector::Zero();
  Matrix covariance_ = Matrix::Zero();
  bool has_heading_ = false;
};

/// Sums of squared errors of an hour.
struct Errors {
  double of_node = 0.0;
  double of_oracle = 0.0;
};

/// Bends of half a degree a second, as a motorway has them.
double road_rad_s(std::size_t k) {
  return 0.5 * kRadPerDeg * std::sin(0.05 * kPeriod_s * static_cast<double>(k));
}
double mean_of_newest_tick(const std::vector<double>& values, std::size_t k) {
  double sum = 0.0;
  for (std::size_t i = k + 1 - kTick; i <= k; ++i) sum += values[i];
  return sum / static_cast<double>(kTick);
}

Errors drive_an_hour(std::uint64_t seed) {
  const TurningNode::Params params = turning_params(kTolerance);
  TurningNode node{params};
  Oracle oracle{params};
  const Noise noise = noise_of(seed);
  const random::RandomStream course{seed, 2};
  std::vector<double> measured_rad_s(kRest + kHour);
  double heading_rad = 0.0;
  Errors errors;
  for (std::size_t k = 0; k < measured_rad_s.size(); ++k) {
    const bool moves = k >= kRest;
    const double road = moves ? road_rad_s(k) : 0.0;
    heading_rad += road * kPeriod_s;
    measured_rad_s[k] = noise.white_rad_s[k] + noise.bias_rad_s[k] + road;
    if (moves) node.pulse(time_of(k));
    core::GyroSample sample{.time = time_of(k)};
    sample.rate[0] = core::rad_per_s(static_cast<float>(measured_rad_s[k]));
    const app::RateMessage message = node.step(sample);
    if ((k + 1) % kTick != 0) continue;
    const double rate = mean_of_newest_tick(measured_rad_s, k);
    moves ? oracle.drive(rate) : oracle.rest(rate);
    if (!moves || (k + 1) % (2 * kTick) != 0) continue;
    const double reference =
        heading_rad + kCourse_rad * course.normal(static_cast<std::int64_t>(k));
    oracle.take_course(reference);
    (void)node.take_reference(app::HeadingReference{
        .time = time_of(k),
        .heading = core::rad(static_cast<float>(std::remainder(reference, 2.0 * std::numbers::pi))),
        .sigma = core::rad(static_cast<float>(kCourse_rad))});
    if (k < kRest + kLearning) continue;
    const double truth = mean_of_newest_tick(noise.bias_rad_s, k);
    const double found = double{message.axes[0].bias.in(core::rad_per_s)};
    errors.of_node += std::pow(found - truth, 2.0);
    errors.of_oracle += std::pow(oracle.bias_rad_s() - truth, 2.0);
  }
  return errors;
}

TEST(MotorwayHour, FollowsTheBiasNearlyAsWellAsIsPossible) {
  Errors sum;
  for (std::uint64_t seed = 500; seed < 508; ++seed) {
    const Errors one = drive_an_hour(seed);
    sum.of_node += one.of_node;
    sum.of_oracle += one.of_oracle;
  }
  const double ratio = std::sqrt(sum.of_node / sum.of_oracle);
  std::printf("error of the bias over that of the oracle: %.3f\n", ratio);
  // Standard error over eight hours, by the spread of the single ones: 0.03.
  EXPECT_LT(ratio, 1.2);
  EXPECT_GT(ratio, 0.94) << "the oracle is the best that can be";
}

}  // namespace
}  // namespace zerorate::drives
