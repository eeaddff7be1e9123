// Worth of the tables [[input]] that the diagnosis writes, for a node that learns its noise and for
// one that does not: the bias of the next standstill, predicted before it is measured, on data that
// the diagnosis has not seen. The table stands in docs/reference/standstill-campaign.md.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lab/campaign/standstill_recording.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::campaign {
namespace {

using OneAxisNode = app::GyroNode<model::kWidestLearningShape, app::NodeCapacity{.axes = 1}>;

constexpr double kSeen = 0.7;  // share of the recording that is diagnosed
constexpr double kStandardGravity_m_s2 = 9.80665;

BlindRecording beginning_of(BlindRecording blind) {
  const auto size = static_cast<std::size_t>(kSeen * static_cast<double>(blind.signal.size()));
  blind.signal.rate_rad_s.resize(size);
  blind.signal.missing.resize(size);
  blind.signal.temperature_degc.resize(size);
  blind.acceleration_m_s2.resize(size);
  blind.still.resize(size);
  return blind;
}

diagnose::Diagnosis diagnosis_of(const BlindRecording& blind) {
  const zerorate::testing::ScratchFolder folder;
  const std::filesystem::path path = folder.path() / "recording.csv";
  write_recording(blind, path);
  recording::Reader reader{path};
  return diagnose::diagnose(diagnose::record_of(identify::read_rest_samples(reader), 0));
}

/// Errors of the bias that is predicted for a standstill.
struct NextStops {
  double squares = 0.0;  ///< squared errors over the square of the white noise
  double covered = 0.0;
  double stops = 0.0;

  [[nodiscard]] double rms() const { return std::sqrt(squares / stops); }
  [[nodiscard]] double coverage() const { return covered / stops; }
};

core::GyroSample sample_of(const BlindRecording& blind, std::size_t k) {
  core::GyroSample sample{.time = core::Instant::from_ns(static_cast<std::int64_t>(
                              std::llround(blind.signal.time_s(k) * 1e9))),
                          .has_acceleration = true};
  sample.rate[0] = core::rad_per_s(static_cast<float>(blind.signal.rate_rad_s[k]));
  for (std::size_t i = 0; i < 3; ++i) {
    sample.acceleration[i] = core::standard_gravity(
        static_cast<float>(double{blind.acceleration_m_s2[k][i]} / kStandardGravity_m_s2));
  }
  return sample;
}

/// Runs a node over the whole recording; what it predicts after the seen part counts.
void predict(const BlindRecording& blind, model::SensorModel sensor, bool learns, NextStops& next) {
  if (!learns) sensor.learning = model::Learning{.hypotheses = 1};
  const auto period = core::Duration::nanoseconds(std::llround(blind.signal.sample_period_s * 1e9));
  const OneAxisNode::Params params{.model = model::make_node_model<model::kWidestLearningShape>(
                                       sensor, period, core::Duration::milliseconds(500))};
  OneAxisNode node{params};
  const double white2 = double{params.model.white_variance_rad2_s2};
  const std::size_t size = blind.signal.size();
  for (std::size_t k = 0; k < size; ++k) {
    const core::GyroSample sample = sample_of(blind, k);
    if (!blind.still[k]) node.pulse(sample.time);
    // A second into the standstill the node has its acceleration, and has learnt nothing of it.
    const auto second = static_cast<std::size_t>(1.0 / blind.signal.sample_period_s);
    const bool begins = k > second && blind.still[k] && !blind.still[k - 1];
    (void)node.step(sample);
    if (!begins || static_cast<double>(k) < kSeen * static_cast<double>(size)) continue;
    const core::Prediction predicted = node.predict(app::Predictor::kalman, 0);
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t j = k; j < size && blind.still[j]; ++j, ++count) {
      sum += blind.signal.rate_rad_s[j];
    }
    const double error = sum / count - double{predicted.bias_rad_s};
    const double variance = double{predicted.variance_rad2_s2} + white2 / count;
    next.squares += error * error / white2;
    next.covered += error * error < 1.959964 * 1.959964 * variance ? 1.0 : 0.0;
    ++next.stops;
  }
}

void expect_worth(std::string_view effect, std::size_t place) {
  constexpr std::size_t kRecordings = 20;
  std::array<NextStops, 2> base;  // learning off and on
  std::array<NextStops, 2> extended;
  std::size_t in_model = 0;
  for (std::size_t i = 0; i < kRecordings; ++i) {
    const BlindOptions options{.seed = 7, .nats = 80.0};
    const auto blind = draw_standstill_recording(options, 6 * i + place);
    ASSERT_EQ(blind.truth.front(), effect);
    const auto diagnosis = diagnosis_of(beginning_of(blind));
    if (diagnosis.extended_model.inputs.empty()) continue;  // not found, or it does not pay
    ++in_model;
    for (const bool learns : {false, true}) {
      predict(blind, diagnosis.base_model, learns, base.at(learns ? 1U : 0U));
      predict(blind, diagnosis.extended_model, learns, extended.at(learns ? 1U : 0U));
    }
  }
  for (const bool learns : {false, true}) {
    const NextStops& before = base.at(learns ? 1U : 0U);
    const NextStops& after = extended.at(learns ? 1U : 0U);
    std::printf(
        "%s, learning %s: in %zu of %zu models, error %.3f of that of the base, coverage %.3f "
        "before, %.3f after, %.0f standstills\n",
        std::string(effect).c_str(), learns ? "on" : "off", in_model, kRecordings,
        after.rms() / before.rms(), before.coverage(), after.coverage(), before.stops);
    EXPECT_LT(after.rms(), before.rms());
  }
}

TEST(InputsThatWereFound, PredictTheNextStandstillBetter) {
  expect_worth("g_sensitivity", 0);
  expect_worth("vibration_rectification", 1);
}

}  // namespace
}  // namespace zerorate::campaign
