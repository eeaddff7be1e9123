#include "host_tools/lib/calibrate/turn_guide.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "host_tools/lib/calibrate/calibration.hpp"
#include "host_tools/lib/calibrate/presentation.hpp"

namespace zerorate::calibrate {
namespace {

using Stage = TurnGuide::Stage;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kBiasSigma_dps = 0.002;

/// Messages of a node that is turned, 20 a second, into a guide.
class MadeNode {
 public:
  explicit MadeNode(const TurnGuide::Settings& settings = {}) : guide(settings) {
    message.health.calibrated = true;
    for (app::AxisRate& axis : message.axes) {
      axis.sigma = core::deg_per_s(static_cast<float>(kBiasSigma_dps));
    }
  }

  void rest(double length_s) {
    message.motion = core::Motion::still;
    for (int i = 0; i < std::lround(length_s * 20.0); ++i) step();
    has_rested = has_rested || length_s > 2.0;
  }
  /// Turns z by so many rounds, and x by as many degrees as asked for.
  void turn(double rounds, double length_s = 40.0, double x_deg = 0.0) {
    message.motion = core::Motion::moving;
    if (has_rested) {
      message.turn = {};
      message.turn_time = {};
      sigma(0.5F);
    }
    has_rested = false;
    const long count = std::lround(length_s * 20.0);
    const double begin_rad = double{message.turn[2].angle.in(core::rad)};
    for (long i = 1; i <= count; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(count);
      message.turn[2].angle =
          core::rad(static_cast<float>(begin_rad + 2.0 * std::numbers::pi * rounds * share));
      message.turn[0].angle = core::rad(static_cast<float>(x_deg * kRadPerDeg * share));
      message.turn_time = message.turn_time + kPeriod;
      step();
    }
  }
  void there_and_back(double there, double back) {
    rest(12.0);
    turn(there);
    rest(12.0);
    turn(back);
    rest(12.0);
    guide.finish();
  }
  void sigma(float sigma_rad) {
    for (app::AxisTurn& axis : message.turn) axis.sigma = core::rad(sigma_rad);
  }
  void step() {
    message.time = message.time + kPeriod;
    guide.take({.sequence = sequence++, .message = message});
  }

  static constexpr core::Duration kPeriod = core::Duration::milliseconds(50);
  TurnGuide guide;
  app::RateMessage message;
  std::uint32_t sequence = 1;
  bool has_rested = false;
};

CalibrationSettings ten_turns() {
  return {.turns = 10, .mark_sigma_rad = 2.0 * kRadPerDeg, .tolerance = {.sigma = 0.01}};
}
std::string problem_of(const MadeNode& node) {
  const Calibration calibration = calibrate(node.guide, ten_turns());
  return calibration.problems.empty() ? "" : calibration.problems.front();
}
bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(TurnGuide, LeadsThereAndBack) {
  MadeNode node;
  node.rest(5.0);
  EXPECT_EQ(node.guide.stage(), Stage::rest);
  EXPECT_EQ(instruction(node.guide, {}, 10), "stand still: 5 of 10 s");
  node.rest(6.0);
  EXPECT_EQ(node.guide.stage(), Stage::ready);
  EXPECT_EQ(instruction(node.guide, {}, 10), "turn it 10 times, stop at the mark");
  node.turn(3.25);
  EXPECT_EQ(instruction(node.guide, {}, 10), "+3.25 of 10 turns");
  node.turn(6.75);
  node.rest(4.0);
  EXPECT_EQ(instruction(node.guide, {}, 10), "+10.00 of 10 turns, stand still: 4 of 10 s");
  node.rest(7.0);
  EXPECT_EQ(instruction(node.guide, {}, 10), "turn it 10 times the other way, stop at the mark");
  node.turn(-10.0);
  node.rest(11.0);
  EXPECT_EQ(node.guide.stage(), Stage::done);
  ASSERT_EQ(node.guide.turns().size(), 2U);
  EXPECT_NEAR(node.guide.turns()[1].rounds(2), -10.0, 1e-5);
}

TEST(TurnGuide, SumsTheErrorOfTheBiasWithoutThatOfTheScale) {
  MadeNode node;
  node.there_and_back(10.0, -10.0);  // the published deviation is half a radian
  EXPECT_NEAR(node.guide.turns()[0].sigma_rad[2], 40.0 * kBiasSigma_dps * kRadPerDeg, 1e-6);
}

TEST(TurnGuide, TakesAPauseForOneAndSumsWhatTheNodeBeginsAnew) {
  MadeNode node;
  node.rest(12.0);
  node.turn(4.0);
  node.rest(3.0);  // long enough to learn from: the node begins its sum anew
  node.turn(6.0);
  node.rest(12.0);
  ASSERT_EQ(node.guide.turns().size(), 1U);
  EXPECT_NEAR(node.guide.turns()[0].rounds(2), 10.0, 1e-5);
}

TEST(TurnGuide, ForgetsABumpWhichDoesNotLengthenTheRest) {
  MadeNode node;
  node.rest(6.0);
  node.turn(0.001, 1.0);
  node.rest(5.0);
  EXPECT_EQ(node.guide.stage(), Stage::ready);
  node.turn(0.1, 1.0);  // a bump of 36 deg
  node.rest(12.0);
  EXPECT_EQ(node.guide.stage(), Stage::ready);
  EXPECT_TRUE(node.guide.turns().empty());
}

TEST(TurnGuide, LeavesOutATurnThatBeganTooEarly) {
  MadeNode node;
  node.rest(4.0);
  node.turn(10.0);
  node.rest(12.0);
  node.guide.finish();
  EXPECT_TRUE(node.guide.turns().empty());
  EXPECT_EQ(problem_of(node), "10.0 turns began after a rest of 4 s only; stand still for longer");
}

TEST(TurnGuide, BeginsAnewWithANodeThatDoes) {
  MadeNode node;
  node.rest(12.0);
  node.turn(5.0);
  node.sequence = 0;
  node.turn(5.0);
  node.rest(12.0);
  EXPECT_TRUE(node.guide.turns().empty());
  EXPECT_EQ(node.guide.restarts(), 1U);
  node.turn(10.0);
  node.rest(12.0);
  EXPECT_EQ(node.guide.turns().size(), 1U);
}

TEST(TurnGuide, IgnoresADatagramThatWasOvertaken) {
  MadeNode node;
  node.rest(12.0);
  wire::NumberedMessage late{.sequence = node.sequence - 2, .message = node.message};
  late.message.time = late.message.time - core::Duration::milliseconds(50);
  node.guide.take(late);
  EXPECT_EQ(node.guide.restarts(), 0U);
  EXPECT_EQ(node.guide.stage(), Stage::ready);
}

TEST(Calibration, FindsScaleAndAsymmetry) {
  MadeNode node;
  node.there_and_back(10.06, -10.02);
  const Calibration calibration = calibrate(node.guide, ten_turns());
  ASSERT_TRUE(calibration.fit);
  EXPECT_NEAR(calibration.fit->scale.value, 0.004, 1e-6);
  EXPECT_NEAR(calibration.fit->asymmetry->value, 0.002, 1e-6);
  EXPECT_FALSE(calibration.contradicts_tolerance());
  EXPECT_TRUE(calibration.notes.empty()) << calibration.notes.front();
  const auto json = nlohmann::json::parse(to_json(calibration));
  EXPECT_EQ(json["schema"], "zerorate.calibrate-turns/1");
  EXPECT_NEAR(json["scale_factor"]["percent"].get<double>(), 0.4, 1e-4);
  EXPECT_EQ(json["turns"].size(), 2U);
  EXPECT_TRUE(has(to_text(calibration), "scale factor error of axis z: +0.400 +- 0.133 %"))
      << to_text(calibration);
}

TEST(Calibration, GivesAModelTheErrorAndTheToleranceOfWhatIsLeft) {
  MadeNode node;
  node.there_and_back(10.06, -10.02);
  CalibrationSettings settings = ten_turns();
  settings.tolerance.error = {0.03, 0.0, 0.0};
  const Calibration calibration = calibrate(node.guide, settings);
  const model::ScaleFactor scale_factor = calibrated_scale_factor(calibration);
  EXPECT_NEAR(scale_factor.error[2], 0.004, 1e-6);
  EXPECT_EQ(scale_factor.error[0], 0.03);
  EXPECT_EQ(scale_factor.sigma, std::hypot(calibration.fit->scale.sigma, settings.drift_sigma));
  EXPECT_NEAR(scale_factor.asymmetry_sigma, std::hypot(0.002, calibration.fit->asymmetry->sigma),
              1e-6);
}

TEST(Calibration, AddsWhatTheNodeTakesOffAlready) {
  MadeNode node;
  node.there_and_back(10.06, -10.02);
  CalibrationSettings settings = ten_turns();
  settings.taken_off = {0.0, 0.0, 0.05};
  Calibration calibration = calibrate(node.guide, settings);
  EXPECT_NEAR(calibrated_scale_factor(calibration).error[2], 1.05 * 1.004 - 1.0, 1e-6);
  EXPECT_NEAR(calibration.fit->scale.value, 0.004, 1e-6);
  ASSERT_EQ(calibration.notes.size(), 1U);
  EXPECT_TRUE(has(calibration.notes[0], "takes +5.000 % off already")) << calibration.notes[0];

  settings.taken_off = {0.0, 0.0, 0.198};
  calibration = calibrate(node.guide, settings);
  EXPECT_FALSE(calibration.fit) << "more than a model may state";

  settings.taken_off.reset();
  calibration = calibrate(node.guide, settings);
  EXPECT_NEAR(calibrated_scale_factor(calibration).error[2], 0.004, 1e-6);
  EXPECT_TRUE(has(calibration.notes[0], "is not known here")) << calibration.notes[0];
  const auto json = nlohmann::json::parse(to_json(calibration));
  EXPECT_TRUE(json["taken_off_percent"].is_null());
  EXPECT_NEAR(json["model"]["error_percent"][2].get<double>(), 0.4, 1e-4);
}

TEST(Calibration, RefusesAWrongCount) {
  MadeNode node;
  node.there_and_back(11.02, -10.0);
  EXPECT_EQ(problem_of(node),
            "turn 1: 11.02 turns are nearer to 11 than to 10; count again, or say --turns 11");
  EXPECT_FALSE(calibrate(node.guide, ten_turns()).fit);
}

TEST(Calibration, SaysThatItContradictsTheTolerance) {
  MadeNode node;
  node.there_and_back(10.3, -10.3);
  const Calibration calibration = calibrate(node.guide, ten_turns());
  EXPECT_TRUE(calibration.contradicts_tolerance());
  EXPECT_TRUE(has(to_text(calibration), "contradicts the tolerance of 1 %"));
}

TEST(Calibration, SaysThatTheAxisIsAskew) {
  MadeNode node;
  node.rest(12.0);
  node.turn(9.96, 40.0, 3600.0 * std::sin(0.09));
  node.rest(12.0);
  const Calibration calibration = calibrate(node.guide, ten_turns());
  ASSERT_EQ(calibration.notes.size(), 2U);  // and one about the sense
  EXPECT_TRUE(has(calibration.notes[0], "the axis is askew by 5.2 deg")) << calibration.notes[0];
  EXPECT_TRUE(has(calibration.notes[1], "turn the other way, too")) << calibration.notes[1];
}

TEST(Calibration, RefusesFullScaleSilenceAndALostTurn) {
  MadeNode saturated;
  saturated.rest(12.0);
  saturated.message.health.saturated = true;
  saturated.turn(10.0);
  saturated.message.health.saturated = false;
  saturated.rest(12.0);
  EXPECT_EQ(problem_of(saturated), "turn 1: the gyro was at full scale; turn more slowly");

  MadeNode silent;
  silent.rest(12.0);
  silent.turn(5.0);
  silent.message.time = silent.message.time + core::Duration::milliseconds(700);
  silent.turn(5.0);
  silent.rest(12.0);
  EXPECT_EQ(problem_of(silent), "turn 1: the gyro gave no sample for 0.75 s; turn again");

  MadeNode lost;
  lost.rest(12.0);
  lost.turn(5.0);
  lost.sigma(std::numeric_limits<float>::infinity());
  lost.turn(5.0);
  lost.rest(12.0);
  EXPECT_TRUE(has(problem_of(lost), "the node lost the turn"));
}

TEST(Calibration, AllowsLostMessagesAndNotesThem) {
  MadeNode node;
  node.rest(12.0);
  node.turn(5.0);
  node.sequence += 14;
  node.message.time = node.message.time + MadeNode::kPeriod * 14;
  node.turn(5.0);
  node.rest(12.0);
  const Calibration calibration = calibrate(node.guide, ten_turns());
  ASSERT_TRUE(calibration.fit);
  EXPECT_TRUE(has(calibration.notes.front(), "in turn 1 14 messages were lost"));
}

TEST(Calibration, RefusesASteadyTurnThatTheNodeTookForItsBias) {
  MadeNode node;
  node.rest(12.0);
  node.turn(6.0);
  node.message.axes[2].bias = core::deg_per_s(36.0F);
  node.turn(4.0);
  node.rest(12.0);
  EXPECT_TRUE(has(problem_of(node), "the bias of the node changed by 36 deg/s"));
}

TEST(Calibration, NeedsATurnAndItsEnd) {
  MadeNode none;
  none.rest(12.0);
  none.guide.finish();
  EXPECT_TRUE(has(problem_of(none), "no turn was seen"));

  MadeNode unfinished;
  unfinished.rest(12.0);
  unfinished.turn(10.0);
  unfinished.guide.finish();
  EXPECT_TRUE(has(problem_of(unfinished), "the messages end before it stood still"));

  MadeNode back;
  back.rest(12.0);
  back.turn(10.0);
  back.rest(4.0);
  back.turn(-10.0);
  back.rest(12.0);
  EXPECT_TRUE(has(problem_of(back), "it went there and back, 10.0 turns")) << problem_of(back);
}

TEST(Calibration, SaysWhereAMiscountWouldNotShow) {
  MadeNode node;
  node.there_and_back(10.0, -10.0);
  CalibrationSettings settings = ten_turns();
  settings.tolerance.sigma = 0.03;
  const Calibration calibration = calibrate(node.guide, settings);
  ASSERT_EQ(calibration.notes.size(), 1U);
  EXPECT_TRUE(has(calibration.notes[0], "begin with 8 turns")) << calibration.notes[0];
}

}  // namespace
}  // namespace zerorate::calibrate
