/// @file
/// One recording of a fleet: its noise figures, its causes, and its likelihood on a grid; and the
/// population that makes many of them likeliest.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/recording/input.hpp"

namespace zerorate::fleet {

/// Version of what is computed from a recording. Results of two versions are never mixed: raise the
/// number whenever a figure of the same recording may change.
inline constexpr int kAnalysisVersion = 3;

/// Grid of flicker noises over which each recording's likelihood is kept.
///
/// The amplitude is the root of the flicker's density over the white density at the pivot of the
/// learning node, 1/30 rad/s: there a record has most information, whatever its order. Cell
/// `order * kAmplitudes + amplitude`.
struct Grid {
  static constexpr double kPivot_rad_s = 1.0 / 30.0;
  static constexpr std::size_t kOrders = 15;      ///< 0.2 to 0.9
  static constexpr std::size_t kAmplitudes = 21;  ///< factors from e^-4 to e^4
  static constexpr std::size_t kCells = kOrders * kAmplitudes;

  [[nodiscard]] static constexpr double order(std::size_t i) {
    return 0.2 + 0.05 * static_cast<double>(i);
  }
  [[nodiscard]] static constexpr double log_amplitude(std::size_t i) {
    return -4.0 + 0.4 * static_cast<double>(i);
  }
};

/// Effect that is a coordinate of the population.
inline constexpr std::string_view kOrderEffect = "fractional_order";

/// A cause that the diagnosis names on an axis.
struct Cause {
  std::string effect;
  double gain_nats = 0.0;
  double p_value = 1.0;
  double probability = 1.0;
  /// The order of the flicker noise would explain the recording nearly as well.
  bool may_be_order = false;
};

/// Figures of one axis; SI units.
struct AxisResult {
  std::string axis;
  double angle_random_walk_rad_per_sqrt_s = 0.0;  ///< N
  double angle_random_walk_error = 0.0;           ///< standard error
  std::optional<double> bias_instability_rad_s;   ///< B; nothing where no flicker is detectable
  std::optional<double> bias_instability_error;
  std::optional<double> order;        ///< d, where it was estimated
  std::optional<double> order_error;  ///< standard error
  double mean_rate_rad_s = 0.0;
  std::optional<double> temperature_slope_rad_s_per_k;  ///< where the diagnosis names a drift
  std::optional<double> temperature_slope_error;
  std::string verdict;            ///< verdict of the diagnosis; empty where the axis was left out
  double adequacy_p_value = 1.0;  ///< small where the extended model leaves something
  std::string remark;             ///< why the axis was left out of the diagnosis
  std::vector<Cause> causes;

  std::size_t innovations = 0;  ///< innovations of the filter in each cell
  /// Logarithm of the likelihood of each cell less that of the likeliest, at the white noise that
  /// is likeliest in the cell.
  std::vector<float> log_likelihood;
  std::vector<float> white;  ///< likeliest N of each cell [rad/s/sqrt(Hz)]
};

/// Results of one recording that are kept.
struct RecordingResult {
  std::size_t rows = 0;
  double sample_period_s = 0.0;
  double rest_s = 0.0;
  std::vector<AxisResult> axes;
  std::string axes_left_out;  ///< why axes that were asked for are missing; empty where none is
  std::string rows_doubt;     ///< recording::doubt_of_rows()

  /// Reason why the recording is not used as a whole, as it stands; empty where it is.
  [[nodiscard]] std::string problem() const;
};

/// Likelihood of one axis on the grid, by the node's own filter: the white noise is a scale of all
/// variances, whose maximum is closed form. The noise of a cell is that of the samples; the filter
/// gets the model of its tick means. Sets `innovations`, `log_likelihood` and `white`.
/// Cost: one pass of the filter a cell.
void measure_likelihood(const identify::AxisTicks& ticks, AxisResult& result);

/// Samples of a recording at rest, as far as a sensor can be judged by them.
struct PopulationSamples {
  std::string recording;  ///< file name
  identify::RestSamples samples;
  std::vector<std::size_t> axes;  ///< those asked for that measured
  std::string axes_left_out;      ///< reason, as RecordingResult has it
  std::string rows_doubt;         ///< recording::doubt_of_rows()
};

/// Reads a recording.
/// @param axis  x, y, z or all
/// Throws recording::DataError for a recording that is not at rest or in another doubt that nobody
/// has accepted, where no axis measured, and where more than 10 % of the rows cannot be used.
[[nodiscard]] PopulationSamples read_population_samples(const recording::Input& recording,
                                                        std::string_view axis = "all");

/// Mean rate and likelihood of the axes, without a diagnosis: an end-of-line test has no time for
/// one. N is the likeliest on the grid.
[[nodiscard]] std::vector<AxisResult> noise_of(const PopulationSamples& recording);

/// Characterizes and diagnoses a recording. Deterministic: a pure function of the samples.
/// Throws recording::DataError for a recording that cannot be used, as one too short for a fit.
[[nodiscard]] RecordingResult analyse(const PopulationSamples& recording);

/// Hash of the content of a recording, 32 hexadecimal digits (XXH3, 128 bits); of a folder that of
/// its files in the order of their names. Throws std::system_error.
[[nodiscard]] std::string content_hash(const std::filesystem::path& recording);

/// Coordinates of a noise in the population: ln N, ln B and d, N and B in SI units.
inline constexpr int kCoordinates = 3;
using Point = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;
inline constexpr std::array<const char*, kCoordinates> kCoordinateNames = {
    "angle_random_walk", "bias_instability", "order"};

/// Normal distribution of the coordinates.
struct Normal {
  Point mean = Point::Zero();
  Matrix covariance = Matrix::Identity();
};

/// Point of the grid, made finer by interpolation, with its log likelihood.
struct GridPoint {
  Eigen::Vector3f position;  ///< at the likeliest N
  float log_likelihood = 0.0F;
};

/// Likelihood of an axis over the coordinates. About each point ln N is normal, and ln B moves with
/// it, because the grid fixes their ratio.
struct AxisLikelihood {
  std::vector<GridPoint> points;    ///< not much less likely than the likeliest one
  double log_white_variance = 0.0;  ///< variance of ln N at a point: 1 / (2 innovations)
};
[[nodiscard]] AxisLikelihood likelihood_of(const AxisResult& axis);

/// Likeliest value of a coordinate, and the ends of the 95 % interval of its profile likelihood.
struct Profile {
  double best = 0.0;
  double lo = 0.0;
  double hi = 0.0;
};
[[nodiscard]] Profile profile_of(const AxisLikelihood& axis, int coordinate);

/// Normal population of the greatest likelihood, by expectation and maximisation from a first guess
/// (Dempster, Laird and Rubin 1977): each step is a sum over the axes.
/// @param is_in  which axes count
[[nodiscard]] Normal fit_normal(const std::vector<AxisLikelihood>& axes,
                                const std::vector<bool>& is_in, Normal first_guess);

/// Evidence of one axis about its sensor and the population.
struct SensorEvidence {
  /// Likelihood as information: exp(b' z - z' A z / 2) up to a factor, z being the distance from
  /// the mean of the population in units of four spreads. A direction that the record does not
  /// determine has no information.
  Matrix information = Matrix::Zero();
  Point shift = Point::Zero();
  Normal posterior;    ///< posterior of the coordinates, with the population as prior
  double log_p = 0.0;  ///< log p of so large a distance from the population
};
[[nodiscard]] SensorEvidence evidence_of(const AxisLikelihood& axis, const Normal& population);

/// b' A^+ b, and the rank of A.
[[nodiscard]] std::pair<double, int> squared_norm(const Matrix& information, const Point& shift);

/// Nonparametric population: weights of the cells of the grid of the greatest likelihood, by
/// expectation and maximisation (Laird 1978). Each step is a sum over the axes.
[[nodiscard]] std::vector<double> weights_of_cells(
    const std::vector<std::vector<float>>& log_likelihoods);

}  // namespace zerorate::fleet
