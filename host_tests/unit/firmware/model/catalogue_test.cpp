#include "firmware/model/catalogue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>

#include "firmware/model/flicker_fit.hpp"
#include "firmware/model/model_file.hpp"
#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {
namespace {

constexpr double kDegPerHour = std::numbers::pi / 180.0 / 3600.0;

TEST(Catalogue, HoldsTheSensors) {
  std::vector<std::string_view> names;
  for (const CatalogueEntry& entry : catalogue()) {
    names.push_back(entry.name);
  }
  EXPECT_THAT(
      names, testing::ElementsAre(
                 "adis16405", "adis16470", "adis16475-1", "adis16475-2", "adis16475-3", "adxrs453",
                 "asm330lhh", "bmi088", "bmi160", "bmi270", "icm20602", "icm20689", "icm20948",
                 "icm42605", "icm42688", "icm45686", "iim42652", "ism330dhcx", "l3g4200d", "l3gd20",
                 "l3gd20h", "lsm6ds3tr-c", "lsm6dsl", "lsm6dso", "lsm6dsox", "lsm6dsr",
                 "lsm6dsv16x", "mpu6050", "mpu6500", "mpu6886", "paper"));
}

TEST(CatalogueEntries, AreValidAndNameTheSourceOfEveryFigure) {
  for (const CatalogueEntry& entry : catalogue()) {
    SCOPED_TRACE(entry.name);
    const SensorModel model = find_model(entry.name);
    EXPECT_NO_THROW(validate(model));
    EXPECT_FALSE(model.white.source.empty());
    ASSERT_TRUE(model.flicker);
    EXPECT_FALSE(model.flicker->source.empty());
    EXPECT_EQ(parse_model(format_model(model), "again"), model);
  }
}

TEST(CatalogueEntriesWithoutADataSheetFigure, SaySo) {
  for (const std::string_view name :
       {"lsm6dso",  "lsm6dsox", "lsm6dsr",  "lsm6dsl",     "lsm6ds3tr-c", "lsm6dsv16x",
        "icm42605", "icm20948", "icm42688", "icm45686",    "iim42652",    "icm20602",
        "icm20689", "mpu6050",  "mpu6500",  "adis16475-2", "adis16475-3", "mpu6886",
        "l3gd20h",  "l3gd20",   "l3g4200d", "bmi160",      "bmi270"}) {
    EXPECT_THAT(find_model(name).flicker->source, testing::StartsWith("Estimated")) << name;
  }
  for (const std::string_view name : {"asm330lhh", "ism330dhcx"}) {
    EXPECT_THAT(find_model(name).flicker->source, testing::StartsWith("Second-hand")) << name;
  }
  EXPECT_THAT(find_model("bmi088").flicker->source, testing::StartsWith("Not in the data sheet"));
}

TEST(CatalogueEntries, SayWhatSwitchingOnChangesAndWhereThatIsFrom) {
  for (const CatalogueEntry& entry : catalogue()) {
    SCOPED_TRACE(entry.name);
    const SensorModel model = find_model(entry.name);
    ASSERT_TRUE(model.turn_on);
    EXPECT_GT(model.turn_on->sigma_rad_s, 0.0);
    if (model.zero_rate) {
      EXPECT_LT(model.turn_on->sigma_rad_s, 0.1 * model.zero_rate->limit_rad_s);
    }
    EXPECT_THAT(model.turn_on->source,
                testing::AnyOf(testing::StartsWith("Measured"), testing::StartsWith("Assumed")));
  }
}

TEST(CatalogueEntries, BoundTheBiasWhereAFigureForItIsKnown) {
  const auto limit_dps = [](std::string_view name) {
    const SensorModel sensor = find_model(name);
    return sensor.zero_rate ? sensor.zero_rate->limit_rad_s / kDegPerHour / 3600.0 : 0.0;
  };
  EXPECT_NEAR(limit_dps("lsm6dso"), 5.0, 1e-9);
  EXPECT_NEAR(limit_dps("lsm6dsv16x"), 5.0, 1e-9);
  EXPECT_NEAR(limit_dps("asm330lhh"), 5.0, 1e-9);
  EXPECT_NEAR(limit_dps("ism330dhcx"), 5.0, 1e-9);
  EXPECT_NEAR(limit_dps("bmi088"), 5.0, 1e-9);
  EXPECT_NEAR(limit_dps("icm42688"), 2.5, 1e-9);
  EXPECT_NEAR(limit_dps("icm45686"), 2.5, 1e-9);
  EXPECT_NEAR(limit_dps("mpu6500"), 25.0, 1e-9);
  EXPECT_NEAR(limit_dps("lsm6ds3tr-c"), 15.0, 1e-9);
  EXPECT_NEAR(limit_dps("icm20602"), 25.0, 1e-9);
  EXPECT_NEAR(limit_dps("bmi160"), 15.0, 1e-9);
  EXPECT_NEAR(limit_dps("bmi270"), 15.0, 1e-9);
  EXPECT_NEAR(limit_dps("icm20948"), 25.0, 1e-9);
  EXPECT_NEAR(limit_dps("mpu6050"), 40.0, 1e-9);
  EXPECT_NEAR(limit_dps("adis16405"), 15.0, 1e-9);
  EXPECT_NEAR(limit_dps("adxrs453"), 2.5, 1e-9);
  EXPECT_THAT(find_model("adxrs453").zero_rate->source, testing::StartsWith("Second-hand"));
}

TEST(CatalogueEntryOfThePaper, HasItsInnovationOf14DegreesPerHour) {
  const SensorModel paper = find_model("paper");
  EXPECT_NEAR(paper.flicker->bias_instability_rad_s / kDegPerHour, 14.0, 1e-7);
  EXPECT_NEAR(paper.white.angle_random_walk_rad_per_sqrt_s / kDegPerHour, 45.0, 1e-9);
  EXPECT_EQ(paper.node.start, core::Start::zero);
}

TEST(CatalogueLookUpOfAMisspeltName, SuggestsTheNearest) {
  try {
    (void)find_model("adis16504");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "no sensor model \"adis16504\" in the catalogue; did you mean \"adis16405\"?");
  }
}

}  // namespace
}  // namespace zerorate::model
