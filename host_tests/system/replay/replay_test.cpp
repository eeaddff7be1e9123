#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "firmware/model/catalogue.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tests/support/made_recording.hpp"
#include "host_tools/lib/evaluate/replay.hpp"

namespace zerorate::evaluate {
namespace {

using testing::kRates;
using testing::replay_file;
using testing::Replayed;
using testing::rows_at_rest;
using testing::sensor_model;
using testing::write_rows;
using zerorate::testing::ScratchFolder;

constexpr ScheduleParams kShortDrives{.still_s = 20.0, .drive_s = 40.0, .seed = 3};
constexpr ScheduleParams kLongRest{.still_s = 400.0, .drive_s = 40.0, .seed = 3};
constexpr recording::Columns kOneRate{1, recording::RateUnit::rad_per_s, false, false, false};

struct ChipUnderTest {
  const char* chip;
  double lsb_dps;  ///< datasheet value at 250 deg/s, or at the only range
  recording::Columns columns;
  bool has_accelerometer = true;
};
constexpr std::array kChips{ChipUnderTest{"lsm6dso", 8.75e-3, kRates},
                            ChipUnderTest{"ism330dhcx", 8.75e-3, kRates},
                            ChipUnderTest{"asm330lhh", 8.75e-3, kRates},
                            ChipUnderTest{"lsm6dsv16x", 8.75e-3, kRates},
                            ChipUnderTest{"lsm6ds3tr-c", 8.75e-3, kRates},
                            ChipUnderTest{"icm20602", 1.0 / 131.072, kRates},
                            ChipUnderTest{"icm42688", 1.0 / 131.072, kRates},
                            ChipUnderTest{"icm45686", 1.0 / 131.072, kRates},
                            ChipUnderTest{"mpu6500", 1.0 / 131.072, kRates},
                            ChipUnderTest{"l3gd20h", 8.75e-3, kRates, false},
                            ChipUnderTest{"bmi160", 1.0 / 131.072, kRates},
                            ChipUnderTest{"bmi270", 1.0 / 131.072, kRates},
                            ChipUnderTest{"icm20948", 1.0 / 131.072, kRates},
                            ChipUnderTest{"bmi088", 1.0 / 131.072, kRates},
                            ChipUnderTest{"adis16475-1", 1.0 / 160.0, kRates},
                            ChipUnderTest{"adxrs453", 1.0 / 80.0, kOneRate, false}};

void expect_identical(const Replayed& a, const Replayed& b) {
  EXPECT_EQ(a.messages, b.messages);
  EXPECT_EQ(a.moving, b.moving);
  ASSERT_EQ(a.drives.size(), b.drives.size());
  for (std::size_t i = 0; i < a.drives.size(); ++i) {
    EXPECT_EQ(a.drives[i].outcome.drift_rad, b.drives[i].outcome.drift_rad);
    EXPECT_EQ(a.drives[i].outcome.sigma_rad, b.drives[i].outcome.sigma_rad);
    EXPECT_EQ(a.drives[i].outcome.rsse_rad_s, b.drives[i].outcome.rsse_rad_s);
  }
}

// Every measured rate is off by at most half an LSB, so a mean of them is, and so is any weighted
// mean with positive weights. The filter's weights may be negative, but little: twice the bound.
void expect_same_but_for_rounding(const Replayed& chip, const Replayed& source, double lsb_dps,
                                  app::Predictor published) {
  const double rounding = 1e-7;  // rounding of single precision at rates below 0.02 rad/s
  const double lsb_rad_s = lsb_dps * testing::kRadPerDeg;
  const double bias_bound = published == app::Predictor::kalman ? lsb_rad_s : 0.5 * lsb_rad_s;
  ASSERT_EQ(chip.messages.size(), source.messages.size());
  for (std::size_t k = 0; k < source.messages.size(); ++k) {
    ASSERT_EQ(chip.messages[k].time, source.messages[k].time);
    ASSERT_EQ(chip.messages[k].motion, source.messages[k].motion);
    ASSERT_EQ(chip.messages[k].health.calibrated, source.messages[k].health.calibrated);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& a = chip.messages[k].axes[axis];
      const auto& b = source.messages[k].axes[axis];
      ASSERT_NEAR(a.measured.in(core::rad_per_s), b.measured.in(core::rad_per_s),
                  0.5 * lsb_rad_s + rounding);
      ASSERT_NEAR(a.bias.in(core::rad_per_s), b.bias.in(core::rad_per_s), bias_bound + rounding);
    }
  }
}

TEST(ReplayThroughChipAndSource, AgreeToTheRoundingOfTheChip) {
  const ScratchFolder folder;
  const auto path = write_rows(folder.path() / "rest.csv", kRates, rows_at_rest(60'000, 0.01, 1));
  for (const auto published : kAllPredictors) {
    SCOPED_TRACE(std::string(name(published)));
    ReplayOptions options{
        .model = sensor_model(), .schedule = kShortDrives, .published = published};
    const Replayed source = replay_file(path, options);
    options.through = Through::chip;
    const Replayed chip = replay_file(path, options);
    EXPECT_EQ(chip.result.loop.samples, 60'000U);
    EXPECT_EQ(chip.result.loop.read_errors, 0U);
    expect_same_but_for_rounding(chip, source, kChips[0].lsb_dps, published);
  }
}

TEST(ReplayThroughEveryChip, AgreesToItsRounding) {
  const ScratchFolder folder;
  for (const ChipUnderTest& under_test : kChips) {
    SCOPED_TRACE(under_test.chip);
    const auto path =
        write_rows(folder.path() / "rest.csv", under_test.columns, rows_at_rest(12'000, 0.01, 1));
    ReplayOptions options{.model = sensor_model(), .schedule = kShortDrives};
    const Replayed source = replay_file(path, options);
    options.through = Through::chip;
    options.chip = under_test.chip;
    const Replayed chip = replay_file(path, options);
    EXPECT_EQ(chip.result.loop.samples, 12'000U);
    EXPECT_EQ(chip.result.loop.read_errors, 0U);
    EXPECT_EQ(chip.result.loop.starts, 1U);
    expect_same_but_for_rounding(chip, source, under_test.lsb_dps, options.published);
  }
}

TEST(ReplayThroughEveryChip, GivesItTheAcceleration) {
  const ScratchFolder folder;
  constexpr std::size_t kLost = 1500;
  auto rows = rows_at_rest(3000, 0.01, 1);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double tilt = 1e-3 * static_cast<double>(k);
    rows[k].acceleration_m_s2 = {static_cast<float>(9.8 * std::sin(tilt)), -0.5F,
                                 static_cast<float>(9.8 * std::cos(tilt))};
  }
  rows[kLost].acceleration_m_s2 = recording::kNoAcceleration;
  for (const ChipUnderTest& under_test : kChips) {
    SCOPED_TRACE(under_test.chip);
    recording::Columns columns = under_test.columns;
    columns.acceleration = true;
    const auto path = write_rows(folder.path() / "tilting.csv", columns, rows);
    const Replayed chip = replay_file(path, {.model = sensor_model(),
                                             .schedule = kShortDrives,
                                             .through = Through::chip,
                                             .chip = under_test.chip});
    EXPECT_EQ(chip.result.loop.read_errors, 0U);
    ASSERT_EQ(chip.messages.size(), rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto& measured = chip.messages[k].acceleration;
      ASSERT_EQ(measured.has_value(), under_test.has_accelerometer && k != kLost) << k;
      for (std::size_t axis = 0; axis < 3 && measured; ++axis) {
        // Half of the coarsest LSB, a quarter of a mg of the ADIS16475, and single precision.
        ASSERT_NEAR(measured->at(axis).in(core::m_per_s2), rows[k].acceleration_m_s2[axis],
                    0.5 * 9.80665 * 0.25e-3 + 1e-6);
      }
    }
  }
}

TEST(ReplayThroughAChipOfOneAxis, RefusesThreeAxes) {
  const ScratchFolder folder;
  const auto path = write_rows(folder.path() / "rest.csv", kRates, rows_at_rest(100, 0.01, 1));
  EXPECT_THROW((void)replay_file(
                   path, {.model = sensor_model(), .through = Through::chip, .chip = "adxrs453"}),
               std::invalid_argument);
}

TEST(ReplayOfTheSameRecording, IsTheSameTwiceAndPackedOrNot) {
  const ScratchFolder folder;
  const auto rows = rows_at_rest(20'000, 0.01, 2);
  const auto plain = write_rows(folder.path() / "rest.csv", kRates, rows);
  const auto packed = write_rows(folder.path() / "rest.csv.gz", kRates, rows);
  for (const Through through : {Through::source, Through::chip}) {
    const ReplayOptions options{
        .model = sensor_model(), .schedule = kShortDrives, .through = through};
    const Replayed first = replay_file(plain, options);
    EXPECT_FALSE(first.drives.empty());
    expect_identical(first, replay_file(plain, options));
    expect_identical(first, replay_file(packed, options));
  }
}

// Half of the recording is frozen: 19 s of the noise of this sensor show that in a second.
TEST(ReplayOfAFrozenAxis, GivesNoRateAndLearnsNothing) {
  const ScratchFolder folder;
  auto rows = rows_at_rest(4'000, 0.01, 2);
  const auto frozen = rows.begin() + 2'000;
  for (auto row = frozen; row != rows.end(); ++row) {
    row->rate_rad_s[2] = (frozen - 1)->rate_rad_s[2] + 0.01F;
  }
  const Replayed played = replay_file(write_rows(folder.path() / "frozen.csv", kRates, rows),
                                      {.model = sensor_model(), .schedule = kShortDrives});
  EXPECT_GE(played.result.samples_frozen, 1'850U);
  EXPECT_NEAR(played.result.first_frozen_s, 21.0, 0.5);
  EXPECT_EQ(played.result.samples_refused, 0U);
  const app::RateMessage& last = played.messages.back();
  EXPECT_TRUE(last.health.sensor_fault);
  EXPECT_FALSE(last.has_rate());
  EXPECT_NEAR(last.axes[2].bias.in(core::deg_per_s), 0.1F, 0.05F);
}

// Zeros since the first row show neither noise nor the size of a step.
TEST(ReplayOfAGyroThatIsDeadAtFirst, LearnsNothingFromItsZeros) {
  const ScratchFolder folder;
  auto rows = rows_at_rest(4'000, 0.01, 2);
  for (std::size_t k = 0; k < 1'500; ++k) rows[k].rate_rad_s = {};
  const Replayed played = replay_file(write_rows(folder.path() / "dead.csv", kRates, rows),
                                      {.model = sensor_model(), .schedule = kShortDrives});
  EXPECT_EQ(played.result.samples_frozen, 1'399U) << "all but those of the first second";
  EXPECT_FALSE(played.messages[1'400].has_rate());
  EXPECT_NEAR(played.messages.back().axes[2].bias.in(core::deg_per_s), 0.1F, 0.05F);
}

// The stronger proof that nothing of a drive is learnt from: a turn of any size, known as the
// truth, leaves every prediction as it was.
TEST(ReplayOfATurningVehicle, PredictsAsIfItHadDrivenStraight) {
  const ScratchFolder folder;
  auto rows = rows_at_rest(40'000, 0.05, 3);
  const ReplayOptions options{.model = sensor_model(), .schedule = kShortDrives};
  const Replayed straight =
      replay_file(write_rows(folder.path() / "straight.csv", kRates, rows), options);
  constexpr float kTurn = 0.5F;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (straight.moving[k] != 0) rows[k].rate_rad_s[2] += kTurn;
  }
  const Replayed turning = replay_file(
      write_rows(folder.path() / "turning.csv", kRates, rows), options, [&](std::uint64_t row) {
        return std::array{0.0F, 0.0F, straight.moving[row] != 0 ? kTurn : 0.0F};
      });
  ASSERT_EQ(turning.messages.size(), straight.messages.size());
  for (std::size_t k = 0; k < turning.messages.size(); ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(turning.messages[k].axes[axis].bias, straight.messages[k].axes[axis].bias) << k;
      ASSERT_EQ(turning.messages[k].axes[axis].sigma, straight.messages[k].axes[axis].sigma) << k;
    }
  }
}

TEST(ReplayOfAGoodRecordingWithBadRows, LeavesThoseOutAndGoesOn) {
  const ScratchFolder folder;
  auto rows = rows_at_rest(3000, 0.05, 4);
  rows[500].rate_rad_s[1] = std::numeric_limits<float>::quiet_NaN();
  rows[700].time_ns = rows[699].time_ns;
  rows[900].time_ns = rows[899].time_ns - 1'000'000'000;
  const auto path = write_rows(folder.path() / "bad.csv", kRates, rows);
  const Replayed replayed = replay_file(path, {.model = sensor_model(), .schedule = kShortDrives});
  const recording::Findings& findings = replayed.result.findings;
  EXPECT_EQ(replayed.result.rows, 2999U);
  EXPECT_EQ(replayed.result.samples_refused, 1U);
  EXPECT_EQ(findings.count(recording::Finding::rate_lost), 1U);
  EXPECT_EQ(findings.count(recording::Finding::time_stray), 1U);
  EXPECT_FALSE(replayed.messages[500].has_rate());
  EXPECT_TRUE(replayed.messages[900].has_rate());
  EXPECT_TRUE(replayed.messages.back().health.calibrated);
}

// At 100 Hz the settle time drops the output of a gyro while it powers up; at 1 Hz it is learnt
// from, and the node reports at once that this is not the sensor of the model.
TEST(ReplayOfTenWildFirstSamples, DropsThemOrReportsThem) {
  const ScratchFolder folder;
  for (const double period_s : {0.01, 1.0}) {
    SCOPED_TRACE(period_s);
    auto rows = rows_at_rest(4000, period_s, 8);
    const auto calm = write_rows(folder.path() / "calm.csv", kRates, rows);
    for (std::size_t k = 0; k < 10; ++k) rows[k].rate_rad_s[2] += k % 2 == 0 ? 0.2F : -0.1F;
    const auto wild = write_rows(folder.path() / "wild.csv", kRates, rows);
    const ReplayOptions options{.model = sensor_model(), .schedule = kLongRest};
    EXPECT_EQ(replay_file(calm, options).result.samples_inconsistent, 0U);
    const Replayed reported = replay_file(wild, options);
    if (period_s < 1.0) {
      EXPECT_EQ(reported.result.samples_inconsistent, 0U);
      EXPECT_EQ(reported.result.samples_disagreeing, 0U);
    } else {
      EXPECT_TRUE(reported.messages[4].health.odometer_disagreement);
      EXPECT_FALSE(reported.messages[30].health.odometer_disagreement);
    }
  }
}

// A moving row whose time runs backwards must not hand the odometer pulses out of order.
TEST(ReplayThroughTheChipOfTimeRunningBackwards, LeavesTheRowOut) {
  const ScratchFolder folder;
  recording::Columns columns = kRates;
  columns.odometer = true;
  for (const std::size_t bad : {std::size_t{900}, std::size_t{1500}}) {  // standing, moving
    auto rows = rows_at_rest(3000, 0.05, 5);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      rows[k].odometer_pulses = k < 1200 ? 0 : static_cast<std::int64_t>(k - 1200);
    }
    rows[bad].time_ns = rows[bad - 1].time_ns - 3'000'000'000;
    const auto path = write_rows(folder.path() / "back.csv", columns, rows);
    const Replayed replayed =
        replay_file(path, {.model = sensor_model(), .through = Through::chip});
    EXPECT_EQ(replayed.result.rows, 2999U);
    EXPECT_EQ(replayed.result.findings.count(recording::Finding::time_stray), 1U);
    EXPECT_TRUE(replayed.messages[bad].has_rate());
    EXPECT_TRUE(replayed.messages.back().has_rate());
  }
}

std::string message_of(const std::filesystem::path& path, const ReplayOptions& options) {
  try {
    (void)replay_file(path, options);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

TEST(ReplayThatCannotBe, SaysWhyAndWhatToDo) {
  const ScratchFolder folder;
  const auto path = write_rows(folder.path() / "rest.csv", kRates, rows_at_rest(100, 0.1, 6));
  const auto one = write_rows(folder.path() / "one.csv", kRates, rows_at_rest(1, 0.1, 6));
  const ReplayOptions options{.model = sensor_model(), .schedule = kShortDrives};

  using ::testing::HasSubstr;
  EXPECT_THAT(message_of(path, {.model = sensor_model()}), HasSubstr("--schedule"));
  EXPECT_THAT(message_of(one, options), HasSubstr("fewer than two rows"));
  auto too_fast = options;
  too_fast.filter_rate_hz = 50.0;
  EXPECT_THAT(message_of(path, too_fast), HasSubstr("sample rate of 10"));
  for (const double rate_hz : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity()}) {
    auto impossible = options;
    impossible.filter_rate_hz = rate_hz;
    EXPECT_THAT(message_of(path, impossible), HasSubstr("must be positive")) << rate_hz;
  }
  auto long_hold_back = options;
  long_hold_back.filter_rate_hz = 10.0;
  long_hold_back.standstill.hold_back = core::Duration::seconds(10);
  EXPECT_THAT(message_of(path, long_hold_back), HasSubstr("hold-back is longer"));
}

TEST(ParseSchedule, TakesWhatIsGivenAndNamesWhatIsWrong) {
  const ScheduleParams given = parse_schedule("still=30,drive=120.5,seed=9");
  EXPECT_EQ(given.still_s, 30.0);
  EXPECT_EQ(given.drive_s, 120.5);
  EXPECT_EQ(given.seed, 9U);
  EXPECT_EQ(parse_schedule("drive=5").still_s, ScheduleParams{}.still_s);
  for (const char* wrong : {"still", "still=", "still=x", "still=0", "still=-1", "still=nan",
                            "seed=1.5", "seed=-1", "pause=3", "still=3 s"}) {
    EXPECT_THROW((void)parse_schedule(wrong), std::invalid_argument) << wrong;
  }
}

/// Geometric mean over runs, axes and eight schedules of kalman / calibration_mean heading drift.
double mean_ratio(const std::filesystem::path& folder, double still_s, double drive_s) {
  const ReplayOptions base{.model = model::find_model("adis16405")};
  double sum_of_logs = 0.0;
  int count = 0;
  for (int run = 1; run <= 3; ++run) {
    const auto file =
        folder / "adis16405_static" / ("run" + std::to_string(run) + "_1hz_mean_with_accel.csv.gz");
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      ReplayOptions options = base;
      options.schedule = ScheduleParams{.still_s = still_s, .drive_s = drive_s, .seed = seed};
      recording::Reader reader{file};
      const ReplayResult result = replay(reader, options);
      for (const auto& axis : result.scores) {
        sum_of_logs += std::log(axis[0].heading_drift_rms_rad() / axis[2].heading_drift_rms_rad());
        ++count;
      }
    }
  }
  return std::exp(sum_of_logs / count);
}

// The catalogue's model is from the data sheet: nothing is fitted to these recordings.
TEST(KalmanOnRealAdis16405, DriftsThreeQuartersOfTheMean) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) {
    GTEST_SKIP() << "skipped: no recordings";
  }
  EXPECT_LE(mean_ratio(*folder, 15.0, 60.0), 0.75);
  EXPECT_LE(mean_ratio(*folder, 30.0, 120.0), 0.75);
}

}  // namespace
}  // namespace zerorate::evaluate
