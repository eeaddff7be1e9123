#include "host_tools/lib/diagnose/inputs/input_effects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tests/unit/host_tools/diagnose/inputs/tumbled_sensor.hpp"
#include "host_tools/lib/diagnose/inputs/input_words.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::diagnose {
namespace {

using ::testing::HasSubstr;
using testing::kRadPerDeg;
using ::testing::SizeIs;
using testing::Tumble;
using testing::Vector;

InputFindings findings_of(const Tumble& tumble) {
  return find_input_effects(input_ticks_of(testing::samples_of(tumble)), 0);
}

std::string obstacle(const InputFindings& findings, std::string_view effect) {
  for (const SelectionEvidence& evidence : findings.evidence) {
    if (evidence.effect == effect) return evidence.not_examined;
  }
  return "no evidence";
}

// 3.5 standard errors: one in 700 seeds fails by chance for three coefficients.
TEST(TumbledSensor, ShowsItsGSensitivityOnEachAxis) {
  const Vector dps_per_g{0.04, -0.02, 0.0};
  const InputFindings findings = findings_of({.stops = 16, .dps_per_g = dps_per_g, .seed = 2});
  ASSERT_THAT(findings.causes, SizeIs(1));
  EXPECT_EQ(findings.causes[0].effect, kGSensitivity);
  EXPECT_GT(findings.causes[0].probability, 0.95);
  EXPECT_THAT(findings.remarks, SizeIs(0));
  const InputEffect& effect = findings.effects[0];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(effect.value_rad_s[axis], dps_per_g[axis] * kRadPerDeg,
                3.5 * effect.standard_error_rad_s[axis])
        << axis;
    EXPECT_LT(effect.standard_error_rad_s[axis], 0.01 * kRadPerDeg);
  }
  EXPECT_EQ(findings.causes[0].parameters[2].name, "along_z_dps_per_g");
  EXPECT_THAT(findings.causes[0].sentence, HasSubstr("biases of the 16 standstills scatter by"));
}

TEST(TumbledSensor, WithoutASensitivityShowsNone) {
  for (const double flicker_dps : {0.0, 0.005, 0.02}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const InputFindings findings = findings_of(
          {.stops = 6 + 4 * seed, .bias_instability_dps = flicker_dps, .seed = 20 + seed});
      EXPECT_THAT(findings.causes, SizeIs(0)) << flicker_dps << " seed " << seed;
      EXPECT_EQ(obstacle(findings, kGSensitivity), "");
    }
  }
}

TEST(SensorInOneAttitude, CannotTellAndNamesTheCure) {
  const auto upright = [](std::size_t stop) {
    return Vector{0.01 * static_cast<double>(stop % 3), 0.0, 1.0};
  };
  const InputFindings findings = findings_of({.dps_per_g = {0.1, 0.1, 0.1}, .attitude = upright});
  EXPECT_THAT(findings.causes, SizeIs(0));
  EXPECT_EQ(obstacle(findings, kGSensitivity), "one attitude");
  ASSERT_THAT(findings.remarks, SizeIs(1));
  EXPECT_THAT(findings.remarks[0], HasSubstr("Record eight attitudes or more"));
}

TEST(SensorTurnedAboutZ, TellsTheSensitivityAlongXAndYOnly) {
  const auto turned = [](std::size_t stop) {
    const double angle = 2.4 * static_cast<double>(stop);
    return Vector{std::cos(angle), std::sin(angle), 0.0};
  };
  const InputFindings findings =
      findings_of({.stops = 14, .dps_per_g = {0.05, -0.05, 0.05}, .attitude = turned});
  ASSERT_THAT(findings.effects, SizeIs(1));
  EXPECT_TRUE(std::isfinite(findings.effects[0].standard_error_rad_s[1]));
  EXPECT_FALSE(std::isfinite(findings.effects[0].standard_error_rad_s[2]));
  EXPECT_THAT(findings.causes[0].parameters, SizeIs(2));
  EXPECT_THAT(findings.causes[0].sentence, HasSubstr("do not tell the sensitivity along z"));
}

TEST(GSensitivityInTheModel, HasATableOfEachAxisThatWasTold) {
  InputFindings findings;
  findings.effects.push_back({.name = std::string(kGSensitivity),
                              .value_rad_s = {0.1, 0.2, 0.3},
                              .standard_error_rad_s = {0.01, INFINITY, 0.03}});
  model::SensorModel model;
  add_inputs_to_model(findings, 1, model);
  ASSERT_THAT(model.inputs, SizeIs(2));
  EXPECT_EQ(model.inputs[1].quantity, model::InputQuantity::acceleration_z);
  EXPECT_EQ(model.inputs[1].sigma_rad_s_per_unit, 0.03);
  EXPECT_EQ(model.inputs[1].coefficient_rad_s_per_unit, (std::array{0.0, 0.3, 0.0}));
  findings.effects[0].worth = InputWorth{.standstills = 5, .gain_nats_a_standstill = -0.1};
  model.inputs.clear();
  add_inputs_to_model(findings, std::nullopt, model);
  EXPECT_THAT(model.inputs, SizeIs(0));
}

// The engine idles in every second stop.
TEST(ShakenSensor, ShowsTheRectificationOfItsVibration) {
  const auto upright = [](std::size_t) { return Vector{0.0, 0.0, 1.0}; };
  const auto idling = [](std::size_t stop) { return stop % 2 == 0 ? 0.002 : 0.1; };
  const InputFindings findings = findings_of(
      {.stops = 14, .period_s = 0.01, .dps_per_g2 = 2.0, .shaking_g = idling, .attitude = upright});
  ASSERT_THAT(findings.causes, SizeIs(1));
  EXPECT_EQ(findings.causes[0].effect, kVibrationRectification);
  const InputEffect& effect = findings.effects[0];
  EXPECT_NEAR(effect.value_rad_s[0], 2.0 * kRadPerDeg, 3.0 * effect.standard_error_rad_s[0]);
  EXPECT_LT(effect.standard_error_rad_s[0], 0.5 * kRadPerDeg);
}

TEST(RecordWithoutAccelerations, HasNoInputs) {
  identify::RestSamples samples = testing::samples_of({.stops = 2});
  samples.acceleration_m_s2.clear();
  const InputTicks ticks = input_ticks_of(samples);
  EXPECT_EQ(ticks.size(), 0U);
  EXPECT_THAT(find_input_effects(ticks, 0).evidence, SizeIs(0));
}

// Against a sum that is written out.
TEST(TickOfAccelerations, HasTheirMeanAndTheirVariance) {
  identify::RestSamples samples = testing::samples_of({.stops = 14, .period_s = 0.01});
  const InputTicks ticks = input_ticks_of(samples);
  const std::size_t count = ticks.means[0].samples;
  ASSERT_GE(count, 8U);
  double variance = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      const double g = double{samples.acceleration_m_s2[k][axis]} / 9.80665;
      sum += g;
      squares += g * g;
    }
    const auto n = static_cast<double>(count);
    EXPECT_NEAR(ticks.acceleration_g[0][axis], sum / n, 1e-6);
    variance += (squares - sum * sum / n) / (n - 1.0);
  }
  EXPECT_NEAR(ticks.vibration_g2[0], variance, 1e-6 * variance + 1e-9);
}

/// Raw counts of an accelerometer, and those of each standstill in the mean.
struct RawCounts {
  std::vector<Eigen::Vector3d> rows;
  std::vector<Eigen::Vector3d> standstills;
};

RawCounts read_counts(const std::filesystem::path& path) {
  recording::Input input{path};
  input.layout.set_columns("ax=ax_raw,ay=ay_raw,az=az_raw");
  input.layout.set_units("acceleration=mps2");
  recording::Reader reader{input};
  RawCounts counts;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double still = 0.0;
  const auto close = [&] {
    if (still > 300.0) counts.standstills.emplace_back(sum / still);
    sum.setZero();
    still = 0.0;
  };
  for (recording::Row row; reader.next(row);) {
    const auto& a = row.acceleration_m_s2;
    counts.rows.emplace_back(double{a[0]}, double{a[1]}, double{a[2]});
    if (!row.still) {
      close();
      continue;
    }
    sum += counts.rows.back();
    still += 1.0;
  }
  close();
  return counts;
}

/// Offset and scale by which the means of the standstills lie on a sphere of 1 g: Gauss-Newton.
std::pair<Eigen::Vector3d, Eigen::Vector3d> fit_sphere(const std::vector<Eigen::Vector3d>& means) {
  Eigen::Vector3d offset = Eigen::Vector3d::Constant(32768.0);
  Eigen::Vector3d scale = Eigen::Vector3d::Constant(4000.0);
  const auto count = static_cast<Eigen::Index>(means.size());
  for (int turn = 0; turn < 30; ++turn) {
    Eigen::MatrixXd slopes(count, 6);
    Eigen::VectorXd misses(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Vector3d g = (means[static_cast<std::size_t>(i)] - offset).cwiseQuotient(scale);
      misses[i] = 1.0 - g.squaredNorm();
      slopes.row(i).head<3>() = -2.0 * g.cwiseQuotient(scale);
      slopes.row(i).tail<3>() = -2.0 * g.cwiseAbs2().cwiseQuotient(scale);
    }
    const Eigen::VectorXd step = slopes.colPivHouseholderQr().solve(misses);
    offset += step.head<3>();
    scale += step.tail<3>();
  }
  return {offset, scale};
}

class XsensInManyAttitudes : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
    if (!folder) GTEST_SKIP() << "skipped: no recordings";
    const auto path = *folder / "xsens_multiposition/xsens_mti_100hz.csv.gz";
    const RawCounts counts = read_counts(path);
    const auto [offset, scale] = fit_sphere(counts.standstills);
    recording::Input input{path};
    input.layout.set_columns("ax=ax_raw,ay=ay_raw,az=az_raw");
    input.layout.set_units("acceleration=mps2");
    recording::Reader reader{input};
    samples_ = identify::read_rest_samples(reader);
    for (auto& acceleration : samples_.acceleration_m_s2) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto axis = static_cast<Eigen::Index>(i);
        const double g = (double{acceleration[i]} - offset[axis]) / scale[axis];
        acceleration[i] = static_cast<float>(g * 9.80665);
      }
    }
  }

  identify::RestSamples samples_;
};

TEST_F(XsensInManyAttitudes, FollowsTheAccelerationOnAllAxes) {
  const InputTicks ticks = input_ticks_of(samples_);
  EXPECT_EQ(ticks.standstills(), 38U);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const InputFindings findings = find_input_effects(ticks, axis);
    ASSERT_THAT(findings.causes, SizeIs(1)) << axis;
    EXPECT_EQ(findings.causes[0].effect, kGSensitivity);
    EXPECT_GE(findings.causes[0].probability, 0.95);
    ASSERT_TRUE(findings.effects[0].worth);
    EXPECT_GT(findings.effects[0].worth->gain_nats_a_standstill, 0.2);
  }
  const InputEffect y = find_input_effects(ticks, 1).effects[0];
  EXPECT_NEAR(y.value_rad_s[0] / kRadPerDeg, -0.12, 0.02);
}

// Biases beside attitudes of other standstills leave the noise of the sensor, and no cause.
TEST_F(XsensInManyAttitudes, DoesNotFollowThoseOfOtherStandstills) {
  InputTicks ticks = input_ticks_of(samples_);
  const InputTicks true_ticks = ticks;
  for (const std::size_t shift : {5U, 11U, 17U, 23U}) {
    for (std::size_t k = 0; k < ticks.size(); ++k) {
      const std::size_t other = (true_ticks.standstill[k] + shift) % true_ticks.standstills();
      const auto at = std::ranges::find(true_ticks.standstill, other);
      ticks.acceleration_g[k] =
          true_ticks.acceleration_g[static_cast<std::size_t>(at - true_ticks.standstill.begin())];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_THAT(find_input_effects(ticks, axis).causes, SizeIs(0)) << axis << " by " << shift;
    }
  }
}

}  // namespace
}  // namespace zerorate::diagnose
