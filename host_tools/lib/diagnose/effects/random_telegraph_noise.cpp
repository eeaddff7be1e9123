#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/switch_search.hpp"
#include "host_tools/lib/parallel/parallel.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

constexpr std::size_t kMostPoints = 32'768;
constexpr std::size_t kFewestSwitches = 3;
constexpr unsigned kNoWindows = 0;  // the path is grown instead
constexpr int kRounds = 14;
constexpr int kAnnealed = 8;  // rounds in which the flicker noise is held back

using Path = std::vector<std::uint8_t>;

std::size_t switches(const Path& path) {
  std::size_t count = 0;
  for (std::size_t k = 1; k < path.size(); ++k) count += path[k] != path[k - 1] ? 1U : 0U;
  return count;
}

Switches switches_of(const Path& path) {
  Switches places;
  for (std::size_t k = 1; k < path.size(); ++k) {
    if (path[k] != path[k - 1]) places.push_back(k);
  }
  return places;
}

Path path_of(const Switches& switches, std::size_t size) {
  Path path(size);
  for (std::size_t i = 0; i < switches.size(); i += 2) {
    const std::size_t end = i + 1 < switches.size() ? switches[i + 1] : size;
    std::fill(path.begin() + static_cast<std::ptrdiff_t>(switches[i]),
              path.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{1});
  }
  return path;
}

/// The record at the resolution at which paths are searched: the lowest coefficients of the DCT,
/// transformed back at their own length.
class Coarse {
 public:
  explicit Coarse(const ColumnSearch& scan)
      : size_(spectrum::fast_length_below(std::min(scan.data().size(), kMostPoints))),
        whole_(scan.data().size()),
        own_transform_(size_ == whole_ ? std::nullopt
                                       : std::optional<spectrum::CosineTransform>(size_)),
        transform_of_record_(&scan.data().transform()) {
    const double block = static_cast<double>(whole_) / static_cast<double>(size_);
    coefficients_.assign(scan.residual().begin(),
                         scan.residual().begin() + static_cast<std::ptrdiff_t>(size_));
    for (double& c : coefficients_) c /= std::sqrt(block);
    white_ = scan.noise().white_variance / block;
    slow_share_.resize(size_);
    const std::vector<double>& density = scan.density();
    for (std::size_t k = 1; k < size_; ++k) {
      slow_share_[k] = std::max(0.0, density[k] / block - white_);
    }
    values_ = transform().inverse(coefficients_);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double white_variance() const { return white_; }
  [[nodiscard]] const std::vector<double>& values() const { return values_; }

  /// Searches with this share of the slow noise.
  [[nodiscard]] SwitchSearch search(double slow_factor) const {
    std::vector<double> density(size_);
    for (std::size_t k = 1; k < size_; ++k) density[k] = white_ + slow_factor * slow_share_[k];
    return {transform(), coefficients_, density, white_};
  }

  /// Values without the slow noise that is expected once the path is taken away.
  [[nodiscard]] std::vector<double> without_slow_noise(const std::vector<double>& path_mean,
                                                       double slow_factor) const {
    std::vector<double> slow = transform().forward(path_mean);
    slow[0] = 0.0;
    for (std::size_t k = 1; k < size_; ++k) {
      const double strength = slow_factor * slow_share_[k];
      slow[k] = (coefficients_[k] - slow[k]) * strength / (strength + white_);
    }
    std::vector<double> rest = transform().inverse(slow);
    for (std::size_t k = 0; k < size_; ++k) rest[k] = values_[k] - rest[k];
    return rest;
  }

  /// The path at the record's own resolution.
  [[nodiscard]] std::vector<double> expand(const Path& path) const {
    std::vector<double> values(whole_);
    for (std::size_t k = 0; k < whole_; ++k) {
      values[k] = path[std::min(k * size_ / whole_, size_ - 1)];
    }
    return values;
  }

 private:
  [[nodiscard]] const spectrum::CosineTransform& transform() const {
    return own_transform_ ? *own_transform_ : *transform_of_record_;
  }

  std::size_t size_;
  std::size_t whole_;
  std::optional<spectrum::CosineTransform> own_transform_;  ///< where it is shorter than the record
  const spectrum::CosineTransform* transform_of_record_;
  std::vector<double> coefficients_;
  std::vector<double> slow_share_;
  std::vector<double> values_;
  double white_ = 0.0;
};

/// The path of greatest probability between two levels in white noise, each switch at a price.
Path viterbi(const std::vector<double>& values, std::array<double, 2> levels, double variance,
             double price) {
  Path from_zero(values.size());
  Path from_one(values.size());
  std::array<double, 2> cost{};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const bool zero_switched = cost[1] + price < cost[0];
    const bool one_switched = cost[0] + price < cost[1];
    from_zero[k] = zero_switched ? 1 : 0;
    from_one[k] = one_switched ? 0 : 1;
    cost = {zero_switched ? cost[1] + price : cost[0], one_switched ? cost[0] + price : cost[1]};
    for (std::size_t s = 0; s < 2; ++s) {
      const double error = values[k] - levels[s];
      cost[s] += 0.5 * error * error / variance;
    }
  }
  Path path(values.size());
  std::uint8_t state = cost[1] < cost[0] ? 1 : 0;
  for (std::size_t k = values.size(); k-- > 0;) {
    path[k] = state;
    state = state == 0 ? from_zero[k] : from_one[k];
  }
  return path;
}

/// Mean of the values in each state.
std::array<double, 2> levels_of(const std::vector<double>& values, const Path& path) {
  std::array<double, 2> sums{};
  std::array<double, 2> counts{1e-9, 1e-9};
  for (std::size_t k = 0; k < values.size(); ++k) {
    sums[path[k]] += values[k];
    counts[path[k]] += 1.0;
  }
  return {sums[0] / counts[0], sums[1] / counts[1]};
}

/// Levels to begin with: the outer parts of the distribution of means over a window.
std::array<double, 2> outer_levels(const std::vector<double>& values, std::size_t window) {
  std::vector<double> means;
  means.reserve(values.size() / window);
  for (std::size_t first = 0; first + window <= values.size(); first += window) {
    double sum = 0.0;
    for (std::size_t k = first; k < first + window; ++k) sum += values[k];
    means.push_back(sum / static_cast<double>(window));
  }
  std::ranges::sort(means);
  return {means[means.size() / 6], means[means.size() - 1 - means.size() / 6]};
}

std::vector<double> mean_of(const Path& path, std::array<double, 2> levels) {
  std::vector<double> mean(path.size());
  for (std::size_t k = 0; k < path.size(); ++k) mean[k] = levels[path[k]];
  return mean;
}

/// Path and slow noise in turn, the slow noise held back at first so that it does not take the
/// path's place.
Path alternate(const Coarse& coarse, std::array<double, 2> levels, std::optional<Path> path) {
  const auto size = static_cast<double>(coarse.size());
  const bool is_new = !path.has_value();
  if (is_new) {
    path = viterbi(coarse.values(), levels, coarse.white_variance(), std::log(size));
  }
  for (int round = 0; round < kRounds; ++round) {
    const double factor =
        is_new ? std::pow(0.01, std::max(0.0, 1.0 - static_cast<double>(round) / kAnnealed)) : 1.0;
    const std::vector<double> rest = coarse.without_slow_noise(mean_of(*path, levels), factor);
    levels = levels_of(rest, *path);
    const double count = std::max(1.0, static_cast<double>(switches(*path)));
    Path next = viterbi(rest, levels, coarse.white_variance(), std::log(size / count));
    const bool settled = next == *path && factor == 1.0;
    path = std::move(next);
    if (settled || switches(*path) == 0) break;
  }
  return *path;
}

/// The path that gains most in noise of the fitted density, from nothing: with little slow noise
/// first, in whose place the switches then stand, and from the path so found with more and more.
Path grow(const Coarse& coarse) {
  Switches path;
  for (const double slow_factor : {0.03, 0.1, 0.3, 1.0}) {
    path = coarse.search(slow_factor).improve(std::move(path));
  }
  return path_of(path, coarse.size());
}

/// log P of stays as even as these, were the switches independent of each other. The first and the
/// last stay are not known whole.
double log_p_of_even_stays(const Path& path) {
  std::array<std::vector<double>, 2> stays;
  std::size_t first = 0;
  for (std::size_t k = 1; k < path.size(); ++k) {
    if (path[k] == path[k - 1]) continue;
    if (first > 0) stays[path[first]].push_back(static_cast<double>(k - first));
    first = k;
  }
  return statistics::log_p_of_even_lengths(stays);
}

/// A bias that switches between two levels. The part's shape: number of switches, of points, and
/// the mean lengths of stay in s, low and high.
class RandomTelegraphNoise final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "random_telegraph_noise"; }
  [[nodiscard]] Pace pace() const override { return Pace::either; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const std::vector<double>& shape = fitted.part().shape;
    const double height = std::abs(fitted.amplitude(0)) * kDegPerRad;
    const double half = std::max(1.0, 0.5 * shape[0]);
    const double log_error = 1.0 / std::sqrt(half);
    const bool is_up = fitted.amplitude(0) > 0.0;
    return {
        .parameters = {parameter("height_dps", height, fitted.amplitude_error(0) * kDegPerRad),
                       positive_parameter("mean_low_s", shape[is_up ? 2 : 3], log_error),
                       positive_parameter("mean_high_s", shape[is_up ? 3 : 2], log_error)},
        .sentence = fmt::format("The bias switches {:.0f} times between two levels {:.3g} deg/s "
                                "apart.",
                                shape[0], height),
        .drawing = drawing_of(fitted)};
  }

  /// For a filter, a process of the same variance and correlation: covariance a b h^2 e^(-t/tau),
  /// 1/tau = 1/low + 1/high.
  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const std::vector<double>& shape = fitted.part().shape;
    const double low = shape[2];
    const double high = shape[3];
    model.gauss_markov.push_back(
        {.sigma_rad_s = std::abs(fitted.amplitude(0)) * std::sqrt(low * high) / (low + high),
         .time_constant_s = low * high / (low + high)});
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    static constexpr std::array<unsigned, 3> kWindows = {60U, 400U, kNoWindows};
    std::array<std::optional<Candidate>, kWindows.size()> found;
    parallel::for_each(found.size(), parallel::kAllThreads,
                       [&](std::size_t i) { found[i] = find(without, kWindows[i]); }, {});
    return *std::ranges::max_element(found, {}, [](const std::optional<Candidate>& one) {
      return one && std::isfinite(one->gain_nats) ? one->gain_nats
                                                  : -std::numeric_limits<double>::infinity();
    });
  }

  /// The path that begins with the means of so many windows.
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without, unsigned windows) const {
    std::optional<Path> path;
    std::optional<MeanFit> fitted =
        fit_mean(without, [&](const ColumnSearch& scan) { return search(scan, windows, path); });
    if (!fitted) return std::nullopt;
    const double gain = fitted->gain_nats - price_of(*fitted);
    const std::vector<double>& shape = fitted->part.shape;
    const double shorter_stay_s = std::min(shape[2], shape[3]);
    // Three parameters: height and two lengths of stay.
    return Candidate{.part = std::move(fitted->part),
                     .gain_nats = gain,
                     .surprisal_nats = gain - 2.0,
                     .time_scale_s = shorter_stay_s};
  }

  [[nodiscard]] std::optional<Part> search(const ColumnSearch& scan, unsigned windows,
                                           std::optional<Path>& path) const {
    const Coarse coarse(scan);
    const std::size_t window = std::max<std::size_t>(1, coarse.size() / std::max(1U, windows));
    if (windows != kNoWindows) {
      path = alternate(coarse, outer_levels(coarse.values(), window), path);
    } else {
      path = path ? path_of(coarse.search(1.0).improve(switches_of(*path)), coarse.size())
                  : grow(coarse);
    }
    const std::size_t count = switches(*path);
    if (count < kFewestSwitches || 8 * count > coarse.size()) return std::nullopt;
    const std::vector<double> values = coarse.expand(*path);
    double high = 0.0;
    for (const double value : values) high += value;
    const double stays = 0.5 * static_cast<double>(count + 1);
    const double period_s = scan.data().period_s();
    return Part{.effect = name(),
                .columns = {column_of(scan.data(), values)},
                .shape = {static_cast<double>(count), static_cast<double>(coarse.size()),
                          (static_cast<double>(values.size()) - high) * period_s / stays,
                          high * period_s / stays},
                .log_p_of_even_times = log_p_of_even_stays(*path)};
  }

  static double price_of(const MeanFit& fitted) {
    const Hypothesis& with = fitted.with;
    const double height = with.amplitudes()[with.first_amplitude(with.parts().size() - 1)];
    const auto count = static_cast<std::size_t>(fitted.part.shape[0]);
    const double block = static_cast<double>(with.data().size()) / fitted.part.shape[1];
    return price_of_switches(count, static_cast<std::size_t>(fitted.part.shape[1]),
                             with.noise().spectrum.white_variance / (block * height * height));
  }
};

}  // namespace

std::unique_ptr<Effect> make_random_telegraph_noise() {
  return std::make_unique<RandomTelegraphNoise>();
}

}  // namespace zerorate::diagnose
