#include "host_tools/lib/fleet/population.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/fleet/lots.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::fleet {
namespace {

/// Axes that the distribution is fitted to at most; those with the first hashes, a random choice.
constexpr std::size_t kMostFitted = 30'000;
constexpr std::size_t kFewestAxes = 8;
/// A distance less likely than this keeps an axis out of the fit.
const double kLogTrimmed = std::log(1e-3);
constexpr int kRounds = 4;
/// Effects that a diagnosis tries on an axis.
constexpr auto kEffectsTried = static_cast<double>(diagnose::kEffects.size());
constexpr double kKindsOfReasons = 3.0;

double log_of(double p_value) {
  return std::log(std::max(p_value, 1e-300));
}

class Fit {
 public:
  Fit(const Database& database, const PopulationOptions& options) : database_(database) {
    population_.options = options;
    read();
    if (population_.members.size() < kFewestAxes) {
      throw std::runtime_error(
          "a population needs at least 8 axes of recordings that could be used; this database "
          "has " +
          std::to_string(population_.members.size()));
    }
    count_effects();
    find_clean();
  }

  Population perform() {
    population_.distribution = first_guess();
    for (int round = 0; round < kRounds; ++round) {
      population_.warnings.clear();
      const std::vector<bool> is_in = choose_core();
      population_.core = static_cast<std::size_t>(
          std::ranges::count(population_.members, true, &Member::is_in_core));
      population_.distribution = fit_normal(likelihoods_, is_in, population_.distribution);
      assess_all();
      judge_sensors();
      choose_reference_lots(population_);
      compare_lots(population_);
    }
    measure_lot_effects(population_, [&](std::size_t member) {
      return member < likelihoods_.size() ? &likelihoods_[member] : nullptr;
    });
    find_changes();
    set_mean_error();
    set_weights();
    return std::move(population_);
  }

 private:
  template <class List>
  static std::size_t index_in(List& list, std::map<std::string, std::size_t>& places,
                              const std::string& name) {
    const auto [place, is_new] = places.emplace(name, list.size());
    if (is_new) {
      list.emplace_back();
      list.back().name = name;
    }
    return place->second;
  }

  void read() {
    std::map<std::string, std::size_t> sensors;
    std::map<std::string, std::size_t> lots;
    database_.for_each([&](StoredRecording one) {
      if (!one.problem.empty()) population_.bad.push_back(one);
      if (one.result.axes.empty()) return;
      const std::size_t sensor = index_in(population_.sensors, sensors, one.entry.sensor);
      const std::size_t lot = index_in(population_.lots, lots, one.entry.lot);
      population_.sensors[sensor].lot = lot;
      ++population_.sensors[sensor].recordings;
      for (AxisResult& axis : one.result.axes) {
        if (likelihoods_.size() < kMostFitted) {
          fitted_.push_back(population_.members.size());
          likelihoods_.push_back(likelihood_of(axis));
          cells_.push_back(axis.log_likelihood);
        }
        population_.members.push_back({.recording = population_.recordings.size(),
                                       .sensor = sensor,
                                       .lot = lot,
                                       .axis = axis.axis});
        axis.log_likelihood.clear();
        axis.white.clear();
      }
      population_.recordings.push_back(std::move(one));
    });
    for (const Sensor& sensor : population_.sensors) ++population_.lots[sensor.lot].sensors;
  }

  [[nodiscard]] const AxisResult& result_of(const Member& member) const {
    const auto& axes = population_.recordings[member.recording].result.axes;
    return *std::ranges::find(axes, member.axis, &AxisResult::axis);
  }

  void count_effects() {
    std::map<std::string, EffectCount> counts;
    std::map<std::string, std::set<std::size_t>> sensors;
    for (const Member& member : population_.members) {
      for (const Cause& cause : result_of(member).causes) {
        ++counts[cause.effect].axes;
        sensors[cause.effect].insert(member.sensor);
      }
    }
    for (auto& [effect, count] : counts) {
      count.effect = effect;
      count.sensors = sensors[effect].size();
      count.is_common =
          effect == kOrderEffect ||
          static_cast<double>(count.sensors) >
              population_.options.common_share * static_cast<double>(population_.sensors.size());
      if (count.is_common) common_.insert(effect);
      population_.effects.push_back(count);
    }
    std::ranges::stable_sort(population_.effects, std::greater{}, &EffectCount::axes);
  }

  [[nodiscard]] bool counts(const Cause& cause) const {
    return !common_.contains(cause.effect) && !cause.may_be_order;
  }

  /// Medians and quartiles of the figures themselves.
  [[nodiscard]] Normal first_guess() const {
    std::vector<double> white;
    std::vector<double> flicker;
    for (const Member& member : population_.members) {
      const AxisResult& axis = result_of(member);
      white.push_back(std::log(axis.angle_random_walk_rad_per_sqrt_s));
      if (axis.bias_instability_rad_s) flicker.push_back(std::log(*axis.bias_instability_rad_s));
    }
    const double middle = statistics::median_of(white);
    const double slow =
        flicker.size() >= kFewestAxes ? statistics::median_of(flicker) : middle - 2.0;
    return {.mean = {middle, slow, 0.55}, .covariance = Point{0.1, 0.5, 0.02}.asDiagonal()};
  }

  void find_clean() {
    for (Member& member : population_.members) {
      const AxisResult& axis = result_of(member);
      const bool has_rare_effect =
          std::ranges::any_of(axis.causes, [&](const Cause& cause) { return counts(cause); });
      member.is_clean = !axis.verdict.empty() && axis.verdict != "unexplained" && !has_rare_effect;
    }
  }

  /// Conditions of an axis of the core, from the strictest on.
  enum class Asked : std::uint8_t { usual, any_lot, any_distance, nothing };

  [[nodiscard]] bool fulfils(const Member& member, Asked asked) const {
    if (asked == Asked::nothing) return true;
    if (!member.is_clean) return false;
    if (asked == Asked::any_distance) return true;
    return member.evidence.log_p > kLogTrimmed &&
           (asked == Asked::any_lot || !population_.lots[member.lot].differs);
  }

  /// @return by fitted likelihood, whether it is in the core
  std::vector<bool> choose_core() {
    std::vector<bool> is_in;
    for (const auto& [asked, warning] :
         {std::pair{Asked::usual, ""},
          std::pair{Asked::any_lot,
                    "fewer than 8 axes are left without the lots that differ: the "
                    "population holds all lots"},
          std::pair{Asked::any_distance,
                    "fewer than 8 axes lie near each other: the population holds all axes without "
                    "rare effects"},
          std::pair{Asked::nothing,
                    "fewer than 8 axes are without a rare effect or something unexplained: the "
                    "population holds all axes"}}) {
      is_in.clear();
      for (Member& member : population_.members) member.is_in_core = fulfils(member, asked);
      for (const std::size_t member : fitted_) {
        is_in.push_back(population_.members[member].is_in_core);
      }
      if (static_cast<std::size_t>(std::ranges::count(is_in, true)) < kFewestAxes) continue;
      if (asked != Asked::usual) population_.warnings.emplace_back(warning);
      break;
    }
    return is_in;
  }

  void assess_all() {
    std::size_t member = 0;
    database_.for_each([&](const StoredRecording& one) {
      for (const AxisResult& axis : one.result.axes) {
        Member& judged = population_.members[member];
        const AxisLikelihood likelihood =
            member < likelihoods_.size() ? likelihoods_[member] : likelihood_of(axis);
        judged.evidence = evidence_of(likelihood, population_.distribution);
        for (int i = 0; i < kCoordinates; ++i) {
          judged.profiles[static_cast<std::size_t>(i)] = profile_of(likelihood, i);
        }
        ++member;
      }
    });
  }

  void judge_sensors() {
    for (Sensor& sensor : population_.sensors) sensor.reasons.clear();
    std::vector<double> axes(population_.sensors.size());
    for (const Member& member : population_.members) {
      const AxisResult& axis = result_of(member);
      const std::string& recording = population_.recordings[member.recording].entry.name;
      auto& reasons = population_.sensors[member.sensor].reasons;
      axes[member.sensor] += 1.0;
      reasons.push_back({"distance", member.axis, recording, member.evidence.log_p});
      if (axis.verdict == "unexplained") {
        reasons.push_back({"unexplained", member.axis, recording, log_of(axis.adequacy_p_value)});
      }
      for (const Cause& cause : axis.causes) {
        if (!counts(cause)) continue;
        reasons.push_back({cause.effect, member.axis, recording,
                           log_of(cause.p_value) + std::log(kEffectsTried)});
      }
    }
    std::vector<double> log_p;
    for (std::size_t i = 0; i < population_.sensors.size(); ++i) {
      Sensor& sensor = population_.sensors[i];
      std::ranges::stable_sort(sensor.reasons, {}, &Reason::log_p);
      const double least = sensor.reasons.empty() ? 0.0 : sensor.reasons.front().log_p;
      sensor.log_p = std::min(0.0, least + std::log(kKindsOfReasons * std::max(axes[i], 1.0)));
      log_p.push_back(sensor.log_p);
    }
    const std::vector<double> q = q_values(log_p);
    for (std::size_t i = 0; i < q.size(); ++i) {
      population_.sensors[i].q_value = q[i];
      population_.sensors[i].is_outlier = q[i] <= population_.options.false_discovery_rate;
    }
  }

  /// Whether the recordings of one sensor can have one noise: chi squared of their estimates.
  void find_changes() {
    struct Sums {
      Matrix information = Matrix::Zero();
      Point shift = Point::Zero();
      double squared = 0.0;
      int rank = 0;
    };
    std::map<std::pair<std::size_t, std::string>, Sums> axes;
    for (const Member& member : population_.members) {
      if (population_.sensors[member.sensor].recordings < 2) continue;
      Sums& sums = axes[{member.sensor, member.axis}];
      const auto [squared, rank] = squared_norm(member.evidence.information, member.evidence.shift);
      sums.information += member.evidence.information;
      sums.shift += member.evidence.shift;
      sums.squared += squared;
      sums.rank += rank;
    }
    std::map<std::size_t, std::pair<double, int>> sensors;
    for (const auto& [key, sums] : axes) {
      const auto [common, rank] = squared_norm(sums.information, sums.shift);
      auto& [squared, freedom] = sensors[key.first];
      squared += std::max(0.0, sums.squared - common);
      freedom += sums.rank - rank;
    }
    std::vector<double> log_p;
    log_p.reserve(sensors.size());
    for (const auto& [sensor, change] : sensors) {
      log_p.push_back(
          change.second > 0 ? statistics::log_chi_squared_tail(change.first, change.second) : 0.0);
    }
    const std::vector<double> q = q_values(log_p);
    std::size_t i = 0;
    for (const auto& [place, change] : sensors) {
      Sensor& sensor = population_.sensors[place];
      sensor.change_log_p = log_p[i];
      sensor.change_q_value = q[i++];
      sensor.has_changed = sensor.change_q_value <= population_.options.false_discovery_rate;
    }
  }

  /// Sandwich of the scores of sensors, whose axes depend on each other.
  void set_mean_error() {
    const Matrix precision = population_.distribution.covariance.inverse();
    std::map<std::size_t, Point> scores;
    Matrix information = Matrix::Zero();
    for (const Member& member : population_.members) {
      if (!member.is_in_core) continue;
      const auto score = scores.emplace(member.sensor, Point::Zero()).first;
      score->second += precision * (member.evidence.posterior.mean - population_.distribution.mean);
      information += precision - precision * member.evidence.posterior.covariance * precision;
    }
    Matrix squares = Matrix::Zero();
    for (const auto& [sensor, score] : scores) squares += score * score.transpose();
    const Matrix inverse = information.inverse();
    population_.mean_error = (inverse * squares * inverse).diagonal().cwiseMax(0.0).cwiseSqrt();
  }

  void set_weights() {
    std::vector<std::vector<float>> core;
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      if (population_.members[fitted_[i]].is_in_core) core.push_back(std::move(cells_[i]));
    }
    population_.weights = weights_of_cells(core);
  }

  const Database& database_;
  Population population_;
  std::set<std::string> common_;
  std::vector<std::size_t> fitted_;  ///< members whose likelihoods are kept
  std::vector<AxisLikelihood> likelihoods_;
  std::vector<std::vector<float>> cells_;
};

}  // namespace

double Population::spread(int coordinate) const {
  return std::sqrt(distribution.covariance(coordinate, coordinate));
}

Population fit_population(const Database& database, const PopulationOptions& options) {
  return Fit{database, options}.perform();
}

}  // namespace zerorate::fleet
