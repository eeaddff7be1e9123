/// @file
/// Population of a fleet: distributions, sensors that leave them, lots, changes of a sensor, the
/// prior for the next one, and the limits of an end-of-line test. docs/reference/fleets.md has the
/// formulas.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/fleet/database.hpp"
#include "host_tools/lib/fleet/quality.hpp"
#include "host_tools/lib/report/report.hpp"

namespace zerorate::fleet {

/// Axis of a recording, as the population sees it.
struct Member {
  std::size_t recording = 0;  ///< index
  std::size_t sensor = 0;     ///< index
  std::size_t lot = 0;        ///< index
  std::string axis;
  SensorEvidence evidence;
  std::array<Profile, kCoordinates> profiles;
  bool is_clean = false;    ///< diagnosed, and free of rare effects and of what is unexplained
  bool is_in_core = false;  ///< the population is fitted to it
};

/// Reason for which a sensor leaves the population.
struct Reason {
  std::string name;  ///< "distance", "unexplained" or an effect
  std::string axis;
  std::string recording;
  double log_p = 0.0;  ///< natural logarithm of its p-value
};

struct Sensor {
  std::string name;
  std::size_t lot = 0;
  std::size_t recordings = 0;
  std::vector<Reason> reasons;  ///< the most surprising first
  double log_p = 0.0;           ///< log p of the most surprising one among so many
  double q_value = 1.0;         ///< false discovery rate at which the sensor is named
  bool is_outlier = false;
  std::optional<double> change_log_p;  ///< log p of changes between its recordings; two or more
  double change_q_value = 1.0;
  bool has_changed = false;
};

/// Difference of a lot from the lots of the reference: of ln N, ln B or d. It is not drawn towards
/// the population, as the estimates of single axes are.
struct LotEffect {
  double value = 0.0;
  double lo = 0.0;  ///< 95 % interval
  double hi = 0.0;
};

/// One lot beside the other lots of the reference.
struct LotFigure {
  std::size_t lot = 0;
  std::string what;          ///< a coordinate, or "outliers"
  double lot_value = 0.0;    ///< middle of the lot's sensors, SI; share of the outliers
  double other_value = 0.0;  ///< value of the sensors of the reference
  double p_value = 1.0;
  bool differs = false;             ///< the lot differs, and this figure alone shows it
  std::optional<LotEffect> effect;  ///< nullopt where the recordings do not determine it
};

struct Lot {
  std::string name;
  std::size_t sensors = 0;
  double q_value = 1.0;  ///< false discovery rate at which the lot is named
  bool differs = false;
  bool is_reference = false;  ///< other lots are compared with it
};

/// An effect in the fleet.
struct EffectCount {
  std::string effect;
  std::size_t axes = 0;
  std::size_t sensors = 0;
  bool is_common = false;  ///< belongs to the type: no reason to leave the population
};

struct PopulationOptions {
  double false_discovery_rate = 0.05;
  /// Effects that more of the sensors have belong to the type.
  double common_share = 0.2;
};

struct Population {
  std::vector<StoredRecording> recordings;  ///< without likelihoods
  std::vector<Member> members;
  std::vector<Sensor> sensors;
  std::vector<Lot> lots;
  std::vector<LotFigure> lot_figures;  ///< the least p-value first
  std::vector<EffectCount> effects;    ///< the most frequent first
  std::vector<StoredRecording> bad;    ///< not used, or not with all axes
  std::vector<std::string> warnings;   ///< weaknesses of what the figures rest on
  Normal distribution;                 ///< distribution of the core
  Point mean_error = Point::Zero();    ///< standard errors of the mean, sensors being independent
  std::size_t core = 0;                ///< axes
  /// Weights of the cells of Grid over the core: nonparametric maximum likelihood.
  std::vector<double> weights;
  PopulationOptions options;
  std::optional<Quality> quality;  ///< where it is asked for: quality_of()

  [[nodiscard]] double spread(int coordinate) const;
};

/// Fits the population of a database, by expectation and maximisation over each axis's likelihood:
/// errors of the recordings widen nothing. Sensors with rare effects, far from the rest or
/// of a lot that differs are left out of the fit and are judged by it; where fewer than 8 axes are
/// left, less is asked of them, with a warning.
/// Memory: some 10 kB an axis. Throws std::runtime_error with fewer than 8 usable axes.
[[nodiscard]] Population fit_population(const Database& database, const PopulationOptions& options);

/// Model of the next sensor of this type: medians of the population, and [prior] as wide as the
/// population, less certain where few sensors were seen.
[[nodiscard]] model::SensorModel type_model(const Population& population, const std::string& name);

/// q-values in the order of the tests: the least false discovery rate at which each of them is
/// named (Benjamini and Hochberg 1995).
[[nodiscard]] std::vector<double> q_values(const std::vector<double>& log_p_values);

/// Text for a terminal.
[[nodiscard]] std::string to_text(const Population& population);
/// Schema zerorate.fleet-report/1, docs/reference/fleets.md.
[[nodiscard]] std::string to_json(const Population& population);
/// CSV: one line an axis of a recording.
[[nodiscard]] std::string to_csv(const Population& population);
[[nodiscard]] report::Report make_report(const Population& population,
                                         const std::string& provenance);

inline constexpr std::string_view kLimitsSchema = "zerorate.limits/1";

/// Limits of every axis. A figure without a range is not judged.
struct Limits {
  double shortest_s = 0.0;  ///< time at rest below which nothing is judged
  std::optional<Range> angle_random_walk_rad_per_sqrt_s;
  std::optional<Range> bias_instability_rad_s;
  std::optional<Range> order;
  std::optional<Range> mean_rate_rad_s;
  std::vector<std::string> fail_on;  ///< effects that fail a sensor; they take a diagnosis
  std::vector<std::string> remarks;  ///< comments of the file
};

/// Limits that all but one in a thousand axes of the population keep, normal tails assumed.
/// @param test_s  length of the test, whose errors are then allowed for, so that at most one good
///   sensor in twenty is too short to decide; a figure that it cannot decide is left out, with a
///   remark. 0: no errors are allowed for
[[nodiscard]] Limits limits_of(const Population& population, double test_s);

/// Limits as TOML; docs/reference/fleets.md has the format.
[[nodiscard]] std::string format_limits(const Limits& limits);
/// Reads a file of limits as parse_limits(). Throws std::system_error where it cannot be read.
[[nodiscard]] Limits read_limits(const std::filesystem::path& file);
/// Throws toml_file::Error that names line, key and what was expected.
[[nodiscard]] Limits parse_limits(std::string_view toml, std::string_view origin);

enum class Judgement { pass, fail, too_short };
[[nodiscard]] std::string_view name(Judgement judgement);

/// Judges a 95 % interval: outside of the limits it fails, inside it passes.
[[nodiscard]] Judgement judge(const Range& interval, const Range& limits);
/// Whether a cause of the diagnosis fails a sensor.
[[nodiscard]] bool fails_by(const Cause& cause, const Limits& limits);

/// One figure of one axis beside its limits.
struct JudgedFigure {
  std::string axis;
  std::string figure;
  double value = 0.0;
  double lo = 0.0;  ///< 95 % interval
  double hi = 0.0;
  Range limits;
  Judgement judgement = Judgement::pass;
};

struct Acceptance {
  Judgement judgement = Judgement::pass;
  double rest_s = 0.0;
  std::vector<JudgedFigure> figures;
  std::vector<std::string> reasons;  ///< why it is judged so
};

/// Judges a recording at rest. A figure fails where its 95 % interval lies outside of the limits,
/// passes where it lies inside, and is too short to decide where a limit lies in between. One
/// figure that fails fails the sensor. B and d are judged together, by the likelihood on the grid.
/// @param axis  x, y, z or all
/// Cost: below a second for three axes of 6,000 samples. Throws recording::DataError.
[[nodiscard]] Acceptance accept(const recording::Input& recording, const Limits& limits,
                                std::string_view axis = "all");

[[nodiscard]] std::string to_json(const Acceptance& acceptance, const std::string& recording);

}  // namespace zerorate::fleet
