#include "firmware/app/message_inputs.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::app {
namespace {

constexpr core::ModelShape kShapeWithForce{.decaying = 6, .inputs = 3, .has_accelerometer = true};
using NodeWithForce = GyroNode<kShapeWithForce>;
using Vector = std::array<double, 3>;

constexpr core::Duration kPeriod = core::Duration::milliseconds(10);
constexpr double kForceNoise_g = 0.01;  ///< deviation of a reading of an axis
constexpr double kWhite_dps = 0.03;     ///< deviation of a sample of the gyro
/// Bias of x, y and z by the force along x, y and z [deg/s/g].
constexpr std::array<Vector, 3> kCoefficients{Vector{0.05, -0.02, 0.01}, Vector{0.0, 0.04, 0.03},
                                              Vector{-0.03, 0.01, -0.06}};

NodeWithForce::Params params_with_force(bool follows_force) {
  model::SensorModel sensor = model::find_model("icm42688");
  if (follows_force) {
    sensor.inputs = {{.quantity = model::InputQuantity::acceleration,
                      .sigma_rad_s_per_unit = core::deg_per_s(0.1F).in(core::rad_per_s)}};
  }
  return {.model = model::make_node_model<kShapeWithForce>(sensor, kPeriod,
                                                           core::Duration::milliseconds(500))};
}

double explained_dps(std::size_t axis, const Vector& force_g) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) sum += kCoefficients.at(axis).at(i) * force_g.at(i);
  return sum;
}

/// A vehicle that drives for five seconds and stands for twenty, always in another attitude.
class LeaningVehicle {
 public:
  explicit LeaningVehicle(const NodeWithForce::Params& params) : params_(params) {}

  void drive_and_stand(const Vector& force_g) {
    for (int k = 0; k < 2500; ++k) {
      at_ = at_ + kPeriod;
      if (k < 500) node_.pulse(at_);
      message_ = node_.step(sample(force_g));
    }
    describe_inputs(node_.ticks(), message_);
  }
  [[nodiscard]] const RateMessage& message() const { return message_; }

 private:
  core::GyroSample sample(const Vector& force_g) {
    core::GyroSample sample{.time = at_, .has_acceleration = true};
    for (std::size_t i = 0; i < 3; ++i) {
      const double rate_dps = 0.2 + explained_dps(i, force_g) + kWhite_dps * noise(i);
      sample.rate.at(i) = core::deg_per_s(static_cast<float>(rate_dps));
      const double g = force_g.at(i) + kForceNoise_g * noise(3 + i);
      sample.acceleration.at(i) = core::standard_gravity(static_cast<float>(g));
    }
    return sample;
  }
  [[nodiscard]] double noise(std::size_t stream) const {
    return random::RandomStream{11, stream}.normal(at_.ns());
  }

  NodeWithForce::Params params_;
  NodeWithForce node_{params_};
  core::Instant at_ = core::Instant::from_ns(1'000'000'000);
  RateMessage message_;
};

TEST(MessageInputsAfterManyAttitudes, AreTheTrueCoefficients) {
  LeaningVehicle vehicle{params_with_force(true)};
  Vector force_g{};
  for (std::int64_t stop = 0; stop < 12; ++stop) {
    const auto number = [&](std::uint64_t i) { return random::RandomStream{5, i}.normal(stop); };
    const double length = std::hypot(number(0), number(1), number(2));
    for (std::size_t i = 0; i < 3; ++i) force_g.at(i) = number(i) / length;
    vehicle.drive_and_stand(force_g);
  }
  const RateMessage& message = vehicle.message();
  ASSERT_TRUE(message.explained.has_value());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // The mean of a stop errs by 0.03 deg/s / sqrt(2000) = 0.0007 deg/s, and three coefficients and
    // the level come from twelve of them: a half of that, and six times as much is allowed.
    EXPECT_NEAR(message.explained->at(axis).acceleration.in(core::deg_per_s),
                explained_dps(axis, force_g), 0.002);
    EXPECT_EQ(message.explained->at(axis).temperature, core::AngularRate{});
    EXPECT_EQ(message.explained->at(axis).vibration, core::AngularRate{});
  }
}

TEST(MessageInputsOfANoisyAccelerometer, HaveItsVibration) {
  LeaningVehicle vehicle{params_with_force(true)};
  vehicle.drive_and_stand({0.0, 0.0, 1.0});
  ASSERT_TRUE(vehicle.message().vibration.has_value());
  // A tick has 50 readings of three axes: a standard deviation of 1 / sqrt(2 * 147) = 6 %.
  EXPECT_NEAR(vehicle.message().vibration->in(core::standard_gravity),
              std::sqrt(3.0) * kForceNoise_g, 0.3 * kForceNoise_g);
}

TEST(MessageInputsOfAModelWithoutThem, ExplainNothing) {
  LeaningVehicle vehicle{params_with_force(false)};
  vehicle.drive_and_stand({0.0, 0.0, 1.0});
  EXPECT_FALSE(vehicle.message().explained.has_value());
  EXPECT_TRUE(vehicle.message().vibration.has_value());
}

TEST(MessageInputsOfAMovingAverage, ExplainNothing) {
  NodeWithForce::Params params = params_with_force(true);
  params.published = Predictor::moving_average;
  LeaningVehicle vehicle{params};
  vehicle.drive_and_stand({0.0, 0.0, 1.0});
  EXPECT_FALSE(vehicle.message().explained.has_value());
}

}  // namespace
}  // namespace zerorate::app
