// Lessons of references of the heading: turn of sensors with an error of the scale factor, an
// offset of the bias in motion and references of several kinds, beside that of a perfect sensor.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "host_tests/evidence/drives/turning_vehicle.hpp"

namespace zerorate::drives {
namespace {

/// Error of the sensor that rest does not show.
struct Sensor {
  double tolerance = 0.01;
  double scale_error = 0.0;
  double tilt_deg = 0.0;                    ///< angle between the axis and the vertical
  double asymmetry = 0.0;                   ///< half the difference between both senses
  double offset_dps = 0.0;                  ///< offset of the bias in motion
  double between_drives_dps = 0.0;          ///< deviation of the bias in motion from drive to drive
  int hypotheses = model::kMostHypotheses;  ///< number of noises; 1: that of the model
};

/// A source of references, and what is wrong with it.
struct Source {
  bool at_stops = false;   ///< one a stop, 5 s after its begin
  bool by_course = false;  ///< one a second in motion
  double sigma_deg = 0.1;
  double stated = 1.0;  ///< stated deviation over the true one
  double sense = 1.0;
  double delay_s = 0.0;    ///< not told
  double jump_deg = 0.0;   ///< from the middle of each fifth drive on
  bool is_frozen = false;  ///< from the fifth drive on
};

struct Ending {
  double error_deg;
  double sigma_deg;
  bool is_usable;
};

struct Outcome {
  std::vector<Ending> endings;
  double scale_factor = 0.0;
  double worst_while_usable = 0.0;  ///< error over its deviation, of a sample
};

class Drive {
 public:
  Drive(const Sensor& sensor, const Source& source, std::size_t drives, std::uint64_t seed)
      : sensor_(sensor),
        source_(source),
        samples_(samples_of(drives)),
        params_(turning_params(sensor.tolerance, sensor.hypotheses, sensor.tilt_deg * kRadPerDeg)),
        node_(params_),
        noise_(rest_noise_rad_s(samples_, kPeriod_s, random::RandomStream{seed, 0})),
        rate_dps_(corners_dps(samples_, random::RandomStream{seed, 1})),
        errors_(seed, 2),
        differences_(seed, 3) {}

  Outcome run() {
    Outcome outcome;
    for (std::size_t k = 0; k < samples_; ++k) {
      const app::RateMessage message = step(k);
      refer(k);
      const double error_deg = double{message.turn[0].angle.in(core::deg)} - turn_deg_;
      const double sigma_deg = double{message.turn[0].sigma.in(core::deg)};
      const bool is_under_way = k % (kStop + kDrive) > kStop + 40;
      if (is_under_way && message.health.is_usable() && std::isfinite(sigma_deg)) {
        outcome.worst_while_usable =
            std::max(outcome.worst_while_usable, std::abs(error_deg) / sigma_deg);
      }
      if (k + 1 < samples_ && is_driving(k) && !is_driving(k + 1)) {
        outcome.endings.push_back({error_deg, sigma_deg, message.health.is_usable()});
      }
    }
    outcome.scale_factor = double{node_.heading_filter().scale_factor()};
    return outcome;
  }

 private:
  app::RateMessage step(std::size_t k) {
    if (is_driving(k)) {
      if (k > 0 && !is_driving(k - 1)) turn_deg_ = 0.0;
      node_.pulse(time_of(k));
    }
    core::GyroSample sample{.time = time_of(k)};
    const double offset_dps = is_driving(k) ? offset_of_drive_dps(k / (kStop + kDrive)) : 0.0;
    const double of_sense = std::copysign(sensor_.asymmetry, rate_dps_[k]);
    const double scale =
        (1.0 + sensor_.scale_error + of_sense) * std::cos(sensor_.tilt_deg * kRadPerDeg);
    sample.rate[0] = core::rad_per_s(
        static_cast<float>(noise_[k] + (scale * rate_dps_[k] + offset_dps) * kRadPerDeg));
    const double since_last_deg = 0.5 * kPeriod_s * (rate_dps_[k > 0 ? k - 1 : 0] + rate_dps_[k]);
    turn_deg_ += since_last_deg;
    heading_deg_ += since_last_deg;
    track_deg_.push_back(heading_deg_);
    return node_.step(sample);
  }
  [[nodiscard]] double offset_of_drive_dps(std::size_t drive) const {
    return sensor_.offset_dps +
           sensor_.between_drives_dps * differences_.normal(static_cast<std::int64_t>(drive));
  }
  void refer(std::size_t k) {
    const std::size_t in_cycle = k % (kStop + kDrive);
    const bool is_due = (source_.at_stops && in_cycle == 100) ||
                        (source_.by_course && is_driving(k) && k % 20 == 0);
    if (!is_due) return;
    const auto late = static_cast<std::size_t>(source_.delay_s / kPeriod_s);
    double heading_deg = track_deg_[k >= late ? k - late : 0];
    const std::size_t drive = k / (kStop + kDrive);
    if (source_.is_frozen && drive >= 5) heading_deg = 77.0;
    if (drive % 5 == 4 && in_cycle > kStop + kDrive / 2) heading_deg += source_.jump_deg;
    heading_deg = source_.sense * heading_deg +
                  source_.sigma_deg * errors_.normal(static_cast<std::int64_t>(k));
    (void)node_.take_reference(app::HeadingReference{
        .time = time_of(k),
        .heading = core::deg(static_cast<float>(std::remainder(heading_deg, 360.0))),
        .sigma = core::deg(static_cast<float>(source_.stated * source_.sigma_deg))});
  }

  Sensor sensor_;
  Source source_;
  std::size_t samples_;
  TurningNode::Params params_;
  TurningNode node_;
  std::vector<double> noise_;
  std::vector<double> rate_dps_;
  random::RandomStream errors_;
  random::RandomStream differences_;
  std::vector<double> track_deg_;
  double heading_deg_ = 0.0;
  double turn_deg_ = 0.0;
};

struct Row {
  double rms_deg = 0.0;
  double coverage = 0.0;
  double mean_sigma_deg = 0.0;
  double scale_rms = 0.0;
  double worst = 0.0;
};

constexpr std::size_t kLearning = 10;  ///< drives before those that are scored
constexpr std::size_t kScored = 5;
constexpr std::size_t kSensors = 40;

Row row(Sensor sensor, const Source& source, double scale_of_tolerance) {
  Row found;
  double count = 0.0;
  for (std::size_t i = 0; i < kSensors; ++i) {
    const random::RandomStream draw{7, i};
    sensor.scale_error = scale_of_tolerance * sensor.tolerance * draw.normal(0);
    const Outcome outcome = Drive{sensor, source, kLearning + kScored, 1000 + i}.run();
    for (std::size_t k = kLearning; k < outcome.endings.size(); ++k) {
      const Ending& end = outcome.endings[k];
      found.rms_deg += end.error_deg * end.error_deg;
      found.coverage += std::abs(end.error_deg) < 1.96 * end.sigma_deg ? 1.0 : 0.0;
      found.mean_sigma_deg += end.sigma_deg;
      count += 1.0;
    }
    found.scale_rms += std::pow(outcome.scale_factor - sensor.scale_error, 2.0);
    found.worst = std::max(found.worst, outcome.worst_while_usable);
  }
  return {std::sqrt(found.rms_deg / count), found.coverage / count, found.mean_sigma_deg / count,
          std::sqrt(found.scale_rms / static_cast<double>(kSensors)), found.worst};
}

Row printed(const std::string& name, const Row& found) {
  std::printf("%-34s rms %.3f deg, coverage %.3f, sigma %.3f deg, scale %.5f, worst %.2f\n",
              name.c_str(), found.rms_deg, found.coverage, found.mean_sigma_deg, found.scale_rms,
              found.worst);
  return found;
}

/// Sensors without any error that rest does not show.
const Row& perfect() {
  static const Row kRow = printed("perfect", row({.tolerance = 1e-5}, {}, 0.0));
  return kRow;
}

constexpr Source kStops{.at_stops = true};
constexpr Source kCourse{.by_course = true, .sigma_deg = 0.7};
/// Standard error of a ratio of two rms of 200 drives that share their noise, by bootstrap.
constexpr double kRatioError = 0.03;
constexpr double kCoverageError = 0.018;  ///< standard error over 200 drives of 40 sensors

class ToleranceLearnt : public ::testing::TestWithParam<double> {};

TEST_P(ToleranceLearnt, FromStopsIsNearlyThatOfAPerfectSensor) {
  const Row found = printed("stops", row({.tolerance = GetParam(), .tilt_deg = 5.0}, kStops, 1.0));
  EXPECT_LE(found.rms_deg, (1.15 + 2.0 * kRatioError) * perfect().rms_deg);
  EXPECT_GE(found.coverage, 0.92 - 2.0 * kCoverageError);
  EXPECT_LT(found.worst, 5.0);
}

TEST_P(ToleranceLearnt, FromACourseIsNearlyThatOfAPerfectSensor) {
  const Row found =
      printed("course", row({.tolerance = GetParam(), .tilt_deg = 5.0}, kCourse, 1.0));
  EXPECT_LE(found.rms_deg, (1.3 + 2.0 * kRatioError) * perfect().rms_deg);
  EXPECT_GE(found.coverage, 0.92 - 2.0 * kCoverageError);
  EXPECT_LT(found.worst, 5.0);
}
INSTANTIATE_TEST_SUITE_P(Of, ToleranceLearnt, ::testing::Values(0.0, 0.005, 0.01, 0.03));

/// Bias in motion that another drive has not.
struct Differing {
  double between_drives_dps;
  double least_coverage;
};

class BiasOfDrives : public ::testing::TestWithParam<Differing> {};

TEST_P(BiasOfDrives, IsInTheInterval) {
  const auto [between_drives_dps, least_coverage] = GetParam();
  for (const Source& source : {kStops, kCourse}) {
    const Row found = printed(std::to_string(between_drives_dps) + " deg/s between drives",
                              row({.between_drives_dps = between_drives_dps}, source, 1.0));
    EXPECT_GE(found.coverage, least_coverage - 2.0 * kCoverageError);
  }
}
// Ten drives determine the variance between them to 45 %. At stops it is taken for noise of the
// references in part, so that fewer drives lie inside where the difference is largest.
INSTANTIATE_TEST_SUITE_P(Of, BiasOfDrives,
                         ::testing::Values(Differing{0.0025, 0.92}, Differing{0.005, 0.87}));

// The model's noise is that of the sensor here: what a node that learns its noise is not sure of
// is not in the interval.
TEST(ModelAtItsWord, HasANarrowerInterval) {
  const Row sure =
      printed("perfect, model right", row({.tolerance = 1e-5, .hypotheses = 1}, {}, 0.0));
  EXPECT_LT(sure.mean_sigma_deg, 0.9 * perfect().mean_sigma_deg);
  const Row found =
      printed("stops, model right", row({.tilt_deg = 5.0, .hypotheses = 1}, kStops, 1.0));
  EXPECT_GE(found.coverage, 0.92 - 2.0 * kCoverageError);
}

TEST(OffsetInMotion, IsLearntFromReferences) {
  for (const Source& source : {kStops, kCourse}) {
    const Row found = printed("offset in motion", row({.offset_dps = 0.015}, source, 1.0));
    EXPECT_LE(found.rms_deg, 2.5 * perfect().rms_deg);
    EXPECT_GE(found.coverage, 0.92 - 2.0 * kCoverageError);
  }
}

std::string asymmetry_name(double asymmetry) {
  return "asymmetry " + std::to_string(100.0 * asymmetry) + " %";
}

class AsymmetryThatIsNotStated : public ::testing::TestWithParam<double> {};

TEST_P(AsymmetryThatIsNotStated, LeavesATaughtIntervalThatHolds) {
  for (const Source& source : {kStops, kCourse}) {
    const Row found =
        printed(asymmetry_name(GetParam()), row({.asymmetry = GetParam()}, source, 1.0));
    EXPECT_GE(found.coverage, 0.92 - 2.0 * kCoverageError);
  }
}
INSTANTIATE_TEST_SUITE_P(Of, AsymmetryThatIsNotStated, ::testing::Values(0.0003, 0.001, 0.002));

// A chip whose owner held it for faulty had 0.03 %. With 0.2 % fewer lie inside, 0.85.
TEST(SmallAsymmetry, NeedsNoStatement) {
  for (const double asymmetry : {0.0, 0.0003}) {
    const Row found =
        printed(asymmetry_name(asymmetry) + ", alone", row({.asymmetry = asymmetry}, {}, 1.0));
    EXPECT_GE(found.coverage, 0.92 - 2.0 * kCoverageError);
    EXPECT_LT(found.worst, 5.0);
  }
}

struct Lie {
  std::string name;
  Source source;
};

class LyingReferences : public ::testing::TestWithParam<Lie> {};

TEST_P(LyingReferences, LeaveAnIntervalThatHolds) {
  const Row found = printed(GetParam().name, row({}, GetParam().source, 1.0));
  EXPECT_GE(found.coverage, 0.92 - 2.0 * kCoverageError);
  EXPECT_LT(found.worst, 5.0);
  EXPECT_LT(found.scale_rms, 0.02) << "twice the tolerance";
}

Source changed(Source source, double Source::*member, double value) {
  source.*member = value;
  return source;
}
Source frozen(Source source) {
  source.is_frozen = true;
  return source;
}
Source coarse_at_stops() {
  return {.at_stops = true, .sigma_deg = 1.0, .stated = 0.1};
}
INSTANTIATE_TEST_SUITE_P(
    Of, LyingReferences,
    ::testing::Values(Lie{"course jumps by 5 deg", changed(kCourse, &Source::jump_deg, 5.0)},
                      Lie{"course jumps by 180 deg", changed(kCourse, &Source::jump_deg, 180.0)},
                      Lie{"course jumps by 20 deg", changed(kCourse, &Source::jump_deg, 20.0)},
                      Lie{"course of the other sense", changed(kCourse, &Source::sense, -1.0)},
                      Lie{"course 2 s late", changed(kCourse, &Source::delay_s, 2.0)},
                      Lie{"course frozen", frozen(kCourse)},
                      Lie{"course states a tenth", changed(kCourse, &Source::stated, 0.1)},
                      Lie{"stops jump by 5 deg", changed(kStops, &Source::jump_deg, 5.0)},
                      Lie{"stops jump by 20 deg", changed(kStops, &Source::jump_deg, 20.0)},
                      Lie{"stops of the other sense", changed(kStops, &Source::sense, -1.0)},
                      Lie{"stops frozen", frozen(kStops)},
                      Lie{"stops state a tenth", coarse_at_stops()}));

}  // namespace
}  // namespace zerorate::drives
