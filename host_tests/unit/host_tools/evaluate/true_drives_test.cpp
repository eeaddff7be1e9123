#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tests/support/made_recording.hpp"
#include "host_tools/lib/evaluate/replay_json.hpp"
#include "host_tools/lib/evaluate/replay_report.hpp"
#include "host_tools/lib/evaluate/replay_trace.hpp"
#include "host_tools/lib/evaluate/true_drives_report.hpp"

namespace zerorate::evaluate {
namespace {

using testing::kRadPerDeg;
using testing::sensor_model;

constexpr recording::Columns kWithReference{.rate_unit = recording::RateUnit::rad_per_s,
                                            .odometer = true,
                                            .ref_heading = true,
                                            .ref_rate = true,
                                            .ref_speed = true};

/// Stops of 40 s, drives of 60 s that turn by 5 deg/s for 30 s; the heading counts against z.
std::vector<recording::Row> rows_of_a_drive(double length_s, std::uint64_t seed) {
  constexpr double kPeriod_s = 0.1;
  auto rows =
      testing::rows_at_rest(static_cast<std::size_t>(length_s / kPeriod_s), kPeriod_s, seed);
  double heading_deg = 350.0;
  double travelled_m = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double phase = std::fmod(kPeriod_s * static_cast<double>(k), 100.0);
    const bool moves = phase > 40.0;
    const double rate_dps = phase > 55.0 && phase <= 85.0 ? 5.0 : 0.0;
    heading_deg -= rate_dps * kPeriod_s;
    travelled_m += moves ? 10.0 * kPeriod_s : 0.0;
    rows[k].rate_rad_s[2] += static_cast<float>(rate_dps * kRadPerDeg);
    rows[k].odometer_pulses = static_cast<std::int64_t>(travelled_m * 20.0);
    rows[k].ref_heading_rad = static_cast<float>(std::remainder(heading_deg, 360.0) * kRadPerDeg);
    rows[k].ref_rate_rad_s = static_cast<float>(-rate_dps * kRadPerDeg);
    rows[k].ref_speed_m_s = moves ? 10.0F : 0.0F;
  }
  return rows;
}

struct Scored {
  ReplayResult result;
  std::vector<app::RateMessage> messages;
};

Scored replay_with_truth(const std::filesystem::path& path, const ReplayOptions& options,
                         const truth::TruthOptions& truth_options = {}) {
  recording::Reader reference{path};
  Scored scored;
  const ReplayObserver observer{
      .truth = truth::find_truth(truth::read_track(reference), truth_options),
      .on_sample = [&](const ReplayedSample& sample) {
        scored.messages.push_back(sample.message);
      }};
  recording::Reader reader{path};
  scored.result = replay(reader, options, observer);
  return scored;
}

/// Sum of a rate about z over the samples after one up to another, in integers of the sample
/// period.
template <class Rate>
double turned_by_hand(const std::vector<app::RateMessage>& messages, std::size_t from,
                      std::size_t to, const Rate& rate_rad_s) {
  long double sum = 0.0L;
  for (std::size_t k = from + 1; k <= to; ++k) {
    sum += static_cast<long double>(rate_rad_s(messages[k].axes[2]));
  }
  return static_cast<double>(0.1L * sum);
}

TEST(DrivesAgainstAReference, IntegrateWhatIsPublished) {
  const zerorate::testing::ScratchFolder folder;
  const auto path = testing::write_rows(folder.path() / "drive.csv.gz", kWithReference,
                                        rows_of_a_drive(1000.0, 5));
  const Scored scored = replay_with_truth(path, {.model = sensor_model()});
  ASSERT_TRUE(scored.result.true_drives);
  const TrueDrives& drives = *scored.result.true_drives;
  EXPECT_EQ(name(drives.truth.vertical, 3), "-z");
  ASSERT_EQ(drives.scored(), 9U);
  const auto published = [](const app::AxisRate& axis) {
    return axis.corrected.in(core::rad_per_s);
  };
  for (std::size_t k = 0; k < 9; ++k) {
    // Stops last from a multiple of 100 s, or the row after it, to 40.0 s after it.
    const ScoredTrueDrive& drive = drives.drives[k];
    const std::size_t departure = 1000 * k + 400;
    const auto arrival = static_cast<std::size_t>(drive.drive.arrival_ns / 100'000'000);
    ASSERT_NEAR(static_cast<double>(arrival), 1000.0 * static_cast<double>(k + 1), 1.01);
    ASSERT_EQ(drive.drive.departure_ns, static_cast<std::int64_t>(departure) * 100'000'000);
    const double expected = 150.0 * kRadPerDeg - turned_by_hand(scored.messages, departure - 20,
                                                                arrival + 20, published);
    // Heading of single precision: 2e-5 deg at either end.
    EXPECT_NEAR(drive.outcomes[0].drift_rad, expected, 5e-5 * kRadPerDeg) << k;
    EXPECT_GT(drive.outcomes[0].sigma_rad, 0.0);
    EXPECT_GT(drive.along.size(), 60U);
    EXPECT_NEAR(drive.along.back().error_rad, expected, 5e-5 * kRadPerDeg);
    EXPECT_NEAR(drive.along.front().error_rad, 0.0, 0.01 * kRadPerDeg);
  }
}

// The departure is the first sample of a tick, and its prediction is complete with the last one.
TEST(DrivesAgainstAReference, AreScoredByTheBiasAtDepartureToo) {
  const zerorate::testing::ScratchFolder folder;
  const auto path = testing::write_rows(folder.path() / "drive.csv.gz", kWithReference,
                                        rows_of_a_drive(1000.0, 5));
  const Scored scored = replay_with_truth(path, {.model = sensor_model()});
  for (std::size_t k = 0; k < 9; ++k) {
    const std::size_t from = 1000 * k + 200;
    const auto bias = scored.messages[from + 204].axes[2].bias;
    const double expected =
        150.0 * kRadPerDeg -
        turned_by_hand(scored.messages, from, from + 1000, [&](const app::AxisRate& axis) {
          return (axis.measured - bias).in(core::rad_per_s);
        });
    const DriveOutcome& outcome = scored.result.true_drives->drives[k].at_departure[0];
    EXPECT_NEAR(outcome.drift_rad, expected, 5e-5 * kRadPerDeg) << k;
  }
}

TEST(DrivesAgainstAReference, DoNotSufferFromABiasThatDriftsAtRest) {
  const zerorate::testing::ScratchFolder folder;
  auto rows = rows_of_a_drive(1000.0, 5);
  // A dock: the first stop lasts 1000 s more, in which the bias falls by 1 deg/s.
  std::vector<recording::Row> dock = testing::rows_at_rest(10000, 0.1, 6);
  for (std::size_t k = 0; k < dock.size(); ++k) {
    dock[k].rate_rad_s[2] +=
        static_cast<float>(1e-4 * static_cast<double>(dock.size() - k) * kRadPerDeg);
    dock[k].ref_heading_rad = rows.front().ref_heading_rad;
    dock[k].ref_speed_m_s = 0.0F;
    dock[k].odometer_pulses = 0;
  }
  for (recording::Row& row : rows) row.time_ns += 1'000'000'000'000;
  rows.insert(rows.begin(), dock.begin(), dock.end());
  const auto path = testing::write_rows(folder.path() / "dock.csv.gz", kWithReference, rows);
  const TrueDrives drives = *replay_with_truth(path, {.model = sensor_model()}).result.true_drives;
  ASSERT_EQ(drives.drives.front().flaw, truth::Flaw::none);
  const ScoredTrueDrive& first = drives.drives.front();
  EXPECT_LT(std::abs(first.outcomes[0].drift_rad), 4.0 * kRadPerDeg);
  EXPECT_GT(std::abs(first.at_departure[0].drift_rad), 50.0 * kRadPerDeg);
}

TEST(DrivesAgainstAReference, HaveTheFiguresOfTheirErrors) {
  const zerorate::testing::ScratchFolder folder;
  const auto path = testing::write_rows(folder.path() / "drive.csv.gz", kWithReference,
                                        rows_of_a_drive(1000.0, 6));
  const TrueDrives drives = *replay_with_truth(path, {.model = sensor_model()}).result.true_drives;
  const TrueScore score = drives.score(app::Predictor::kalman);
  double squares = 0.0;
  double worst = 0.0;
  std::size_t below_median = 0;
  for (const ScoredTrueDrive& scored : drives.drives) {
    const double error = scored.outcomes[0].drift_rad;
    squares += error * error / 9.0;
    worst = std::max(worst, std::abs(error));
    below_median += std::abs(error) < score.median_rad ? 1U : 0U;
  }
  EXPECT_NEAR(score.rms_rad, std::sqrt(squares), 1e-12);
  EXPECT_EQ(score.worst_rad, worst);
  EXPECT_EQ(below_median, 4U);
}

TEST(DrivesAgainstAReference, LieInsideTheIntervalAsOftenAsItSays) {
  const zerorate::testing::ScratchFolder folder;
  std::size_t covered = 0;
  std::size_t drives = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto path = testing::write_rows(folder.path() / "drive.csv", kWithReference,
                                          rows_of_a_drive(1500.0, seed));
    const auto scored = replay_with_truth(path, {.model = sensor_model()});
    const TrueScore score = scored.result.true_drives->score(app::Predictor::kalman);
    drives += score.drives;
    covered += static_cast<std::size_t>(
        std::lround(score.coverage95_of_node * static_cast<double>(score.drives)));
  }
  ASSERT_EQ(drives, 12U * 14U);
  // 168 drives at 0.95: three standard deviations are 0.05. The interval is that of a drive as long
  // as from middle to middle, which is a little longer than need be: no upper limit.
  EXPECT_GE(static_cast<double>(covered) / static_cast<double>(drives), 0.90);
}

TEST(DrivesAgainstAReference, CountTheReferencesOwnError) {
  const zerorate::testing::ScratchFolder folder;
  auto rows = rows_of_a_drive(1000.0, 7);
  // A reference that errs by some degrees a drive: the node's interval knows nothing of it.
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].ref_heading_rad += static_cast<float>(
        3.0 * kRadPerDeg * std::sin(0.9 * std::floor(static_cast<double>(k + 300) / 1000.0)));
  }
  const auto path = testing::write_rows(folder.path() / "drive.csv.gz", kWithReference, rows);
  model::SensorModel exact = sensor_model();
  exact.scale_factor = model::ScaleFactor{.sigma = 1e-6};
  const auto score = [&](double error_deg) {
    const auto scored =
        replay_with_truth(path, {.model = exact}, {.reference_error_rad = error_deg * kRadPerDeg});
    return scored.result.true_drives->score(app::Predictor::kalman);
  };
  EXPECT_LT(score(0.0).coverage95, 0.5);
  EXPECT_EQ(score(3.0).coverage95, 1.0);
  EXPECT_EQ(score(3.0).coverage95_of_node, score(0.0).coverage95);
}

TEST(DrivesAgainstAReference, HaveTheToleranceOfTheScaleFactor) {
  const zerorate::testing::ScratchFolder folder;
  auto rows = rows_of_a_drive(1000.0, 9);
  for (recording::Row& row : rows) {
    row.rate_rad_s[2] += 0.03F * std::abs(row.ref_rate_rad_s);  // 3 % too much
  }
  const auto path = testing::write_rows(folder.path() / "drive.csv.gz", kWithReference, rows);
  const auto coverage = [&](double tolerance) {
    model::SensorModel model = sensor_model();
    model.scale_factor = model::ScaleFactor{.sigma = tolerance};
    const auto scored = replay_with_truth(path, {.model = model});
    return scored.result.true_drives->score(app::Predictor::kalman).coverage95_of_node;
  };
  EXPECT_EQ(coverage(0.03), 1.0);
  EXPECT_EQ(coverage(1e-6), 0.0);
}

TEST(DrivesOutsideTheirIntervals, NameTheDiagnosis) {
  const zerorate::testing::ScratchFolder folder;
  const auto drives_with = [&](double shift_dps) {
    auto rows = rows_of_a_drive(1000.0, 10);
    for (recording::Row& row : rows) {
      if (row.ref_speed_m_s > 0.0F) {
        row.rate_rad_s[2] += static_cast<float>(shift_dps * kRadPerDeg);
      }
    }
    const auto path = testing::write_rows(folder.path() / "drive.csv.gz", kWithReference, rows);
    return *replay_with_truth(path, {.model = sensor_model()}).result.true_drives;
  };
  EXPECT_EQ(doubt_of_coverage(drives_with(0.0)), "");
  const TrueDrives shifted = drives_with(0.5);
  EXPECT_NE(doubt_of_coverage(shifted).find("9 of 9 drives lie outside"), std::string::npos);
  EXPECT_NE(summary(shifted, 3).find("zerorate diagnose"), std::string::npos);
}

TEST(DrivesAgainstAReference, AreNotScoredWithoutABiasOrAcrossAGap) {
  const zerorate::testing::ScratchFolder folder;
  auto rows = rows_of_a_drive(600.0, 8);
  for (std::size_t k = 0; k < 450; ++k) rows[k].odometer_pulses = static_cast<std::int64_t>(k);
  for (std::size_t k = 450; k < rows.size(); ++k) rows[k].odometer_pulses += 450;
  rows.erase(rows.begin() + 2700, rows.begin() + 2730);
  const auto path = testing::write_rows(folder.path() / "drive.csv", kWithReference, rows);
  const TrueDrives drives = *replay_with_truth(path, {.model = sensor_model()}).result.true_drives;
  ASSERT_EQ(drives.drives.size(), 5U);
  EXPECT_EQ(drives.drives[0].flaw, truth::Flaw::no_bias)
      << "the odometer never reported standstill";
  EXPECT_EQ(drives.drives[1].flaw, truth::Flaw::none);
  EXPECT_TRUE(drives.drives[2].flaw == truth::Flaw::heading_missing ||
              drives.drives[2].flaw == truth::Flaw::rate_missing)
      << name(drives.drives[2].flaw);
  EXPECT_EQ(drives.scored(), 3U);
}

TEST(ReplayWithAReference, TellsItInJsonAndReport) {
  const zerorate::testing::ScratchFolder folder;
  const auto path =
      testing::write_rows(folder.path() / "drive.csv", kWithReference, rows_of_a_drive(500.0, 9));
  recording::Reader reference{path};
  ReplayTrace trace{2};
  const ReplayObserver observer{
      .truth = truth::find_truth(truth::read_track(reference), {}),
      .on_sample = [&](const ReplayedSample& sample) { trace.add(sample); }};
  recording::Reader reader{path};
  const ReplayResult result = replay(reader, {.model = sensor_model()}, observer);
  trace.finish();
  const auto json = nlohmann::json::parse(to_json(result, {2}));
  const auto& drives = json.at("true_drives");
  EXPECT_EQ(drives.at("scored"), 4);
  EXPECT_EQ(drives.at("stops").size(), 5U);
  EXPECT_EQ(drives.at("drives").size(), 4U);
  EXPECT_EQ(drives.at("vertical_axis"), "-z");
  EXPECT_TRUE(drives.at("drives")[0].at("flaw").is_null());
  const auto& kalman = drives.at("predictors").at("kalman");
  EXPECT_TRUE(kalman.at("bias_at_departure").at("heading_error_rms_deg").is_number());
  const auto& axis = json.at("axes").at("z").at("predictors").at("kalman");
  for (const char* figure : {"heading_drift_rms_deg", "coverage95", "ie_deg"}) {
    EXPECT_TRUE(axis.at(figure).is_null()) << "the true rate is not known: " << figure;
  }

  // Stops of 40 s by odometer: learnt from but for the settle time and the hold-back at the end.
  ASSERT_EQ(trace.learnt().size(), 5U);
  for (const auto& ticks : trace.learnt()) {
    EXPECT_NEAR(0.5 * (ticks.to - ticks.from), 38.5, 1.01);
  }
  const report::Chart chart = stop_chart(trace, *result.true_drives, 0.5);
  ASSERT_EQ(chart.series.size(), 4U);
  EXPECT_EQ(chart.series[0].x.size(), 3U * 5U);
  report::Report report{"Title", "Lead."};
  add_true_drives(report, *result.true_drives, trace, result);
  EXPECT_NE(report.html().find("Against the reference"), std::string::npos);
}

TEST(ReportWithAReferenceRate, DrawsTheTrueBiasAndTheLastStop) {
  const zerorate::testing::ScratchFolder folder;
  const auto path =
      testing::write_rows(folder.path() / "drive.csv", kWithReference, rows_of_a_drive(500.0, 9));
  recording::Reader reference{path};
  ReplayTrace trace{2};
  const ReplayObserver observer{
      .truth = truth::find_truth(truth::read_track(reference), {}),
      .on_sample = [&](const ReplayedSample& sample) { trace.add(sample); }};
  recording::Reader reader{path};
  const model::SensorModel model = sensor_model();
  const ReplayResult result = replay(reader, {.model = model}, observer);
  trace.finish();
  // Without the turns of 5 deg/s, bias and noise are left.
  ASSERT_FALSE(trace.points().empty());
  for (const TracePoint& point : trace.points()) EXPECT_NEAR(point.error_dps, 0.0, 2.0);
  const std::string html = make_report(result, {2}, trace, {}, model, {.title = "Title"}).html();
  EXPECT_NE(html.find("true bias (60 s means)"), std::string::npos);
  EXPECT_NE(html.find("mean of the last stop"), std::string::npos);
}

TEST(RingLaserGyroInACar, IsScoredAsByHand) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) GTEST_SKIP() << "no recordings";
  const auto path = *folder / "vehicle_drives/kingston2008_10hz.csv.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no recordings of drives";
  for (const char* model : {"adis16405", "lsm6dso", "bmi088"}) {
    // Until the end of its first drive the reference aligns itself.
    const auto scored =
        replay_with_truth(path, {.model = model::find_model(model)}, {.usable_from_s = 600.0});
    const TrueScore score = scored.result.true_drives->score(app::Predictor::kalman);
    EXPECT_EQ(score.drives, 19U);
    EXPECT_LT(score.rms_rad / kRadPerDeg, 0.21) << model;
    EXPECT_LT(score.median_rad / kRadPerDeg, 0.10) << model;
  }
}

TEST(RingLaserGyroInACar, IsNotMadeWorseByHeadingsAtStops) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) GTEST_SKIP() << "no recordings";
  const auto path = *folder / "vehicle_drives/kingston2008_10hz.csv.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no recordings of drives";
  for (const char* model : {"adis16405", "lsm6dso"}) {
    ReplayOptions options{.model = model::find_model(model)};
    const TrueScore without =
        replay_with_truth(path, options, {}).result.true_drives->score(app::Predictor::kalman);
    options.references = ReferenceUse{.only_at_stops = true,
                                      .vertical = {.axis = 2, .sign = -1.0},
                                      .sigma_rad = 0.03 * kRadPerDeg};
    const auto taught = replay_with_truth(path, options, {});
    const TrueScore with = taught.result.true_drives->score(app::Predictor::kalman);
    // Headings of the first two drives, in which the reference aligned itself, teach a little
    // wrong.
    EXPECT_LE(with.rms_rad, 1.1 * without.rms_rad) << model;
    EXPECT_GE(with.coverage95, 0.89) << model;
    EXPECT_LT(std::abs(taught.result.learnt_motion->scale_factor), 0.003) << model;
  }
}

}  // namespace
}  // namespace zerorate::evaluate
