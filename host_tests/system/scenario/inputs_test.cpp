// Inputs of the bias through the node: the specific force on a real sensor in 38 attitudes, and
// made drives over hills. The tables stand in docs/reference/scenarios.md.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/units.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/recording/byte_source.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::scenario {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kDps = std::numbers::pi / 180.0;
constexpr double kGravity = 9.80665;
constexpr core::Duration kHillPeriod = core::Duration::milliseconds(50);
constexpr double kHillPeriod_s = 0.05;
constexpr int kHillDrives = 30;
constexpr core::ModelShape kLeaning{
    .decaying = 6, .inputs = 3, .has_accelerometer = true, .hypotheses = 12};
using LeaningNode = app::GyroNode<kLeaning>;

/// A model of the catalogue whose bias follows the specific force by coefficients of about this
/// size; zero: it does not.
LeaningNode::Params params_of(std::string_view name, core::Duration period, double sigma_dps_g) {
  model::SensorModel sensor = model::find_model(name);
  sensor.scale_factor = model::ScaleFactor{.sigma = 0.0};  // known: the subject is the bias
  if (sigma_dps_g > 0.0) {
    sensor.inputs = {{.quantity = model::InputQuantity::acceleration,
                      .sigma_rad_s_per_unit = sigma_dps_g * kDps}};
  }
  return {.model =
              model::make_node_model<kLeaning>(sensor, period, core::Duration::milliseconds(500))};
}

core::GyroSample sample_of(core::Instant time, const Vector& rate_rad_s, const Vector& force_g) {
  core::GyroSample sample{.time = time, .has_acceleration = true};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    sample.rate[i] = core::rad_per_s(static_cast<float>(rate_rad_s(row)));
    sample.acceleration[i] = core::standard_gravity(static_cast<float>(force_g(row)));
  }
  return sample;
}

/// One row of the recording in many attitudes.
struct Row {
  double time_s = 0.0;
  Vector rate_rad_s;
  Vector counts;  ///< counts of the accelerometer
  bool is_still = false;
};

/// t_s, three rates, three counts of the gyro, three of the accelerometer, still.
std::vector<Row> read_attitudes(const std::filesystem::path& file) {
  recording::LineReader lines{file};
  std::vector<Row> rows;
  std::string_view line;
  (void)lines.next(line);  // the header
  while (lines.next(line)) {
    std::string text{line};
    std::ranges::replace(text, ',', ' ');
    std::istringstream fields{text};
    Row row;
    double gyro_counts = 0.0;
    fields >> row.time_s >> row.rate_rad_s(0) >> row.rate_rad_s(1) >> row.rate_rad_s(2);
    for (int i = 0; i < 3; ++i) fields >> gyro_counts;
    fields >> row.counts(0) >> row.counts(1) >> row.counts(2) >> row.is_still;
    rows.push_back(row);
  }
  return rows;
}

/// Rows of a standstill.
struct Stop {
  std::size_t begin = 0;
  std::size_t end = 0;
};
std::vector<Stop> stops_of(const std::vector<Row>& rows) {
  std::vector<Stop> stops;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!rows[k].is_still) continue;
    if (k == 0 || !rows[k - 1].is_still) stops.push_back({k, k});
    stops.back().end = k + 1;
  }
  constexpr std::size_t kShortest = 200;  // between two movements of the hand there is no attitude
  std::erase_if(stops, [](const Stop& stop) { return stop.end - stop.begin < kShortest; });
  return stops;
}
Vector mean_over(const std::vector<Row>& rows, const Stop& stop, Vector Row::*figure) {
  Vector sum = Vector::Zero();
  for (std::size_t k = stop.begin; k < stop.end; ++k) sum += rows[k].*figure;
  return sum / static_cast<double>(stop.end - stop.begin);
}

/// Offset and scale of each axis of an accelerometer by which all its means have the length of 1 g.
struct Sphere {
  Vector offset;
  Vector g_per_count;
};
Sphere fit_sphere(const std::vector<Vector>& means) {
  Vector centre = Vector::Zero();  // inside of the sphere
  for (const Vector& mean : means) centre += mean / static_cast<double>(means.size());
  Eigen::MatrixXd terms(static_cast<Eigen::Index>(means.size()), 6);
  for (std::size_t k = 0; k < means.size(); ++k) {
    const Vector x = (means[k] - centre) / 1000.0;
    terms.row(static_cast<Eigen::Index>(k)) << x.cwiseAbs2().transpose(), x.transpose();
  }
  // s_x^2 x^2 + ... - 2 s_x^2 o_x x - ... = 1 - sum of s^2 o^2, up to a factor.
  const Eigen::VectorXd p = terms.colPivHouseholderQr().solve(Eigen::VectorXd::Ones(terms.rows()));
  const Vector squares = p.head<3>();
  const Vector offset = -0.5 * p.tail<3>().cwiseQuotient(squares);
  const double length = 1.0 + squares.dot(offset.cwiseAbs2());
  return {offset * 1000.0 + centre, (squares / length).cwiseSqrt() / 1000.0};
}

/// Errors of the bias that is predicted for a stop before the stop is measured.
struct NextStop {
  std::array<double, 3> rms_dps{};  ///< error of the stops after the eighth
  double coverage = 0.0;            ///< share of all stops after the first, and of all axes
};
NextStop predict_next_stops(const std::vector<Row>& rows, double sigma_dps_g) {
  const std::vector<Stop> stops = stops_of(rows);
  std::vector<Vector> means;
  for (const Stop& stop : stops) means.push_back(mean_over(rows, stop, &Row::counts));
  const Sphere sphere = fit_sphere(means);
  const auto params = params_of("lsm6dso", core::Duration::milliseconds(10), sigma_dps_g);
  LeaningNode node{params};
  NextStop result;
  double covered = 0.0;
  std::size_t next = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto time = core::Instant::from_ns(std::llround(rows[k].time_s * 1e9));
    if (!rows[k].is_still) node.pulse(time);
    const Vector force_g = (rows[k].counts - sphere.offset).cwiseProduct(sphere.g_per_count);
    const app::RateMessage message = node.step(sample_of(time, rows[k].rate_rad_s, force_g));
    constexpr std::size_t kBeforeItIsMeasured = 140;  // samples of a stop
    if (next >= stops.size() || k != stops[next].begin + kBeforeItIsMeasured) continue;
    const Vector truth = mean_over(rows, stops[next], &Row::rate_rad_s);
    for (std::size_t i = 0; i < 3 && next > 0; ++i) {
      const double error =
          double{message.axes[i].bias.in(core::rad_per_s)} - truth(static_cast<Eigen::Index>(i));
      // The mean of the stop, which stands for the truth, has white noise of its own.
      const double length = static_cast<double>(stops[next].end - stops[next].begin);
      covered += std::abs(error) <
                 1.96 * std::hypot(double{message.axes[i].sigma.in(core::rad_per_s)},
                                   std::sqrt(double{node.white_variance_rad2_s2(i)} / length));
      if (next >= 8) result.rms_dps[i] += error * error / (kDps * kDps);
    }
    ++next;
  }
  EXPECT_EQ(next, stops.size());
  for (double& rms : result.rms_dps) rms = std::sqrt(rms / static_cast<double>(next - 8));
  result.coverage = covered / (3.0 * static_cast<double>(next - 1));
  return result;
}

/// A vehicle in hills: what it does, and what a gyro with a sensitivity to forces makes of it.
struct Hills {
  double grade = 0.0;              ///< largest rise of a road per distance
  double sensitivity_dps_g = 0.0;  ///< standard deviation of each coefficient of z
};
struct HillMoment {
  bool stands = false;
  double turn_dps = 0.0;
  Vector force_g;
};

/// Half a minute to a minute of rest, then three straights and two corners, 30 times.
std::vector<HillMoment> drive_over_hills(const Hills& hills, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform{-1.0, 1.0};
  std::normal_distribution<double> crossfall{0.0, 0.015};
  std::vector<HillMoment> moments;
  double speed_m_s = 0.0;
  /// Time with one change of speed, turn and grade.
  const auto go = [&](double length_s, double to_m_s, double turn_dps) {
    const double rise = hills.grade * uniform(random);
    const double roll = crossfall(random);
    const auto count = static_cast<int>(length_s / kHillPeriod_s);
    const double change_m_s = (to_m_s - speed_m_s) / count;
    for (int k = 0; k < count; ++k) {
      const double forward_m_s2 = change_m_s / kHillPeriod_s;
      const double sideways_m_s2 = speed_m_s * turn_dps * kDps;
      moments.push_back({to_m_s == 0.0 && speed_m_s == 0.0,
                         turn_dps,
                         {forward_m_s2 / kGravity + rise, sideways_m_s2 / kGravity + roll, 1.0}});
      speed_m_s += change_m_s;
    }
    speed_m_s = to_m_s;
  };
  for (int drive = 0; drive < kHillDrives; ++drive) {
    go(45.0 + 15.0 * uniform(random), 0.0, 0.0);
    for (int leg = 0; leg < 3; ++leg) {
      const double cruise_m_s = 10.0 + 4.0 * uniform(random);
      go(6.0, cruise_m_s, 0.0);
      go(8.0 + 4.0 * uniform(random), cruise_m_s, 0.0);
      go(5.0, leg < 2 ? 5.0 : 0.0, 0.0);
      if (leg < 2) go(4.0, 5.0, uniform(random) > 0.0 ? 22.5 : -22.5);
    }
  }
  go(10.0, 0.0, 0.0);
  return moments;
}

/// Errors of the heading about z at the ends of the drives after the tenth.
struct HillErrors {
  double squares_deg2 = 0.0;
  double covered = 0.0;
  double drives = 0.0;

  [[nodiscard]] double rms_deg() const { return std::sqrt(squares_deg2 / drives); }
  [[nodiscard]] double coverage() const { return covered / drives; }
};
void drive_node(const LeaningNode::Params& params, const Hills& hills, std::uint64_t seed,
                HillErrors& errors) {
  std::mt19937_64 roads{seed};
  std::mt19937_64 sensor{seed + 1000};
  std::normal_distribution<double> normal;
  const auto moments = drive_over_hills(hills, roads);
  const auto noise = simulate::simulate(
      simulate::Signal{moments.size(), kHillPeriod_s},
      {{simulate::WhiteNoise{.angle_random_walk_rad_rt_s = 0.00269 * kDps},
        simulate::FlickerNoise{.bias_instability_rad_s = 5.0 / 3600.0 * kDps / 0.664}}},
      random::RandomStream{seed});
  const Vector coefficients =
      hills.sensitivity_dps_g * kDps * Vector{normal(sensor), normal(sensor), normal(sensor)};
  LeaningNode node{params};
  double truth_deg = 0.0;
  int drive = 0;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    const HillMoment& now = moments[k];
    const auto time = core::Instant::from_ns(static_cast<std::int64_t>(k) * kHillPeriod.ns());
    if (!now.stands) node.pulse(time);
    truth_deg = now.stands ? truth_deg : truth_deg + now.turn_dps * kHillPeriod_s;
    const double rate_rad_s =
        now.turn_dps * kDps + noise.rate_rad_s[k] + coefficients.dot(now.force_g);
    const auto message = node.step(
        sample_of(time, Vector{noise.rate_rad_s[k], noise.rate_rad_s[k], rate_rad_s}, now.force_g));
    if (!now.stands || k == 0 || moments[k - 1].stands) continue;
    if (++drive > 10) {
      const double error_deg = double{message.turn[2].angle.in(core::deg)} - truth_deg;
      errors.squares_deg2 += error_deg * error_deg;
      errors.covered += std::abs(error_deg) < 1.96 * double{message.turn[2].sigma.in(core::deg)};
      ++errors.drives;
    }
    truth_deg = 0.0;
  }
}

TEST(NodeInHills, TakesTheForcesOff) {
  // Where 95 % are inside, fewer than 176 of 200 are so by chance once in 100,000 times.
  constexpr double kFewest = 0.88;
  for (const double grade : {0.0, 0.03, 0.08}) {
    double insensitive_deg = 0.0;
    for (const double sensitivity : {0.0, 0.05, 0.1}) {
      HillErrors with;
      HillErrors without;
      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Hills hills{grade, sensitivity};
        drive_node(params_of("lsm6dso", kHillPeriod, 0.1), hills, seed, with);
        drive_node(params_of("lsm6dso", kHillPeriod, 0.0), hills, seed, without);
      }
      if (sensitivity == 0.0) insensitive_deg = without.rms_deg();
      std::printf(
          "grade %.2f, %.2f deg/s/g: %.3f deg, %.3f inside; without inputs %.3f deg, %.3f inside\n",
          grade, sensitivity, with.rms_deg(), with.coverage(), without.rms_deg(),
          without.coverage());
      ASSERT_EQ(with.drives, 200.0);
      EXPECT_LE(with.rms_deg(), 1.2 * insensitive_deg);
      EXPECT_GE(with.coverage(), kFewest);
      EXPECT_LT(with.coverage(), 1.0);
    }
  }
}

TEST(NodeOfARealSensorInManyAttitudes, PredictsTheNextStop) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) GTEST_SKIP() << "skipped: no recordings";
  const auto rows = read_attitudes(*folder / "xsens_multiposition/xsens_mti_100hz.csv.gz");
  for (const double sigma : {0.0, 0.05, 0.1, 0.2}) {
    const NextStop next = predict_next_stops(rows, sigma);
    std::printf("%.2f deg/s/g: %.4f %.4f %.4f deg/s, %.3f inside\n", sigma, next.rms_dps[0],
                next.rms_dps[1], next.rms_dps[2], next.coverage);
    if (sigma == 0.0) continue;
    for (const double rms_dps : next.rms_dps) EXPECT_LT(rms_dps, 0.018);
    EXPECT_GE(next.coverage, 0.90);
    EXPECT_LE(next.coverage, 0.98);
  }
}

}  // namespace
}  // namespace zerorate::scenario
