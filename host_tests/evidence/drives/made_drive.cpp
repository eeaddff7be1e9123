#include "host_tests/evidence/drives/made_drive.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/recording/byte_source.hpp"

namespace zerorate::drives {
namespace {

constexpr double kPeriod_s = 0.1;
constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kPulse_m = 0.05;
constexpr double kScale = 1.003;  ///< scale of a good MEMS gyro without calibration

using Columns = std::map<std::string, std::vector<double>, std::less<>>;

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

Columns read_columns(const std::filesystem::path& file) {
  recording::LineReader reader{file};
  std::string_view line;
  if (!reader.next(line)) throw std::runtime_error(file.string() + ": empty");
  Columns columns;
  std::vector<std::vector<double>*> in_order;
  for (const std::string_view name : fields_of(line)) {
    in_order.push_back(&columns[std::string{name}]);
  }
  while (reader.next(line)) {
    const auto fields = fields_of(line);
    for (std::size_t i = 0; i < in_order.size(); ++i) {
      double value = 0.0;
      const std::string_view text = fields.at(i);
      (void)std::from_chars(text.data(), text.data() + text.size(), value);
      in_order[i]->push_back(value);
    }
  }
  return columns;
}

std::vector<Axes> rates_of(const Columns& columns, const std::array<std::string, 3>& names,
                           double factor) {
  std::vector<Axes> rates(columns.at(names[0]).size());
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double>& column = columns.at(names.at(i));
    for (std::size_t k = 0; k < rates.size(); ++k) rates[k].at(i) = column[k] * factor;
  }
  return rates;
}
const std::array<std::string, 3> kDps{"gx_dps", "gy_dps", "gz_dps"};
const std::array<std::string, 3> kRadps{"gx_radps", "gy_radps", "gz_radps"};

std::filesystem::path ring_laser_file(const std::filesystem::path& recordings) {
  return recordings / "vehicle_drives" / "kingston2008_10hz.csv.gz";
}

/// The rates of the ring-laser gyro without its own bias: the median at true rest.
Motion ring_laser_motion(const std::filesystem::path& recordings) {
  const Columns columns = read_columns(ring_laser_file(recordings));
  Motion motion{.name = "ring_laser",
                .speed_mps = columns.at("ref_speed_mps"),
                .odometer_pulses = columns.at("odometer_pulses"),
                .rate_dps = rates_of(columns, kDps, 1.0)};
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<double> at_rest;
    for (std::size_t k = 0; k < motion.rate_dps.size(); ++k) {
      if (motion.speed_mps[k] < 0.03) at_rest.push_back(motion.rate_dps[k].at(i));
    }
    const auto middle = at_rest.begin() + static_cast<std::ptrdiff_t>(at_rest.size() / 2);
    std::nth_element(at_rest.begin(), middle, at_rest.end());
    for (Axes& rate : motion.rate_dps) rate.at(i) -= *middle;
  }
  return motion;
}

/// Rotation for each metre, by distance [deg/m].
class Course {
 public:
  explicit Course(const Motion& motion) {
    double way_m = 0.0;
    for (std::size_t k = 0; k < motion.speed_mps.size(); ++k) {
      const double speed = motion.speed_mps[k];
      if (speed > 0.3) {
        const auto place = static_cast<std::size_t>(way_m / kStep_m);
        Axes curvature{};
        for (std::size_t i = 0; i < 3; ++i) curvature.at(i) = motion.rate_dps[k].at(i) / speed;
        curvatures_.resize(std::max(curvatures_.size(), place + 1), curvature);
        curvatures_[place] = curvature;
      }
      way_m += speed * motion.period_s;
    }
  }
  [[nodiscard]] const Axes& at(double way_m) const {
    return curvatures_[static_cast<std::size_t>(way_m / kStep_m) % curvatures_.size()];
  }

 private:
  static constexpr double kStep_m = 0.25;
  std::vector<Axes> curvatures_;
};

/// A recorded pair of speeds at 10 Hz; holes of the recording are closed.
Motion motion_with_speeds(const std::filesystem::path& file, const std::string& name,
                          const Course& course, double begin_m) {
  const Columns columns = read_columns(file);
  const auto& time = columns.at("t_s");
  const auto& reference = columns.at("ref_speed_mps");
  const auto& signal = columns.at("obd_speed_mps");
  Motion motion{.name = name};
  double way_m = begin_m;
  double counted_m = 0.0;
  for (std::size_t k = 0; k + 1 < time.size(); ++k) {
    const double interval_s = time[k + 1] - time[k] > 1.0 ? 0.2 : time[k + 1] - time[k];
    const auto steps = std::max(1L, std::lround(interval_s / kPeriod_s));
    for (long step = 0; step < steps; ++step) {
      const double share = static_cast<double>(step) / static_cast<double>(steps);
      double speed = reference[k] + share * (reference[k + 1] - reference[k]);
      if (speed < 0.02) speed = 0.0;
      Axes rate{};
      for (std::size_t i = 0; i < 3; ++i) rate.at(i) = course.at(way_m).at(i) * speed;
      way_m += speed * kPeriod_s;
      counted_m += signal[k] * kPeriod_s;
      motion.speed_mps.push_back(speed);
      motion.odometer_pulses.push_back(std::floor(counted_m / kPulse_m));
      motion.rate_dps.push_back(rate);
    }
  }
  return motion;
}

/// Turns the wheels where the vehicle rolls slowly, as far as was measured on the road: up to
/// 9 deg/s below 1.3 m/s.
void steer_while_rolling(Motion& motion, const random::RandomStream& random) {
  constexpr double kMost_dps = 9.0;
  std::int64_t number = 0;
  for (std::size_t begin = 0; begin < motion.speed_mps.size();) {
    const auto rolls = [&](std::size_t k) {
      return k < motion.speed_mps.size() && motion.speed_mps[k] > 0.12 && motion.speed_mps[k] < 1.3;
    };
    if (!rolls(begin)) {
      ++begin;
      continue;
    }
    const double factor = std::exp2(std::floor(4.0 * random.uniform(number)));
    const double dps_per_mps = 2.5 * random.normal(number + 1);
    number += 2;
    for (; rolls(begin); ++begin) {
      Axes& rate = motion.rate_dps[begin];
      for (double& one : rate) one = std::clamp(one * factor, -kMost_dps, kMost_dps);
      rate[2] = std::clamp(rate[2] + dps_per_mps * motion.speed_mps[begin], -kMost_dps, kMost_dps);
    }
  }
}

/// Means over the intervals of another period.
std::vector<Axes> resampled(const std::vector<Axes>& rates, double from_s, double to_s) {
  std::vector<Axes> means;
  Axes sum{};
  double count = 0.0;
  for (std::size_t k = 0; k < rates.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) sum.at(i) += rates[k].at(i);
    ++count;
    const double next_end = to_s * static_cast<double>(means.size() + 1);
    if (from_s * static_cast<double>(k + 1) > next_end - 0.5 * from_s) {
      for (double& one : sum) one /= count;
      means.push_back(sum);
      sum = {};
      count = 0.0;
    }
  }
  return means;
}

}  // namespace

std::vector<Motion> recorded_motions(const std::filesystem::path& recordings, std::uint64_t seed) {
  const random::RandomStream random{seed, 1};
  std::vector<Motion> motions{ring_laser_motion(recordings)};
  const Course course{motions[0]};
  const std::filesystem::path folder = recordings / "vehicle_drives";
  for (const std::string name : {"kingston_k19_1", "toronto_t19_2"}) {
    const double begin_m = 5000.0 * random.uniform(static_cast<std::int64_t>(motions.size()));
    motions.push_back(
        motion_with_speeds(folder / ("speeds_" + name + "_5hz.csv.gz"), name, course, begin_m));
  }
  for (std::size_t i = 0; i < motions.size(); ++i) {
    steer_while_rolling(motions[i], random.substream(i + 10));
  }
  return motions;
}

Drive ring_laser_drive(const std::filesystem::path& recordings) {
  const Columns columns = read_columns(ring_laser_file(recordings));
  Drive drive{.name = "ring_laser",
              .speed_mps = columns.at("ref_speed_mps"),
              .odometer_pulses = columns.at("odometer_pulses"),
              .measured_dps = rates_of(columns, kDps, 1.0)};
  // The compass counts clockwise, the gyro about an axis that points up the other way.
  double turns = 0.0;
  double previous = columns.at("ref_heading_deg").front();
  for (const double heading : columns.at("ref_heading_deg")) {
    turns -= std::remainder(heading - previous, 360.0);
    previous = heading;
    drive.heading_deg.push_back(turns);
  }
  return drive;
}

Rest adis16405_rest(const std::filesystem::path& recordings, int run, double scale) {
  const std::string name = "run" + std::to_string(run) + "_10hz_mean.csv.gz";
  return {.name = "adis16405 run " + std::to_string(run),
          .rate_dps = rates_of(read_columns(recordings / "adis16405_static" / name), kDps, scale)};
}

Rest thermal_sweep_rest(const std::filesystem::path& recordings) {
  const Columns columns = read_columns(recordings / "thermal_sweep" / "imu_thermal_2hz.csv.gz");
  std::vector<Axes> rates = rates_of(columns, kRadps, kDegPerRad);
  rates.erase(rates.begin());  // an outlier of the start
  Rest rest{.name = "thermal sweep", .period_s = 0.50563, .rate_dps = rates};
  constexpr std::ptrdiff_t kHalfMinute = 60;
  constexpr double kLeft = 0.01;
  const auto size = static_cast<std::ptrdiff_t>(rates.size());
  for (std::ptrdiff_t k = 0; k < size; ++k) {
    const auto begin = rates.begin() + std::max<std::ptrdiff_t>(0, k - kHalfMinute);
    const auto end = rates.begin() + std::min(size, k + kHalfMinute + 1);
    for (std::size_t i = 0; i < 3; ++i) {
      double sum = 0.0;
      for (auto one = begin; one != end; ++one) sum += one->at(i);
      const double slow = sum / static_cast<double>(end - begin);
      rest.rate_dps[static_cast<std::size_t>(k)].at(i) -= (1.0 - kLeft) * slow;
    }
  }
  return rest;
}

/// Specific force of a car: acceleration, curves, the vibration of the road and of the engine, and
/// the noise of a consumer accelerometer. x points forward, y to the left, z up.
std::vector<Axes> forces_g(const Drive& drive, const std::vector<Axes>& truth_dps,
                           const random::RandomStream& random) {
  constexpr double kGravity_mps2 = 9.80665;
  constexpr double kIdle_g = 0.002;
  constexpr double kRoad_g = 0.02;  // at 10 m/s
  std::vector<Axes> forces;
  for (std::size_t k = 0; k < truth_dps.size(); ++k) {
    const double speed = drive.speed_mps[k];
    const double change = speed - drive.speed_mps[k == 0 ? 0 : k - 1];
    Axes force{change / drive.period_s / kGravity_mps2,
               speed * truth_dps[k][2] / kDegPerRad / kGravity_mps2, 1.0};
    const double noise_g = kIdle_g + kRoad_g * std::sqrt(speed / 10.0);
    for (std::size_t i = 0; i < 3; ++i) {
      force.at(i) += noise_g * random.normal(static_cast<std::int64_t>(3 * k + i));
    }
    forces.push_back(force);
  }
  return forces;
}

Drive make_drive(const Motion& motion, const Rest& rest, std::uint64_t seed) {
  const random::RandomStream random{seed, 2};
  const std::vector<Axes> truth = resampled(motion.rate_dps, motion.period_s, rest.period_s);
  const std::size_t size = std::min(truth.size(), rest.rate_dps.size());
  const auto offset = static_cast<std::size_t>(random.uniform(0) *
                                               static_cast<double>(rest.rate_dps.size() - size));
  const auto first_axis = static_cast<std::size_t>(3.0 * random.uniform(1));
  Drive drive{.name = motion.name + ", " + rest.name, .period_s = rest.period_s};
  double heading_deg = 0.0;
  for (std::size_t k = 0; k < size; ++k) {
    Axes measured = truth[k];
    for (std::size_t i = 0; i < 3; ++i) {
      measured.at(i) = kScale * measured.at(i) + rest.rate_dps[offset + k].at((i + first_axis) % 3);
    }
    heading_deg += truth[k][2] * rest.period_s;
    const auto at = std::min(motion.speed_mps.size() - 1,
                             static_cast<std::size_t>(std::llround(
                                 static_cast<double>(k + 1) * rest.period_s / motion.period_s)) -
                                 1);
    drive.measured_dps.push_back(measured);
    drive.heading_deg.push_back(heading_deg);
    drive.speed_mps.push_back(motion.speed_mps[at]);
    drive.odometer_pulses.push_back(motion.odometer_pulses[at]);
  }
  drive.force_g = forces_g(drive, {truth.begin(), truth.begin() + static_cast<long>(size)},
                           random.substream(1));
  return drive;
}

}  // namespace zerorate::drives
