#include "core/base/units.hpp"

#include <gtest/gtest.h>

#include <type_traits>

namespace zerorate::core {
namespace {

TEST(AngularRate, EntersAndLeavesByNamedUnits) {
  const AngularRate rate = deg_per_s(90.0F);
  EXPECT_FLOAT_EQ(rate.in(rad_per_s), 1.5707963F);
  EXPECT_FLOAT_EQ(rate.in(deg_per_h), 324'000.0F);
}

TEST(AngularRate, TimesTimeIsAnAngle) {
  const Angle turned = deg_per_s(2.0F) * Duration::milliseconds(500);
  EXPECT_FLOAT_EQ(turned.in(deg), 1.0F);
}

TEST(Temperature, DifferenceOfPointsIsNoPoint) {
  const auto rise = Temperature::from_degc(45.0F) - Temperature::from_degc(25.0F);
  static_assert(std::is_same_v<decltype(rise), const TemperatureDifference>);
  EXPECT_FLOAT_EQ(rise.in(kelvin), 20.0F);
}

static_assert(sizeof(AngularRate) == sizeof(float), "a quantity costs nothing");
static_assert(std::is_trivially_copyable_v<AngularRate>);

}  // namespace
}  // namespace zerorate::core
