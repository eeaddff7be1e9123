#include "host_tools/lib/fleet/analysis.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <numbers>
#include <span>
#include <system_error>
#include <utility>

#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/identify/innovations_likelihood.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::fleet {
namespace {

/// Hash of files one after the other.
class Hash {
 public:
  Hash() { static_cast<void>(XXH3_128bits_reset(&state_)); }

  void add(std::span<const char> bytes) {
    static_cast<void>(XXH3_128bits_update(&state_, bytes.data(), bytes.size()));
  }
  void add_file(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) throw std::system_error(errno, std::generic_category(), path.string());
    std::array<char, 65536> block{};
    ssize_t size = 0;
    while ((size = ::read(descriptor, block.data(), block.size())) > 0) {
      add(std::span{block}.first(static_cast<std::size_t>(size)));
    }
    const int error = errno;
    ::close(descriptor);
    if (size < 0) throw std::system_error(error, std::generic_category(), path.string());
  }
  [[nodiscard]] std::string digits() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(&state_);
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  }

 private:
  XXH3_state_t state_{};
};

/// Gain of the likeliest order over 1/2, the order of the diagnosis' base [nats].
double gain_of_order(const AxisResult& axis) {
  constexpr std::size_t kHalf = 6;
  static_assert(Grid::order(kHalf) > 0.499 && Grid::order(kHalf) < 0.501);
  const auto first = axis.log_likelihood.begin() + kHalf * Grid::kAmplitudes;
  return -double{*std::max_element(first, first + Grid::kAmplitudes)};
}

/// Takes from a cause the gain that another order of the flicker noise has as well: the order
/// belongs to the population.
void compare_with_order(const AxisResult& axis, Cause& cause) {
  if (cause.effect == kOrderEffect) return;
  const double left_nats = std::max(0.0, cause.gain_nats - gain_of_order(axis));
  if (left_nats < diagnose::kAlternativeNats) cause.may_be_order = true;
  cause.p_value = std::max(cause.p_value, std::exp(-statistics::surprisal_of_strength(left_nats)));
}

Cause cause_of(const diagnose::Cause& cause) {
  const auto is_order = [](const auto& other) { return other.effect == kOrderEffect; };
  return {.effect = cause.effect,
          .gain_nats = cause.gain_nats,
          .p_value = cause.p_value,
          .probability = cause.probability,
          .may_be_order = std::ranges::any_of(cause.alternatives, is_order) ||
                          std::ranges::any_of(cause.set95, is_order)};
}

void add_diagnosis(const diagnose::Diagnosis& diagnosis, AxisResult& result) {
  result.verdict = name(diagnosis.verdict);
  result.adequacy_p_value = diagnosis.extended_adequacy.p_value;
  for (const diagnose::Cause& cause : diagnosis.causes) {
    result.causes.push_back(cause_of(cause));
    compare_with_order(result, result.causes.back());
    for (const diagnose::Parameter& parameter : cause.parameters) {
      if (parameter.name != "linear_dps_per_k") continue;
      result.temperature_slope_rad_s_per_k = parameter.value * units::kRadPerDeg;
      result.temperature_slope_error =
          0.5 * (parameter.hi - parameter.lo) / statistics::kHalfWidth95 * units::kRadPerDeg;
    }
  }
}

/// Diagnoses all axes together, so that they can have a cause in common.
void diagnose_axes(const identify::RestSamples& samples, const std::vector<std::size_t>& axes,
                   RecordingResult& result) {
  const auto of_axis = [&](const std::string& axis) -> AxisResult& {
    return *std::ranges::find(result.axes, axis, &AxisResult::axis);
  };
  std::vector<diagnose::Record> records;
  records.reserve(axes.size());
  for (const std::size_t axis : axes) {
    records.push_back(diagnose::record_of(samples, axis));
  }
  diagnose::DiagnoseOptions options;
  options.on_left_out = [&](const std::string& axis, const std::string& reason) {
    of_axis(axis).remark = reason;
  };
  for (const diagnose::Diagnosis& diagnosis : diagnose::diagnose(std::move(records), options)) {
    add_diagnosis(diagnosis, of_axis(diagnosis.axis));
  }
}

AxisResult result_of(const identify::AxisCharacterization& axis) {
  const identify::InnovationsFit& fit = axis.fit;
  AxisResult result{.axis = axis.axis,
                    .angle_random_walk_rad_per_sqrt_s = fit.angle_random_walk_rad_per_sqrt_s.value,
                    .angle_random_walk_error = fit.angle_random_walk_rad_per_sqrt_s.standard_error};
  if (!fit.flicker) return result;
  result.bias_instability_rad_s = fit.flicker->bias_instability_rad_s.value;
  result.bias_instability_error = fit.flicker->bias_instability_rad_s.standard_error;
  if (fit.flicker->order_source == identify::OrderSource::estimated) {
    result.order = fit.flicker->order.value;
    result.order_error = fit.flicker->order.standard_error;
  }
  return result;
}

double mean_rate(const identify::RestSamples& samples, std::size_t axis) {
  double sum = 0.0;
  for (const auto& rates : samples.rate_rad_s) sum += double{rates[axis]};
  return sum / static_cast<double>(samples.rate_rad_s.size());
}

/// White noise that makes the differences of neighbouring ticks, as a unit for the grid.
double white_of_neighbours(const std::vector<identify::TickMean>& ticks, std::size_t axis,
                           core::Duration tick) {
  double squares = 0.0;
  for (std::size_t k = 1; k < ticks.size(); ++k) {
    const double step = double{ticks[k].rate_rad_s[axis]} - double{ticks[k - 1].rate_rad_s[axis]};
    squares += step * step;
  }
  if (!(squares > 0.0)) throw recording::DataError("the record is constant or not finite");
  return std::sqrt(0.5 * squares / static_cast<double>(ticks.size() - 1) *
                   units::seconds(tick.ns()));
}

/// Noise of the samples as the filter sees it at its ticks.
///
/// The filter samples flicker noise once a tick. A mean over n samples has less of it near half the
/// rate of the ticks, so that the filter describes it best with other figures than those of the
/// samples (docs/design/identification.md, "The tick"). The relative change of the spectrum is
/// small: least squares over the frequencies, which the likelihood weighs alike (Whittle 1953),
/// give the change of the figures.
class TickMeans {
 public:
  explicit TickMeans(const identify::AxisTicks& ticks)
      : tick_s_(units::seconds(ticks.tick.ns())),
        // Beyond 16 samples a tick the change grows by less than 2 % of itself.
        samples_(std::clamp(std::round(static_cast<double>(ticks.tick.ns()) /
                                       static_cast<double>(ticks.sample_period.ns())),
                            1.0, 16.0)),
        lowest_(1.0 / static_cast<double>(std::max<std::size_t>(ticks.means.size(), 4))) {}

  /// Change of ln N, ln B and d.
  /// @param flicker_over_white  B / N of the samples
  [[nodiscard]] Point change(double order, double flicker_over_white) const {
    constexpr int kFrequencies = 48;
    const double ratio = flicker_over_white * flicker_over_white * std::pow(tick_s_, 2.0 * order);
    const double octaves = std::log(0.5 / lowest_);
    Matrix normal = Matrix::Zero();
    Point right = Point::Zero();
    for (int i = 0; i < kFrequencies; ++i) {
      const double frequency = 0.5 * std::exp(-octaves * (i + 0.5) / kFrequencies);
      const double sampled = ratio * density(order, frequency);
      const double all = 1.0 + sampled;
      const double log_rate = std::log(2.0 * std::sin(std::numbers::pi * frequency) / tick_s_);
      const Point slope{1.0 / all, 2.0 * sampled / all, -2.0 * sampled * log_rate / all};
      const double difference = (ratio * density_of_means(order, frequency) - sampled) / all;
      normal += frequency * slope * slope.transpose();  // equally many frequencies lie about each
      right += frequency * difference * slope;
    }
    Point solution = normal.ldlt().solve(right);
    constexpr double kLeast = -0.999;  // N^2 cannot become negative
    if (solution[0] < kLeast) {
      solution[0] = kLeast;
      const Eigen::Vector2d left = right.tail<2>() - kLeast * normal.col(0).tail<2>();
      solution.tail<2>() = normal.bottomRightCorner<2, 2>().ldlt().solve(left);
    }
    return {0.5 * std::log1p(solution[0]), solution[1], solution[2]};
  }

 private:
  /// Density of flicker noise at a frequency in cycles a sample, over that of B = 1.
  [[nodiscard]] static double density(double order, double frequency) {
    return std::pow(2.0 * std::sin(std::numbers::pi * frequency), -2.0 * order);
  }
  [[nodiscard]] double density_of_means(double order, double frequency) const {
    double sum = 0.0;
    for (double alias = 0.0; alias < samples_; alias += 1.0) {
      const double place = (frequency + alias) / samples_;
      const double gain =
          std::sin(std::numbers::pi * frequency) / (samples_ * std::sin(std::numbers::pi * place));
      sum += gain * gain * density(order, place);
    }
    return std::pow(samples_, -2.0 * order) * sum;
  }

  double tick_s_;
  double samples_;
  double lowest_;  ///< frequency that a record of so many ticks shows, in cycles a tick
};

}  // namespace

std::string RecordingResult::problem() const {
  const std::string_view separator = axes_left_out.empty() || rows_doubt.empty() ? "" : ". ";
  return fmt::format("{}{}{}", axes_left_out, separator, rows_doubt);
}

void measure_likelihood(const identify::AxisTicks& ticks, AxisResult& result) {
  const identify::InnovationsLikelihood likelihood{ticks.means, ticks.axis, ticks.sample_period,
                                                   ticks.tick};
  const TickMeans means{ticks};
  const double unit = result.angle_random_walk_rad_per_sqrt_s;
  model::SensorModel model{.name = "fleet"};
  // Decades that are quicker than a tick are white at it, and are counted as such.
  model.flicker =
      model::Flicker{.shortest_time_constant_s = std::max(0.5, units::seconds(ticks.tick.ns()))};
  std::vector<double> log_likelihood(Grid::kCells);
  result.white.resize(Grid::kCells);
  for (std::size_t i = 0; i < Grid::kOrders; ++i) {
    for (std::size_t j = 0; j < Grid::kAmplitudes; ++j) {
      const double flicker_over_white =
          std::exp(Grid::log_amplitude(j)) * std::pow(Grid::kPivot_rad_s, Grid::order(i));
      const Point change = means.change(Grid::order(i), flicker_over_white);
      model.white.angle_random_walk_rad_per_sqrt_s = unit * std::exp(change[0]);
      model.flicker->bias_instability_rad_s = unit * flicker_over_white * std::exp(change[1]);
      model.flicker->order = Grid::order(i) + change[2];
      const identify::Likelihood one = likelihood(model);
      result.innovations = one.innovations;
      const auto count = static_cast<double>(one.innovations);
      const double scale = one.squared_innovations / count;
      const std::size_t cell = i * Grid::kAmplitudes + j;
      log_likelihood[cell] = -0.5 * (one.log_variances + count * std::log(scale));
      result.white[cell] = static_cast<float>(unit * std::sqrt(scale));
    }
  }
  const double best = std::ranges::max(log_likelihood);
  result.log_likelihood.clear();
  for (const double one : log_likelihood) {
    result.log_likelihood.push_back(static_cast<float>(one - best));
  }
}

PopulationSamples read_population_samples(const recording::Input& recording,
                                          std::string_view axis) {
  constexpr double kMostUnused = 0.1;
  recording::Reader reader{recording};
  PopulationSamples read{.recording = recording.path.filename().string(),
                         .samples = identify::read_rest_samples(reader)};
  read.axes = identify::axes_called(axis, read.samples.axis_count);
  const std::size_t asked = read.axes.size();
  std::vector<identify::RestDoubt> doubts = identify::doubts_of_rest(read.samples);
  // Nobody looks at each recording of a fleet: what is in doubt is no member of the population.
  for (identify::RestDoubt& doubt : doubts) doubt.is_certain = true;
  std::vector<std::string> remarks =
      identify::require_rest(doubts, identify::AcceptedDoubts{recording.accepted}, read.axes);
  if (read.axes.size() < asked) {
    read.axes_left_out = fmt::format("{}", fmt::join(remarks, ". "));
  }
  read.rows_doubt = recording::doubt_of_rows(read.samples.findings);
  const auto left_out = read.samples.findings.left_out();
  const double unused = static_cast<double>(left_out + read.samples.lost) /
                        static_cast<double>(left_out + read.samples.rows);
  if (unused > kMostUnused) {
    throw recording::DataError(
        fmt::format("{:.2g} % of the rows cannot be used: the sensor is not judged by the rest. "
                    "'zerorate characterize' shows why",
                    100.0 * unused));
  }
  return read;
}

std::vector<AxisResult> noise_of(const PopulationSamples& recording) {
  const identify::RestSamples samples = identify::measurements_of(recording.samples);
  const core::Duration period = samples.mean_period;
  const core::Duration tick = identify::identification_tick(samples);
  const auto ticks = identify::average_ticks(samples, tick);
  std::vector<AxisResult> axes;
  for (const std::size_t axis : recording.axes) {
    AxisResult one{.axis = samples.axis_name(axis), .mean_rate_rad_s = mean_rate(samples, axis)};
    one.angle_random_walk_rad_per_sqrt_s = white_of_neighbours(ticks, axis, tick);
    measure_likelihood({ticks, period, tick, axis}, one);
    const auto best = std::ranges::max_element(one.log_likelihood) - one.log_likelihood.begin();
    one.angle_random_walk_rad_per_sqrt_s = double{one.white[static_cast<std::size_t>(best)]};
    axes.push_back(std::move(one));
  }
  return axes;
}

RecordingResult analyse(const PopulationSamples& recording) {
  const identify::RestSamples& samples = recording.samples;
  const std::vector<std::size_t>& axes = recording.axes;
  const identify::Characterization characterization =
      identify::characterize(samples, {.recording = recording.recording, .axes = axes});
  RecordingResult result{.rows = samples.rows,
                         .sample_period_s = units::seconds(characterization.sample_period.ns()),
                         .rest_s = characterization.rest_s,
                         .axes_left_out = recording.axes_left_out,
                         .rows_doubt = recording.rows_doubt};
  const auto ticks =
      identify::average_ticks(identify::measurements_of(samples), characterization.tick);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    AxisResult one = result_of(characterization.axes[i]);
    one.mean_rate_rad_s = mean_rate(samples, axes[i]);
    measure_likelihood({ticks, characterization.sample_period, characterization.tick, axes[i]},
                       one);
    result.axes.push_back(std::move(one));
  }
  diagnose_axes(samples, axes, result);
  return result;
}

std::string content_hash(const std::filesystem::path& recording) {
  Hash hash;
  if (!std::filesystem::is_directory(recording)) {
    hash.add_file(recording);
    return hash.digits();
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(recording)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const std::filesystem::path& file : files) {
    const std::string name = file.lexically_relative(recording).string();
    hash.add(std::span{name.c_str(), name.size() + 1});
    hash.add_file(file);
  }
  return hash.digits();
}

}  // namespace zerorate::fleet
