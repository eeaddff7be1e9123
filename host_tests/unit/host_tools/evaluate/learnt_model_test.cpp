#include "host_tools/lib/evaluate/learnt_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tests/support/made_recording.hpp"
#include "host_tools/lib/evaluate/replay_json.hpp"
#include "host_tools/lib/evaluate/replay_report.hpp"

namespace zerorate::evaluate {
namespace {

using zerorate::testing::ScratchFolder;

constexpr double kRadSPerDph = std::numbers::pi / 180.0 / 3600.0;

// A log-normal variable whose standard deviation is its mean has the logarithmic variance log 2 and
// the median mean / sqrt 2.
TEST(LearntModelInUnits, HasIntervalsByHand) {
  const app::LearntNoise noise{
      .order = {0.6F, 0.1F},
      .bias_instability_rad_s = {static_cast<float>(10.0 * kRadSPerDph),
                                 static_cast<float>(10.0 * kRadSPerDph)},
      .angle_random_walk_rad_per_sqrt_s = {static_cast<float>(std::numbers::pi / 180.0), 0.0F},
      .stops = 3.5F};
  const LearntModel model = learnt_model(noise);
  EXPECT_NEAR(model.order.value, 0.6, 1e-6);
  EXPECT_NEAR(model.order.lo, 0.6 - 0.1959964, 1e-6);
  EXPECT_NEAR(model.order.hi, 0.6 + 0.1959964, 1e-6);
  EXPECT_NEAR(model.bias_instability_dph.value, 10.0, 1e-5);
  const double factor = std::exp(1.959964 * std::sqrt(std::numbers::ln2));
  EXPECT_NEAR(model.bias_instability_dph.lo, 10.0 / std::numbers::sqrt2 / factor, 1e-4);
  EXPECT_NEAR(model.bias_instability_dph.hi, 10.0 / std::numbers::sqrt2 * factor, 1e-4);
  EXPECT_NEAR(model.angle_random_walk_dps_per_sqrt_hz.value, 1.0, 1e-6);
  EXPECT_EQ(model.angle_random_walk_dps_per_sqrt_hz.lo, model.angle_random_walk_dps_per_sqrt_hz.hi);
  EXPECT_EQ(model.stops, 3.5);
  EXPECT_EQ(in_words(model.order), "0.6 (0.404 to 0.796)");
  EXPECT_TRUE(model.order.contains(0.7));
  EXPECT_FALSE(model.order.contains(0.8));
}

// A posterior that has gone to one noise of the grid: its cell is left.
TEST(LearntModelOnAMesh, IsNoMoreCertainThanTheMesh) {
  const model::SensorModel model = testing::sensor_model();
  const LearntMesh mesh = mesh_of(model);
  const model::Prior prior;
  EXPECT_NEAR(mesh.order_step, 1.5 * prior.order_sigma, 1e-9);
  EXPECT_NEAR(mesh.log_amplitude_step, 0.75 * std::log(prior.amplitude_factor), 1e-9);
  const auto order = static_cast<float>(mesh.highest_order);
  const auto white = static_cast<float>(model.white.angle_random_walk_rad_per_sqrt_s);
  const float bias = white * static_cast<float>(std::sqrt(mesh.lowest_ratio * mesh.highest_ratio));
  const app::LearntNoise noise{.order = {order, 0.0F},
                               .bias_instability_rad_s = {bias, 0.0F},
                               .angle_random_walk_rad_per_sqrt_s = {white, 0.0F},
                               .stops = 2.9F};
  const LearntModel learnt = learnt_model(noise, mesh);
  EXPECT_NEAR(learnt.order.hi - learnt.order.lo, 2.0 * 1.959964 * mesh.order_step / std::sqrt(12.0),
              1e-6);
  EXPECT_NEAR(std::log(learnt.bias_instability_dph.hi / learnt.bias_instability_dph.lo),
              2.0 * 1.959964 * mesh.log_amplitude_step / std::sqrt(12.0), 1e-5);
  EXPECT_TRUE(learnt.is_order_at_edge);
  EXPECT_FALSE(learnt.is_bias_instability_at_edge);
  EXPECT_EQ(edge_in_words(learnt, mesh).find("d is at the edge"), 0U);
}

TEST(LearntModelOnAMesh, NamesADriftBeyondTheMesh) {
  const LearntMesh mesh = mesh_of(testing::sensor_model());
  const app::LearntNoise noise{.order = {0.99F, 0.01F},
                               .bias_instability_rad_s = {1e-5F, 1e-6F},
                               .angle_random_walk_rad_per_sqrt_s = {1e-4F, 1e-6F},
                               .stops = 2.0F};
  const LearntModel learnt = learnt_model(noise, mesh);
  EXPECT_TRUE(learnt.is_order_at_edge);
  EXPECT_EQ(edge_in_words(learnt, mesh).find("the bias drifts like a random walk"), 0U);
}

class ReplayOfASensorAtRest : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = testing::write_rows(folder_.path() / "rest.csv", testing::kRates,
                                testing::rows_at_rest(3000, 1.0, 4));
  }

  ReplayResult replay_with(const ReplayOptions& options) {
    trace_ = ReplayTrace{1};
    recording::Reader reader{path_};
    return replay(reader, options,
                  {.on_sample = [this](const ReplayedSample& sample) { trace_.add(sample); },
                   .on_learnt =
                       [this](const LearntStop& stop) {
                         trace_.add(stop);
                         newest_ = stop.axes;
                       }});
  }
  static nlohmann::json learnt_of(const ReplayResult& result, const char* axis) {
    return nlohmann::json::parse(to_json(result, {0, 1, 2}))["axes"][axis].at("learnt");
  }
  std::string report_of(const ReplayResult& result) const {
    return make_report(result, {0, 1, 2}, trace_, {}, options_.model, {}).html();
  }

  ReplayOptions options_{.model = testing::sensor_model(),
                         .schedule = ScheduleParams{.still_s = 60.0, .drive_s = 120.0, .seed = 3}};
  ReplayTrace trace_{1};
  LearntNoises newest_{};

 private:
  ScratchFolder folder_;
  std::filesystem::path path_;
};

TEST_F(ReplayOfASensorAtRest, TellsAtTheEndOfEachStopWhatWasLearnt) {
  const ReplayResult result = replay_with(options_);
  ASSERT_TRUE(result.learnt);
  EXPECT_EQ(*result.learnt, newest_);
  // Stops too short to measure in tell nothing.
  EXPECT_GT(trace_.models().size(), 5U);
  EXPECT_LE(trace_.models().size(), trace_.stops().size());
  for (const TracedModel& traced : trace_.models()) {
    std::size_t ended = 0;
    for (const auto& stop : trace_.stops()) {
      if (traced.time_s >= stop.to_s && traced.time_s <= stop.to_s + 2.0) ++ended;
    }
    EXPECT_EQ(ended, 1U) << traced.time_s;
  }
  const LearntModel last = learnt_model(newest_[1], result.mesh);
  EXPECT_EQ(trace_.models().back().model.order.value, last.order.value);
  const nlohmann::json learnt = learnt_of(result, "y");
  EXPECT_EQ(learnt.at("order").get<double>(), last.order.value);
  EXPECT_EQ(learnt.at("bias_instability_dph_ci95").at(1).get<double>(),
            last.bias_instability_dph.hi);
  EXPECT_EQ(learnt.at("angle_random_walk_dps_per_sqrt_hz_ci95").at(0).get<double>(),
            last.angle_random_walk_dps_per_sqrt_hz.lo);
  EXPECT_EQ(learnt.at("stops").get<double>(), last.stops);
  const std::string report = report_of(result);
  for (const char* text : {"Noise model learnt from the stops", "Order of axis y",
                           "Bias instability of axis y", "Angle random walk of axis y"}) {
    EXPECT_NE(report.find(text), std::string::npos) << text;
  }
}

TEST_F(ReplayOfASensorAtRest, ReportsNothingWithoutLearning) {
  ReplayOptions trusting = options_;
  trusting.learns_noise = false;
  ReplayOptions of_one_hypothesis = options_;
  of_one_hypothesis.model.learning = model::Learning{.hypotheses = 1};
  for (const ReplayOptions& options : {trusting, of_one_hypothesis}) {
    const ReplayResult result = replay_with(options);
    EXPECT_FALSE(result.learnt);
    EXPECT_TRUE(trace_.models().empty());
    EXPECT_TRUE(learnt_of(result, "x").is_null());
    EXPECT_EQ(report_of(result).find("learnt from the stops"), std::string::npos);
  }
}

}  // namespace
}  // namespace zerorate::evaluate
