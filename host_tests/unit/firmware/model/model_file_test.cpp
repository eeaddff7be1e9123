#include "firmware/model/model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <system_error>

#include "firmware/model/node_model.hpp"
#include "host_tests/unit/firmware/model/full_model.hpp"

namespace zerorate::model {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

std::string message_of(const std::string& toml) {
  try {
    (void)parse_model(toml, "m.toml");
  } catch (const ModelFileError& error) {
    return error.what();
  }
  return "no error";
}

/// The full file with one piece of text replaced.
std::string with(const std::string& piece, const std::string& replacement) {
  std::string toml = kFullFile;
  const std::size_t at = toml.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  return toml.replace(at, piece.size(), replacement);
}

TEST(ModelFileWithEverything, IsReadInSiUnits) {
  const SensorModel model = parse_model(kFullFile, "m.toml");
  EXPECT_EQ(model.name, "A \"gyro\" at 25 °C");
  EXPECT_DOUBLE_EQ(model.white.angle_random_walk_rad_per_sqrt_s, 0.05 * kDeg);
  EXPECT_EQ(model.white.source, "table 1");
  EXPECT_DOUBLE_EQ(model.flicker->bias_instability_rad_s, 25.2 / 3600.0 * kDeg);
  EXPECT_EQ(model.flicker->order, 0.6);
  EXPECT_EQ(model.flicker->decades, 5);
  EXPECT_EQ(model.flicker->shortest_time_constant_s, 0.25);
  EXPECT_DOUBLE_EQ(model.rate_random_walk->coefficient_rad_s_per_sqrt_s, 2.5e-5 * kDeg);
  ASSERT_EQ(model.gauss_markov.size(), 2U);
  EXPECT_DOUBLE_EQ(model.gauss_markov[0].sigma_rad_s, 0.01 * kDeg);
  EXPECT_EQ(model.gauss_markov[0].time_constant_s, 600.0);
  EXPECT_DOUBLE_EQ(model.gauss_markov[1].sigma_rad_s, 0.003 * kDeg);
  ASSERT_EQ(model.harmonic.size(), 1U);
  EXPECT_DOUBLE_EQ(model.harmonic[0].rms_rad_s, 0.002 * kDeg);
  EXPECT_EQ(model.harmonic[0].frequency_hz, 0.55);
  EXPECT_EQ(model.harmonic[0].coherence_time_s, 40.0);
  EXPECT_EQ(model.temperature->reference_degc, 25.0);
  ASSERT_EQ(model.inputs.size(), 2U);
  EXPECT_EQ(model.inputs[0].quantity, InputQuantity::acceleration_x);
  EXPECT_DOUBLE_EQ(model.inputs[0].sigma_rad_s_per_unit, 0.05 * kDeg);
  EXPECT_DOUBLE_EQ(model.inputs[0].coefficient_rad_s_per_unit[1], -0.02 * kDeg);
  EXPECT_EQ(model.inputs[1].quantity, InputQuantity::vibration);
  EXPECT_EQ(model.inputs[0].without_accelerometer, WithoutAccelerometer::ignore);
  EXPECT_EQ(model.inputs[1].without_accelerometer, WithoutAccelerometer::flag);
  EXPECT_DOUBLE_EQ(model.temperature->slope_rad_s_per_k, -0.03 * kDeg);
  EXPECT_DOUBLE_EQ(model.temperature->slope_sigma_rad_s_per_k, 0.01 * kDeg);
  EXPECT_DOUBLE_EQ(model.temperature->curvature_rad_s_per_k2, 2e-4 * kDeg);
  EXPECT_DOUBLE_EQ(model.temperature->curvature_sigma_rad_s_per_k2, 1e-4 * kDeg);
  EXPECT_EQ(model.temperature->lag_s, 30.0);
  EXPECT_DOUBLE_EQ(model.warm_up->amplitude_rad_s, 0.05 * kDeg);
  EXPECT_DOUBLE_EQ(model.warm_up->amplitude_sigma_rad_s, 0.02 * kDeg);
  EXPECT_EQ(model.warm_up->time_constant_s, 600.0);
  EXPECT_DOUBLE_EQ(model.rate_ramp->slope_rad_s2, 2e-7 * kDeg);
  EXPECT_DOUBLE_EQ(model.rate_ramp->slope_sigma_rad_s2, 1e-6 * kDeg);
  EXPECT_DOUBLE_EQ(model.quantization->step_rad_s, 0.0125 * kDeg);
  EXPECT_EQ(model.quantization->method, QuantizationMethod::truncation);
  EXPECT_DOUBLE_EQ(model.outliers->probability, 1e-3);
  EXPECT_DOUBLE_EQ(model.motion_contamination->duration_s, 0.8);
  EXPECT_DOUBLE_EQ(model.variable_noise->variance_sigma, 0.2);
  EXPECT_DOUBLE_EQ(model.saturation->lower_rad_s, -240.5 * kDeg);
  EXPECT_DOUBLE_EQ(model.scale_factor->error[1], -0.0125);
  EXPECT_DOUBLE_EQ(model.scale_factor->sigma_per_k, 2e-4);
  EXPECT_EQ(model.scale_factor->reference_degc, 30.0);
  EXPECT_DOUBLE_EQ(model.mounting->tilt_sigma_rad, 8.0 * kDeg);
  EXPECT_DOUBLE_EQ(model.mounting->slope_sigma, 0.05);
  EXPECT_EQ(model.gate->threshold_sigma, 5.0);
  EXPECT_EQ(model.gate->longest_knock_s, 3.0);
  EXPECT_EQ(model.learning->hypotheses, 4);
  EXPECT_EQ(model.learning->half_life_s, 600.0);
  EXPECT_EQ(model.prior->order, 0.55);
  EXPECT_EQ(model.prior->order_sigma, 0.1);
  EXPECT_EQ(model.prior->amplitude_factor, 3.0);
  EXPECT_EQ(model.prior->source, "twelve sensors");
  EXPECT_EQ(model.node.start, core::Start::zero);
}

TEST(ModelFileWithEverything, IsWrittenAsItWasRead) {
  std::string toml = format_model(parse_model(kFullFile, "m.toml"));
  EXPECT_EQ(toml, kFullFile);
}

TEST(ModelFileWithTheLeast, HasTheDefaults) {
  const SensorModel model = parse_model(
      "schema = 'zerorate.model/2'\nname = 'g'\nwhite.angle_random_walk_dps_per_sqrt_hz = 0\n"
      "flicker.bias_instability_dph = 1_0\n",
      "m.toml");
  EXPECT_EQ(model.flicker->order, 0.5);
  EXPECT_EQ(model.flicker->decades, 6);
  EXPECT_EQ(model.flicker->shortest_time_constant_s, 0.5);
  EXPECT_DOUBLE_EQ(model.flicker->bias_instability_rad_s, 10.0 / 3600.0 * kDeg);
  EXPECT_FALSE(model.rate_random_walk || model.temperature || model.warm_up || model.rate_ramp);
  EXPECT_FALSE(model.quantization || model.gate);
  EXPECT_EQ(Quantization{}.method, QuantizationMethod::rounding);
  EXPECT_FALSE(model.outliers || model.motion_contamination || model.variable_noise ||
               model.saturation);
  EXPECT_TRUE(model.gauss_markov.empty() && model.harmonic.empty());
  EXPECT_EQ(model.node.start, core::Start::stationary);
}

TEST(ModelOfAnyNumbers, ComesBackBitForBit) {
  std::mt19937_64 random(20120301);
  std::uniform_real_distribution<double> exponent(-12.0, 6.0);
  const auto draw = [&] { return std::pow(10.0, exponent(random)); };
  for (int trial = 0; trial < 500; ++trial) {
    SensorModel model;
    model.name = "model " + std::to_string(trial);
    model.white.angle_random_walk_rad_per_sqrt_s = draw();
    model.flicker = Flicker{.bias_instability_rad_s = draw(),
                            .order = std::generate_canonical<double, 53>(random),
                            .decades = 1 + trial % 8,
                            .shortest_time_constant_s = draw(),
                            .source = "line\nbreak and \\"};
    model.gauss_markov.resize(static_cast<std::size_t>(trial % 3),
                              {.sigma_rad_s = draw(), .time_constant_s = draw()});
    model.temperature = TemperatureDrift{
        .reference_degc = -draw(), .slope_rad_s_per_k = -draw(), .slope_sigma_rad_s_per_k = draw()};
    model.node.start = trial % 2 == 0 ? core::Start::zero : core::Start::stationary;
    const std::string toml = format_model(model);
    ASSERT_EQ(parse_model(toml, "m.toml"), model) << toml;
  }
}

TEST(ModelOnDisk, ComesBackBitForBit) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "zerorate_model_file_test.toml";
  const SensorModel model = parse_model(kFullFile, "m.toml");
  std::ofstream(file) << format_model(model);
  EXPECT_EQ(read_model(file), model);
  std::filesystem::remove(file);
  EXPECT_THROW((void)read_model(file), std::system_error);
}

TEST(ModelFileWithAnUnknownName, SuggestsTheNearestWithPlace) {
  EXPECT_EQ(message_of(with("bias_instability_dph", "bias_instabilty_dph")),
            "m.toml:9:1: unknown key \"bias_instabilty_dph\" in [flicker]; did you mean "
            "\"bias_instability_dph\"?");
  EXPECT_EQ(message_of(with("decades", "decade")),
            "m.toml:11:1: unknown key \"decade\" in [flicker]; did you mean \"decades\"?");
  EXPECT_EQ(message_of(with("[warm_up]", "[warmup]")),
            "m.toml:53:2: unknown table \"warmup\"; did you mean \"warm_up\"?");
  EXPECT_EQ(message_of(with("name =", "pressure = 3\nname =")),
            "m.toml:2:1: unknown key \"pressure\"");
}

TEST(ModelFileWithAMissingKey, NamesWhatIsMissingAndExpected) {
  EXPECT_EQ(message_of(with("sigma_dps = 0.01\n", "")),
            "m.toml:18:1: missing \"sigma_dps\" in [gauss_markov]; expected a positive number");
  EXPECT_EQ(message_of("schema = 'zerorate.model/2'\nname = 'g'\n"),
            "m.toml:1:1: missing \"white\"; expected a table");
  EXPECT_THAT(message_of(""), testing::HasSubstr("missing \"schema\""));
}

TEST(ModelFileWithASingleTableWhereSeveralMayBe, EqualsAnArray) {
  EXPECT_EQ(parse_model(with("[[harmonic]]", "[harmonic]"), "m.toml"),
            parse_model(kFullFile, "m.toml"));
}

TEST(ModelFileOfAnotherSchema, IsRefused) {
  EXPECT_EQ(message_of(with("zerorate.model/2", "zerorate.model/3")),
            "m.toml:1:10: \"schema\": expected \"zerorate.model/2\"");
}

TEST(ModelFileWithTheFloorOfADataSheet, HasItsBiasInstability) {
  // sqrt(2 ln 2 / pi) = 0.664 (IEEE Std 952, annex C).
  constexpr double kB = 25.2 / 3600.0 * kDeg / 0.66428247026796;
  const SensorModel by_floor =
      parse_model(with("bias_instability_dph", "allan_floor_dph"), "m.toml");
  EXPECT_DOUBLE_EQ(by_floor.flicker->bias_instability_rad_s, kB);
  const SensorModel first_schema = parse_model(with("model/2", "model/1"), "m.toml");
  EXPECT_DOUBLE_EQ(first_schema.flicker->bias_instability_rad_s, kB);
}

TEST(ModelFileWithFloorAndBiasInstability, IsRefused) {
  EXPECT_EQ(message_of(with("order = 0.6", "allan_floor_dph = 3")),
            "m.toml:10:19: \"allan_floor_dph\" in [flicker]: expected this or "
            "\"bias_instability_dph\", not both");
}

// Inputs that break what the parser of toml++ takes for granted; found by fuzzing.
TEST(ModelFileThatTheParserDidNotExpect, IsRefusedWithItsLine) {
  EXPECT_EQ(message_of("schema = 'zerorate.model/2'\n\n[,"), "m.toml:3:1: this is not TOML");
  EXPECT_EQ(message_of("x = 1\n[\n[white]\n"), "m.toml:2:1: this is not TOML");
  EXPECT_THAT(message_of("schema = 'zerorate.model/2'\n\u00e9 = 1\n"),
              ::testing::StartsWith("m.toml:2:1: "));
}

TEST(ModelFileThatIsTooLong, IsRefusedBeforeItIsParsed) {
  std::string deep = "[a";
  for (int i = 0; i < 200'000; ++i) deep += ".a";
  EXPECT_EQ(message_of(deep + "]"),
            "m.toml:1:1: more than 32768 bytes; expected a short TOML file");
  std::string just_short_enough = "[a";
  while (just_short_enough.size() + 3 < 32'768) just_short_enough += ".a";
  EXPECT_THAT(message_of(just_short_enough + "]"), testing::HasSubstr("missing \"schema\""));
}

TEST(ModelFileWithAWrongType, TellsWhatWasExpected) {
  EXPECT_EQ(message_of(with("= 25.2", "= \"25.2\"")),
            "m.toml:9:24: \"bias_instability_dph\" in [flicker]: expected a positive number");
  EXPECT_EQ(message_of(with("decades = 5", "decades = 5.5")),
            "m.toml:11:11: \"decades\" in [flicker]: expected a whole number from 1 to 8");
  EXPECT_EQ(message_of(with("source = \"table 1\"", "source = 1")),
            "m.toml:6:10: \"source\" in [white]: expected text in quotes");
  EXPECT_EQ(message_of(with("start = \"zero\"", "start = \"warm\"")),
            "m.toml:115:9: \"start\" in [node]: expected \"zero\" or \"stationary\"");
  EXPECT_EQ(message_of("schema = 'zerorate.model/2'\nname = 'g'\nwhite = 3\n"),
            "m.toml:3:9: \"white\": expected a table, [white]");
  EXPECT_EQ(message_of("schema = 'zerorate.model/2'\ngauss_markov = 3\nname = 'g'\n"
                       "white.angle_random_walk_dps_per_sqrt_hz = 0\n"),
            "m.toml:2:16: \"gauss_markov\": expected tables, [[gauss_markov]]");
}

TEST(ModelFileWithAnImpossibleValue, TellsTheRule) {
  EXPECT_EQ(
      message_of(with("order = 0.6", "order = 1.0")),
      "m.toml:10:9: \"order\" in [flicker]: expected a number between 0 and 1, both excluded");
  for (const char* value : {"-0.01", "0", "nan", "inf", "true"}) {
    EXPECT_EQ(message_of(with("sigma_dps = 0.01", std::string("sigma_dps = ") + value)),
              "m.toml:19:13: \"sigma_dps\" in [gauss_markov]: expected a positive number")
        << value;
  }
  EXPECT_THAT(message_of(with("frequency_hz = 0.55", "frequency_hz = 1e10")),
              testing::HasSubstr("expected a positive frequency, at most 100 000 Hz"));
  EXPECT_THAT(message_of(with("decades = 5", "decades = 9")), testing::HasSubstr("from 1 to 8"));
}

TEST(ModelFileWithAScaleFactorError, HasThreeNumbersBelow20Percent) {
  for (const char* value :
       {"2", "[2]", "[0, 0, 0, 2]", "[0, 0, -20]", "[0, nan, 0]", "[0, 0, \"2\"]"}) {
    EXPECT_THAT(
        message_of(with("[0.5, -1.25, 2]", value)),
        testing::HasSubstr("\"error_percent\" in [scale_factor]: expected three numbers, of x, "
                           "y and z, each between -20 and 20 %"))
        << value;
  }
}

TEST(ModelFileWithNoScaleFactorError, HasNone) {
  SensorModel model = parse_model(with("error_percent = [0.5, -1.25, 2]\n", ""), "m.toml");
  EXPECT_EQ(model.scale_factor->error, (std::array<double, 3>{}));
  EXPECT_FALSE(make_full_node_model(model, kFullPeriod, kFullTick).scale.is_on());
  EXPECT_THAT(format_model(model), testing::Not(testing::HasSubstr("error_percent")));
}

TEST(ModelFileThatIsNotToml, TellsThePlace) {
  EXPECT_THAT(message_of("schema = 'zerorate.model/2'\nname = = 3\n"),
              testing::StartsWith("m.toml:2:8: "));
}

TEST(ModelThatNoFileCanHold, IsNotWritten) {
  SensorModel model = parse_model(kFullFile, "m.toml");
  model.flicker->order = std::numeric_limits<double>::quiet_NaN();
  try {
    (void)format_model(model);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "flicker.order is nan; expected a number between 0 and 1, both excluded");
  }
}

}  // namespace
}  // namespace zerorate::model
