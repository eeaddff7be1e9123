/// @file
/// A diagnosis as JSON, in words and as a report.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "host_tools/lib/diagnose/presentation/presentation.hpp"

namespace zerorate::diagnose {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// The example of a rate random walk.
Diagnosis explained_by_a_walk() {
  Diagnosis diagnosis{
      .axis = "z",
      .samples = 20'000,
      .sample_period_s = 0.1,
      .verdict = Verdict::explained,
      .causes = {{.effect = "rate_random_walk",
                  .gain_nats = 31.0,
                  .p_value = 1e-12,
                  .parameters = {{"coefficient_dps_per_sqrt_s", 1.2e-4, 1.0e-4, 1.5e-4}},
                  .alternatives = {{"fractional_order", 2.1}},
                  .probability = 0.89,
                  .set95 = {{"rate_random_walk", 0.89}, {"fractional_order", 0.11}},
                  .sentence = "A random walk of 1.2e-4 deg/s/sqrt(s) explains it."}},
      .misfit = {{"allan_deviation_dps", "tau 800 s", 2.1e-2, 4e-3, 1e-2},
                 {"excess_kurtosis", "", 0.0, -0.1, 0.1}},
      .base_adequacy = {.holds = false, .p_value = 1e-4, .failures = {"the spectrum"}},
      .gain = {.holdout_samples = 6000,
               .rsse_ratio = {.value = 0.9, .lo = 0.8, .hi = 0.95},
               .heading_drift_ratio = {.value = 0.75, .lo = 0.7, .hi = 0.8},
               .heading_drift_base_deg = {.value = 6.9, .lo = 6.0, .hi = 8.0},
               .heading_drift_extended_deg = {.value = 5.2, .lo = 4.8, .hi = 5.7},
               .drive_s = 300.0,
               .coverage95_base = {.value = 0.81, .lo = 0.7, .hi = 0.9},
               .coverage95_extended = {.value = 0.95, .lo = 0.9, .hi = 0.98}},
      .evidence = {{"rate_random_walk", 31.0, 4.0, true, ""},
                   {"rate_ramp", 17.0, 4.0, false, ""},
                   {"temperature_drift", 0.0, 0.0, false, "no temperature"}}};
  diagnosis.gain.ie_ratio.value = std::numeric_limits<double>::quiet_NaN();
  return diagnosis;
}

TEST(DiagnosisJson, HasTheKeysOfTheSchema) {
  const std::array axes{explained_by_a_walk()};
  const auto json = nlohmann::json::parse(to_json(axes));
  EXPECT_EQ(json.at("schema"), "zerorate.diagnosis/1");
  EXPECT_EQ(json.at("verdict"), "explained");
  const auto& cause = json.at("causes").at(0);
  EXPECT_EQ(cause.at("name"), "rate_random_walk");
  EXPECT_EQ(cause.at("parameters").at("coefficient_dps_per_sqrt_s_ci95").at(1), 1.5e-4);
  EXPECT_EQ(cause.at("alternatives").at(0).at("less_likely_by_nats"), 2.1);
  EXPECT_EQ(cause.at("probability"), 0.89);
  EXPECT_EQ(cause.at("stands_alone"), true);
  EXPECT_EQ(cause.at("set95").at(1).at("name"), "fractional_order");
  EXPECT_EQ(cause.at("in_model"), true);
  EXPECT_EQ(json.at("material"), false);
  EXPECT_TRUE(json.at("remainder").empty());
  // Rows inside the envelope are no misfit; what was not measured is null.
  EXPECT_EQ(json.at("misfit").size(), 1U);
  EXPECT_EQ(json.at("adequacy").at("base").at("holds"), false);
  EXPECT_TRUE(json.at("gain").at("ie_ratio").is_null());
  EXPECT_EQ(json.at("gain").at("rsse_ratio_ci95").at(0), 0.8);
}

TEST(DiagnosisJsonOfSeveralAxes, IsAListOfSuchObjects) {
  const std::array axes{explained_by_a_walk(), explained_by_a_walk()};
  const auto json = nlohmann::json::parse(to_json(axes));
  EXPECT_EQ(json.at("axes").size(), 2U);
  EXPECT_EQ(json.at("axes").at(1).at("axis"), "z");
}

TEST(DiagnosisInWords, SaysMisfitCauseRivalsAndGain) {
  const std::string words = in_words(explained_by_a_walk());
  EXPECT_THAT(words, HasSubstr("The Allan deviation (tau 800 s) is 0.021 deg/s, 2.1 times the most "
                               "that white noise, 1/f noise and a constant give."));
  EXPECT_THAT(words, HasSubstr("A random walk of 1.2e-4 deg/s/sqrt(s) explains it."));
  EXPECT_THAT(words, HasSubstr("fractional order explains it almost as well (2.1 nats less)"));
  EXPECT_THAT(words, HasSubstr("rate ramp comes nearest and does not do (14 nats worse)"));
  EXPECT_THAT(
      words,
      HasSubstr(
          "With its extensions the heading drift in a drive of 300 s falls from 6.9 to 5.2 deg "
          "[4.8, 5.7], and the 95 % interval covers 95 % instead of 81 %."));
}

TEST(DiagnosisInWords, GivesTheDensityItsUnit) {
  Diagnosis diagnosis = explained_by_a_walk();
  diagnosis.misfit.front() = {"density_dps_per_sqrt_hz", "0.001 Hz", 2.1e-2, 4e-3, 1e-2};
  EXPECT_THAT(in_words(diagnosis), HasSubstr("The noise density (0.001 Hz) is 0.021 "
                                             "deg/s/sqrt(Hz), 2.1 times the most"));
}

TEST(PlainParameter, HasItsUnitBehindAComma) {
  EXPECT_EQ(plain_parameter("coefficient_dps_per_sqrt_s"), "coefficient, deg/s/sqrt(s)");
  EXPECT_EQ(plain_parameter("quadratic_dps_per_k2"), "quadratic, deg/s/K^2");
  EXPECT_EQ(plain_parameter("along_x_dps_per_g"), "along x, deg/s/g");
  EXPECT_EQ(plain_parameter("rectification_dps_per_g2"), "rectification, deg/s/g^2");
  EXPECT_EQ(plain_parameter("time_constant_s"), "time constant, s");
  EXPECT_EQ(plain_parameter("cut_off_hz"), "cut off, Hz");
  EXPECT_EQ(plain_parameter("order"), "order");
  EXPECT_EQ(plain_parameter("jumps"), "jumps");
}

TEST(HeadingDriftInWords, NamesAnUnchangedFigureOnce) {
  Diagnosis diagnosis = explained_by_a_walk();
  EXPECT_EQ(drift_in_words(diagnosis), "6.9 to 5.2 deg in 300 s");
  diagnosis.gain.heading_drift_base_deg.value = 5.2004;
  EXPECT_EQ(drift_in_words(diagnosis), "5.2 deg in 300 s");
}

TEST(DiagnosisInWords, SaysThatNothingChanges) {
  Diagnosis diagnosis = explained_by_a_walk();
  diagnosis.gain.heading_drift_ratio = {.value = 0.995, .lo = 0.97, .hi = 1.02};
  diagnosis.gain.coverage95_base.value = 0.952;
  EXPECT_THAT(
      in_words(diagnosis),
      HasSubstr("Neither the heading drift (5.2 deg in a drive of 300 s) nor the coverage of "
                "the 95 % interval (95 %) changes."));
}

TEST(CausesByCost, BeginWithWhatTheHeadingDriftsBy) {
  Diagnosis diagnosis;
  diagnosis.causes = {{.effect = "quantization", .probability = 1.0},
                      {.effect = "rate_ramp",
                       .probability = 0.97,
                       .heading_drift_ratio = BootstrapFigure{.value = 0.9, .lo = 0.8, .hi = 1.0}},
                      {.effect = "rate_random_walk",
                       .probability = 0.93,
                       .heading_drift_ratio = BootstrapFigure{.value = 0.7, .lo = 0.6, .hi = 0.8}}};
  EXPECT_EQ(causes_in_words(diagnosis),
            "rate random walk (93 % sure), rate ramp (97 % sure), quantization (100 % sure)");
  const std::array axes{diagnosis};
  const auto json = nlohmann::json::parse(to_json(axes));
  EXPECT_EQ(json.at("causes").at(0).at("name"), "quantization");
  EXPECT_TRUE(json.at("causes").at(0).at("heading_drift_ratio").is_null());
  EXPECT_EQ(json.at("causes").at(2).at("heading_drift_ratio"), 0.7);
}

TEST(DiagnosisInWords, SaysOneOfWhereNoNameStandsAlone) {
  Diagnosis diagnosis = explained_by_a_walk();
  diagnosis.causes.front().probability = 0.6;
  diagnosis.causes.front().set95 = {{"rate_random_walk", 0.6}, {"fractional_order", 0.4}};
  EXPECT_THAT(in_words(diagnosis), HasSubstr("cannot decide: it is one of rate random walk (60 %), "
                                             "fractional order (40 %)."));
}

TEST(DiagnosisInWords, SaysWhatTheModelLeavesOutAndWhy) {
  Diagnosis diagnosis = explained_by_a_walk();
  diagnosis.causes.front().in_model = false;
  diagnosis.causes.front().left_out_because = "it predicts no better";
  const std::string words = in_words(diagnosis);
  EXPECT_THAT(words, HasSubstr("The model leaves out the rate random walk: it predicts no better. "
                               "The model is that of zerorate characterize."));
  EXPECT_THAT(words, Not(HasSubstr("heading drift")));
}

TEST(DiagnosisInWords, SaysFirstWhetherTheRemainderMatters) {
  Diagnosis diagnosis = explained_by_a_walk();
  diagnosis.verdict = Verdict::unexplained;
  EXPECT_EQ(verdict_in_words(diagnosis),
            "unexplained, and the recording does not show whether it matters");
  EXPECT_FALSE(diagnosis.is_material().has_value());
  diagnosis.materiality = Materiality{
      .by_drive = {
          {.drive_s = 60.0, .drives = 30, .ratio = {.value = 1.02, .lo = 0.9, .hi = 1.15}}}};
  EXPECT_EQ(verdict_in_words(diagnosis), "unexplained, but it does not matter for the heading");
  EXPECT_TRUE(in_words(diagnosis).starts_with(
      "The heading error is 1.02 [0.90, 1.15] times over 60 s (no matter) that of simulations"));
}

TEST(MaterialityOfARemainder, IsUndecidedWhereAnIntervalIsTooWide) {
  Diagnosis diagnosis = explained_by_a_walk();
  diagnosis.verdict = Verdict::unexplained;
  const HeadingExcess none{.drive_s = 10.0, .ratio = {.value = 1.01, .lo = 0.95, .hi = 1.08}};
  const HeadingExcess wide{.drive_s = 300.0, .ratio = {.value = 1.1, .lo = 0.8, .hi = 1.5}};
  const HeadingExcess small{.drive_s = 60.0, .ratio = {.value = 1.03, .lo = 1.01, .hi = 1.05}};
  const HeadingExcess large{.drive_s = 60.0, .ratio = {.value = 1.3, .lo = 1.1, .hi = 1.6}};
  const auto material = [&](std::vector<HeadingExcess> by_drive) {
    diagnosis.materiality = Materiality{std::move(by_drive)};
    const std::array axes{diagnosis};
    return nlohmann::json::parse(to_json(axes)).at("material");
  };
  EXPECT_EQ(material({none, small}), false);
  EXPECT_TRUE(material({none, wide}).is_null());
  EXPECT_EQ(material({none, wide, large}), true);
}

TEST(DiagnosisInWords, NamesNoCauseAsProvenWhenSomethingIsLeft) {
  Diagnosis diagnosis = explained_by_a_walk();
  diagnosis.verdict = Verdict::unexplained;
  diagnosis.extended_adequacy = {.holds = false, .failures = {"the innovations are skewed"}};
  EXPECT_THAT(in_words(diagnosis), HasSubstr("no cause is proven: the innovations are skewed."));
  diagnosis.causes.clear();
  EXPECT_THAT(in_words(diagnosis), HasSubstr("No effect of the catalogue explains it"));
}

TEST(DiagnosisInWords, SaysThatNothingIsWrong) {
  const std::string words = in_words({.samples = 20'000});
  EXPECT_THAT(words, HasSubstr("describe this recording"));
  EXPECT_THAT(words, Not(HasSubstr("nats")));
}

TEST(DiagnosisReport, HoldsVerdictEvidenceGainAndModel) {
  Diagnosis diagnosis = explained_by_a_walk();
  diagnosis.extended_model.name = "extended";
  diagnosis.extended_model.white.angle_random_walk_rad_per_sqrt_s = 1e-4;
  const std::array axes{diagnosis};
  const std::string html =
      make_report(axes, {.title = "t", .recording = "rest.csv", .provenance = "p"}).html();
  for (const char* expected :
       {"Axis z: explained", "coefficient, deg/s/sqrt(s)", "not examined: no temperature",
        "Axis z: what the extension buys", "zerorate replay rest.csv", "zerorate.model/2"}) {
    EXPECT_THAT(html, HasSubstr(expected));
  }
}

}  // namespace
}  // namespace zerorate::diagnose
