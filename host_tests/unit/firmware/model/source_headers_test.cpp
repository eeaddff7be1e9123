#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>

#include "firmware/app/node_params.hpp"
#include "firmware/c_api/examples/front_gyro.h"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "firmware/model/source_headers.hpp"

namespace zerorate::model {
namespace {

constexpr auto kSamplePeriod = core::Duration::milliseconds(10);
constexpr auto kTick = core::Duration::milliseconds(500);
// The PC and the vehicle agree on what a model may hold, though neither room includes the other.
static_assert(kCApiShape.decaying == ZERORATE_DECAYING_MODES);
static_assert(kCApiShape.rotating == ZERORATE_ROTATING_MODES);
static_assert(kCApiHeldTicks == ZERORATE_HELD_TICKS);
static_assert(kNodeHeldTicks == app::NodeCapacity{}.held_ticks);

TEST(CHeaderOfTheExamples, IsWhatTheCatalogueExportsToday) {
  std::ifstream file(ZERORATE_REPOSITORY "/firmware/c_api/examples/front_gyro.h");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(text, format_c_header(find_model("lsm6dso"), kSamplePeriod, kTick, "front_gyro"))
      << "run: zerorate export lsm6dso --c --name front_gyro --sample-rate 100 "
         "-o firmware/c_api/examples/front_gyro.h";
}

TEST(CHeaderOfAModelOfSingleSamples, IsRefused) {
  SensorModel model = find_model("lsm6dso");
  model.outliers = Outliers{.probability = 1e-3, .sigma_rad_s = 0.1};
  EXPECT_THROW((void)format_c_header(model, kSamplePeriod, kTick, "wild"), std::invalid_argument);
}

TEST(CHeaderOfAModelWithALine, HasItsRotatingMode) {
  SensorModel model = find_model("lsm6dso");
  model.turn_on.reset();
  model.zero_rate.reset();
  model.name = "no end */ of a comment";
  model.harmonic.push_back({.rms_rad_s = 1e-4, .frequency_hz = 0.3, .coherence_time_s = 10.0});
  const std::string text = format_c_header(model, kSamplePeriod, kTick, "with_line");
  EXPECT_NE(text.find(".rotating = {"), std::string::npos);
  EXPECT_NE(text.find("ZERORATE_UNKNOWN_VARIANCE"), std::string::npos);
  EXPECT_NE(text.find("no end  / of a comment"), std::string::npos);
}

/// Whether a header for a filter rate is written.
template <class Format>
bool is_exported(Format format) {
  try {
    (void)format();
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

TEST(CHeaderOfAnyFilterRate, IsWrittenWhereTheDefaultTakesIt) {
  static zerorate_node node;
  for (int rate_hz = 1; rate_hz <= 110; ++rate_hz) {
    zerorate_model model = front_gyro;
    model.tick_ns = 1'000'000'000 / rate_hz;
    const auto tick = core::Duration::nanoseconds(model.tick_ns);
    EXPECT_EQ(zerorate_init(&node, &model, nullptr) == ZERORATE_OK, is_exported([&] {
                return format_c_header(find_model("lsm6dso"), kSamplePeriod, tick, "fast");
              }))
        << rate_hz;
  }
}

TEST(HeaderOfAnyFilterRate, IsWrittenWhereANodeTakesIt) {
  for (int rate_hz = 1; rate_hz <= 210; ++rate_hz) {
    app::NodeParams<core::ModelShape{}> params;
    params.model.white_variance_rad2_s2 = 1.0F;
    params.model.sample_period = core::Duration::milliseconds(5);
    const auto tick = core::Duration::nanoseconds(1'000'000'000 / rate_hz);
    params.model.modes.tick = tick;
    EXPECT_EQ(app::check(params, app::NodeCapacity{}).has_value(), is_exported([&] {
                return format_cpp_header(find_model("lsm6dso"), core::Duration::milliseconds(5),
                                         tick);
              }))
        << rate_hz;
  }
}

TEST(CHeaderOfAFastFilter, NamesThePlacesAndTheRateThatFits) {
  const auto tick = core::Duration::milliseconds(20);
  try {
    (void)format_c_header(find_model("lsm6dso"), kSamplePeriod, tick, "fast");
    FAIL() << "written";
  } catch (const std::invalid_argument& error) {
    const std::string reason = error.what();
    for (const char* part :
         {"50.000 Hz", "below 26.000 Hz", "ZERORATE_HELD_TICKS of 29", "--held-ticks 29"}) {
      EXPECT_NE(reason.find(part), std::string::npos) << reason;
    }
  }
  const std::string text = format_c_header(find_model("lsm6dso"), kSamplePeriod, tick, "fast", 29);
  EXPECT_NE(text.find("#if ZERORATE_HELD_TICKS < 29\n#error"), std::string::npos);
}

TEST(CHeaderWithANameThatIsNone, IsRefused) {
  for (const char* name : {"", "2nd", "front gyro", "a-b", "int", "class"}) {
    EXPECT_THROW((void)format_c_header(find_model("lsm6dso"), kSamplePeriod, kTick, name),
                 std::invalid_argument)
        << name;
  }
}

constexpr auto kLsm6dsoPeriod = core::Duration::nanoseconds(9'599'520);

/// A model of the catalogue for an image without room for hypotheses.
SensorModel known_model(std::string_view name) {
  SensorModel model = find_model(name);
  model.learning = Learning{.hypotheses = 1};
  return model;
}

TEST(HeaderOfThePico, IsWhatTheCatalogueExportsToday) {
  std::ifstream file(ZERORATE_REPOSITORY "/firmware/boards/models/lsm6dso.hpp");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(text, format_cpp_header(known_model("lsm6dso"), kLsm6dsoPeriod, kTick))
      << "run: zerorate export lsm6dso --cpp --hypotheses 1 --sample-rate 104.171875 -o "
         "firmware/boards/models/lsm6dso.hpp";
}

TEST(HeaderOfThePicoThatLearns, IsWhatTheCatalogueExportsToday) {
  std::ifstream file(ZERORATE_REPOSITORY "/firmware/boards/models/lsm6dso_learning.hpp");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_TRUE(text == format_cpp_header(find_model("lsm6dso"), kLsm6dsoPeriod, kTick))
      << "run: zerorate export lsm6dso --cpp --hypotheses 12 --sample-rate 104.171875 -o "
         "firmware/boards/models/lsm6dso_learning.hpp";
}

TEST(HeadersOfTheOtherGyrosOfThePico, EqualTodaysExport) {
  struct Exported {
    std::string chip;
    core::Duration sample_period;
  };
  for (const auto& [chip, sample_period] :
       {Exported{"icm42688", core::Duration::milliseconds(10)},
        Exported{"bmi088", core::Duration::milliseconds(10)},
        Exported{"mpu6500", core::Duration::milliseconds(10)},
        Exported{"mpu6050", core::Duration::milliseconds(10)},
        Exported{"bmi160", core::Duration::milliseconds(10)},
        Exported{"icm20948", core::Duration::milliseconds(8)},
        Exported{"icm45686", core::Duration::milliseconds(10)},
        Exported{"adxrs453", core::Duration::milliseconds(5)},
        Exported{"lsm6dsl", kLsm6dsoPeriod},
        Exported{"lsm6ds3tr-c", kLsm6dsoPeriod},
        Exported{"lsm6dsox", kLsm6dsoPeriod},
        Exported{"lsm6dsr", kLsm6dsoPeriod},
        Exported{"icm42605", core::Duration::milliseconds(10)},
        Exported{"iim42652", core::Duration::milliseconds(10)},
        Exported{"icm20602", core::Duration::milliseconds(10)},
        Exported{"icm20689", core::Duration::milliseconds(10)},
        Exported{"mpu6886", core::Duration::milliseconds(10)},
        Exported{"l3gd20h", core::Duration::milliseconds(10)},
        Exported{"l3gd20", core::Duration::nanoseconds(10'526'316)},
        Exported{"l3g4200d", core::Duration::milliseconds(10)},
        Exported{"adis16470", core::Duration::milliseconds(10)},
        Exported{"adis16475-1", core::Duration::milliseconds(10)},
        Exported{"adis16475-2", core::Duration::milliseconds(10)},
        Exported{"adis16475-3", core::Duration::milliseconds(10)}}) {
    std::ifstream file(ZERORATE_REPOSITORY "/firmware/boards/models/" + chip + ".hpp");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const SensorModel model = without_accelerometer(known_model(chip));
    EXPECT_EQ(text, format_cpp_header(model, sample_period, kTick)) << chip;
  }
}

TEST(HeaderOfAModelOfSingleSamples, HoldsWhatTheNodeScreens) {
  SensorModel model = find_model("lsm6dso");
  model.outliers = Outliers{.probability = 0.0009765625, .sigma_rad_s = 0.5};
  model.saturation = Saturation{.lower_rad_s = -4.0, .upper_rad_s = 4.0};
  const std::string text = format_cpp_header(model, kLsm6dsoPeriod, kTick);
  EXPECT_NE(text.find(".outliers = {.probability = 0.0009765625F, .variance_rad2_s2 = 0.25F}"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(".range = {.lower_rad_s = -4.0F, .upper_rad_s = 4.0F}"), std::string::npos);
}

TEST(HeaderOfALearningNode, HoldsItsHypotheses) {
  const std::string text = format_cpp_header(find_model("lsm6dso"), kLsm6dsoPeriod, kTick);
  EXPECT_NE(text.find(".hypotheses = 12};"), std::string::npos);
  EXPECT_NE(text.find(".hypotheses = {.count = 12, .kept = "), std::string::npos);
}

TEST(HeaderOfAModelWithALine, HasItsRotatingMode) {
  SensorModel model = find_model("lsm6dso");
  model.name = "two\nlines \\";
  model.harmonic.push_back({.rms_rad_s = 1e-4, .frequency_hz = 0.3, .coherence_time_s = 10.0});
  const std::string text = format_cpp_header(model, kLsm6dsoPeriod, kTick);
  EXPECT_NE(text.find(".rotating = 1,"), std::string::npos);
  EXPECT_NE(text.find(".rotating = {{"), std::string::npos);
  EXPECT_NE(text.find("/// Sensor model: two lines  ."), std::string::npos);
}

TEST(HeaderOfAModelWithGateWarmUpAndTemperature, HoldsAll) {
  SensorModel model = find_model("lsm6dso");
  model.gate = Gate{.threshold_sigma = 4.5, .longest_knock_s = 3.0};
  model.warm_up =
      WarmUp{.amplitude_rad_s = 0.25, .amplitude_sigma_rad_s = 1e-3, .time_constant_s = 60.0};
  model.temperature = TemperatureDrift{.reference_degc = 25.0, .slope_sigma_rad_s_per_k = 0.5};
  const std::string text = format_cpp_header(model, kLsm6dsoPeriod, kTick);
  EXPECT_NE(text.find(".inputs = 2, .has_accelerometer = false,"), std::string::npos);
  EXPECT_NE(text.find("{.input = core::Input::temperature, .sigma = 0.5F, "
                      ".coefficient = {{0.0F, 0.0F, 0.0F}}},"),
            std::string::npos);
  EXPECT_NE(text.find(".reference_degc = 25.0F, .lag_s = 0.0F}"), std::string::npos);
  EXPECT_NE(text.find(".gate = {.threshold_sigma = 4.5F, .longest_knock_ticks = 6}"),
            std::string::npos);
  EXPECT_NE(text.find(".initial_mean = 0.25F"), std::string::npos);
  EXPECT_NE(text.find("kModelShape{.decaying = 7,"), std::string::npos);
}

}  // namespace
}  // namespace zerorate::model
