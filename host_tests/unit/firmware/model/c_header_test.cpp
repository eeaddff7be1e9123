#include "firmware/model/c_header.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "firmware/c_api/examples/front_gyro.h"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"

namespace zerorate::model {
namespace {

constexpr auto kSamplePeriod = core::Duration::milliseconds(10);
constexpr auto kTick = core::Duration::milliseconds(500);
// The PC and the vehicle agree on what a model may hold, though neither room includes the other.
static_assert(kCApiShape.decaying == ZERORATE_DECAYING_MODES);
static_assert(kCApiShape.rotating == ZERORATE_ROTATING_MODES);

TEST(CHeaderOfTheExamples, IsWhatTheCatalogueExportsToday) {
  std::ifstream file(ZERORATE_REPOSITORY "/firmware/c_api/examples/front_gyro.h");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(text, format_c_header(find_model("lsm6dso"), kSamplePeriod, kTick, "front_gyro"))
      << "run: zerorate export lsm6dso --c --name front_gyro --sample-rate 100 "
         "-o firmware/c_api/examples/front_gyro.h";
}

TEST(CHeaderCompiled, HoldsTheBitsOfTheModel) {
  const auto node = make_node_model<kCApiShape>(find_model("lsm6dso"), kSamplePeriod, kTick);
  EXPECT_EQ(front_gyro.sample_period_ns, kSamplePeriod.ns());
  EXPECT_EQ(front_gyro.tick_ns, kTick.ns());
  EXPECT_EQ(front_gyro.white_variance_rad2_s2, node.white_variance_rad2_s2);
  EXPECT_EQ(front_gyro.turn_on_variance_rad2_s2, node.turn_on_variance_rad2_s2);
  EXPECT_EQ(front_gyro.largest_bias_rad_s, node.largest_bias_rad_s);
  EXPECT_EQ(front_gyro.starts_stationary, node.modes.start == core::Start::stationary);
  EXPECT_EQ(front_gyro.is_stationary, node.modes.is_stationary);
  std::size_t used = 0;
  for (const auto& mode : node.modes.decaying) {
    if (mode.noise_variance == 0.0F) continue;
    EXPECT_EQ(front_gyro.decaying[used].one_minus_phi, mode.one_minus_phi);
    EXPECT_EQ(front_gyro.decaying[used].noise_variance, mode.noise_variance);
    EXPECT_EQ(front_gyro.decaying[used].initial_variance, mode.initial_variance);
    ++used;
  }
  EXPECT_EQ(used, 6U);
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

TEST(CHeaderWithANameThatIsNone, IsRefused) {
  for (const char* name : {"", "2nd", "front gyro", "a-b", "int", "class"}) {
    EXPECT_THROW((void)format_c_header(find_model("lsm6dso"), kSamplePeriod, kTick, name),
                 std::invalid_argument)
        << name;
  }
}

}  // namespace
}  // namespace zerorate::model
