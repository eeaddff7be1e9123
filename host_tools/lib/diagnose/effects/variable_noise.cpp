#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>

#include "core/samples/noise_level_track.hpp"
#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kBlocks = 240;      // a change is searched for between blocks, then refined
constexpr double kMostCycles = 40.0;      // cycles of a periodic strength over the record
constexpr std::size_t kFewestBlocks = 2;  // blocks of a stretch
constexpr double kDeepest = 0.98;         // modulation
constexpr double kWays = 3.0;             // one change, a stretch, a swing
constexpr std::size_t kPeriodicBlocks = 5000;  // a hundred and more in a period

/// The strength of the noise over time, up to a factor.
struct Profile {
  enum class Kind { steps, periodic };
  double gain_nats = 0.0;
  double surprisal_nats = 0.0;
  Kind kind = Kind::steps;
  std::size_t first = 0;  ///< values [first, end) have another variance ...
  std::size_t end = 0;
  double ratio = 1.0;   ///< ... by this factor
  double cycles = 0.0;  ///< or the variance swings so often over the record,
  double cosine = 0.0;  ///< variance is 1 + cosine cos + sine sin
  double sine = 0.0;
  double fewest_cycles = 0.0;  ///< the 95 % interval of what is swung
  double most_cycles = 0.0;

  [[nodiscard]] double variance(std::size_t k, std::size_t size) const {
    if (kind == Kind::steps) return k >= first && k < end ? ratio : 1.0;
    return variance_at(std::polar(1.0, turn(k, size)));
  }
  /// @param place  cosine and sine of the turn
  [[nodiscard]] double variance_at(std::complex<double> place) const {
    return std::max(1.0 + cosine * place.real() + sine * place.imag(), 1.0 - kDeepest);
  }
  [[nodiscard]] double turn(std::size_t k, std::size_t size) const {
    return 2.0 * std::numbers::pi * cycles * static_cast<double>(k) / static_cast<double>(size);
  }
};

class Squares {
 public:
  explicit Squares(const Hypothesis::WhiteBandResidual& residual)
      : freedom_(residual.degrees_of_freedom_per_value), sums_(residual.values.size() + 1) {
    for (std::size_t k = 0; k < residual.values.size(); ++k) {
      sums_[k + 1] = sums_[k] + residual.values[k] * residual.values[k];
    }
  }

  [[nodiscard]] std::size_t size() const { return sums_.size() - 1; }
  [[nodiscard]] double freedom() const { return freedom_; }
  [[nodiscard]] double sum(std::size_t first, std::size_t end) const {
    return sums_[end] - sums_[first];
  }

  /// Gain of another variance in [first, end) than elsewhere.
  [[nodiscard]] double gain(std::size_t first, std::size_t end) const {
    const auto all = static_cast<double>(size());
    const auto inside = static_cast<double>(end - first);
    const double outside = all - inside;
    if (inside < 1.0 || outside < 1.0) return 0.0;
    const double within = sum(first, end);
    const double rest = std::max(sums_.back() - within, 1e-300);
    return 0.5 * freedom_ *
           (all * std::log(sums_.back() / all) -
            inside * std::log(std::max(within, 1e-300) / inside) -
            outside * std::log(rest / outside));
  }
  [[nodiscard]] double ratio(std::size_t first, std::size_t end) const {
    const auto inside = static_cast<double>(end - first);
    const double within = sum(first, end);
    const double rest = (sums_.back() - within) / (static_cast<double>(size()) - inside);
    return within / inside / rest;
  }

 private:
  double freedom_;
  std::vector<double> sums_;
};

/// How often the gain of one change crosses a level G upwards by chance, over e^(-G). Its root is
/// an Ornstein-Uhlenbeck process in the logit of the moment, e^(-|x| / 2), of either sign.
/// @param shortest  share of the record before and after the change
double crossings_of_one_change(double gain, double shortest) {
  return std::sqrt(gain / std::numbers::pi) * 2.0 * std::log((1.0 - shortest) / shortest);
}

/// Crossings for a stretch of a share t of the record, whose beginning and end are such a place
/// each: b^3 phi(b) / (2 t (1 - t))^2 with b^2 = 2 G, of either sign, integrated over both
/// (Siegmund 1992).
double crossings_of_two_changes(double gain, double shortest) {
  const double places =
      1.0 / shortest - 1.0 / (1.0 - shortest) + 2.0 * std::log((1.0 - shortest) / shortest);
  return 0.5 * places * std::pow(2.0 * gain, 1.5) / std::sqrt(2.0 * std::numbers::pi);
}

/// Crossings for the frequency of a swing, up to so many cycles over the record (Baluev 2008).
double crossings_of_frequency(double gain, double cycles) {
  return cycles * std::sqrt(gain * std::numbers::pi / 3.0);
}

/// One change, or a stretch between two.
Profile best_steps(const Squares& squares) {
  const std::size_t n = squares.size();
  const std::size_t block = std::max<std::size_t>(1, n / kBlocks);
  Profile best;
  for (std::size_t first = 0; first < n; first += block) {
    for (std::size_t end = first + kFewestBlocks * block; end <= n; end += block) {
      const double gain = squares.gain(first, std::min(end, n));
      if (gain > best.gain_nats)
        best = {.gain_nats = gain, .first = first, .end = std::min(end, n)};
    }
  }
  for (std::size_t step = block; step > 0; step /= 2) {
    for (const std::size_t shift : {step, std::size_t{0}}) {
      const Profile at = best;
      const auto try_one = [&](std::size_t first, std::size_t end) {
        const double gain = squares.gain(first, end);
        if (gain > best.gain_nats) {
          best.gain_nats = gain;
          best.first = first;
          best.end = end;
        }
      };
      if (at.first >= shift) try_one(at.first - shift, at.end);
      if (at.first + shift < at.end) try_one(at.first + shift, at.end);
      if (at.end + shift <= n) try_one(at.first, at.end + shift);
      if (at.end > at.first + shift) try_one(at.first, at.end - shift);
    }
  }
  if (best.gain_nats <= 0.0) return best;
  best.ratio = squares.ratio(best.first, best.end);
  const bool single = best.first == 0 || best.end == n;
  const double shortest = static_cast<double>(kFewestBlocks * block) / static_cast<double>(n);
  const double crossings = single ? crossings_of_one_change(best.gain_nats, shortest)
                                  : crossings_of_two_changes(best.gain_nats, shortest);
  best.surprisal_nats = statistics::surprisal_of_search(best.gain_nats, 1.0, crossings);
  return best;
}

/// The depth by scoring, of a variance that swings so often over the record.
/// @param relative  mean squares of blocks, short beside the period, over their mean
/// @param start  cycles, and where the scoring begins
Profile fit_depth(std::span<const double> relative, const Squares& squares, Profile start) {
  const std::size_t n = relative.size();
  const std::size_t block = squares.size() / n;
  const auto width = static_cast<double>(block);
  Profile best = start;
  best.gain_nats = 0.0;
  std::vector<std::complex<double>> places(n);
  for (std::size_t b = 0; b < n; ++b) {
    places[b] = std::polar(1.0, start.turn(b * block + block / 2, squares.size()));
  }
  for (int i = 0; i < 12; ++i) {
    statistics::SumOfLogs log_variances;
    double scaled = 0.0;
    std::array<double, 2> score{};
    double information = 0.0;
    for (std::size_t b = 0; b < n; ++b) {
      const double variance = best.variance_at(places[b]);
      log_variances.add(variance);
      scaled += relative[b] / variance;
      score[0] += (relative[b] / variance - 1.0) * places[b].real() / variance;
      score[1] += (relative[b] / variance - 1.0) * places[b].imag() / variance;
      information += 0.5 / (variance * variance);
    }
    const auto all = static_cast<double>(n);
    const double gain =
        0.5 * width * squares.freedom() * (-log_variances.value() - all * std::log(scaled / all));
    best.gain_nats = std::max(best.gain_nats, gain);
    best.cosine += score[0] / information;
    best.sine += score[1] / information;
    const double depth = std::hypot(best.cosine, best.sine);
    if (depth > kDeepest) {
      best.cosine *= kDeepest / depth;
      best.sine *= kDeepest / depth;
    }
  }
  return best;
}

/// Where the profile likelihood has fallen by half the 95 % quantile of chi squared, one degree of
/// freedom, on one side of the best number of cycles.
double end_of_cycles(std::span<const double> relative, const Squares& squares, const Profile& best,
                     double sign) {
  constexpr double kFarthest = 0.5;  // cycles
  constexpr double kFewest = 0.1;
  constexpr int kBits = 6;
  double inside = 0.0;
  double outside = kFarthest;
  for (int i = 0; i < kBits; ++i) {
    const double middle = 0.5 * (inside + outside);
    Profile start = best;
    start.cycles = std::max(best.cycles + sign * middle, kFewest);
    const bool is_inside = fit_depth(relative, squares, start).gain_nats >
                           best.gain_nats - statistics::kHalfChiSquared95;
    (is_inside ? inside : outside) = middle;
  }
  return std::max(best.cycles + sign * 0.5 * (inside + outside), kFewest);
}

/// The variance swings as a sine. The frequency from the spectrum of the squares, then by halving
/// steps; all from sums over blocks.
Profile best_periodic(const Squares& squares) {
  const std::size_t block = std::max<std::size_t>(1, squares.size() / kPeriodicBlocks);
  const std::size_t n = spectrum::fast_length_below(squares.size() / block);
  const auto width = static_cast<double>(block);
  // Mean over what the blocks cover: a mean of other values would be a gain of its own.
  const double mean = squares.sum(0, n * block) / static_cast<double>(n * block);
  std::vector<double> relative(n);
  for (std::size_t b = 0; b < n; ++b) {
    relative[b] = squares.sum(b * block, (b + 1) * block) / (width * mean);
  }
  constexpr std::size_t kPadding = 4;
  const spectrum::RealFft fft(kPadding * n);
  std::vector<double> excess(fft.length());
  for (std::size_t b = 0; b < n; ++b) excess[b] = relative[b] - 1.0;
  std::vector<std::complex<double>> bins(fft.bins());
  fft.forward(excess, bins);
  const auto last = std::min(bins.size(), static_cast<std::size_t>(kMostCycles * kPadding));
  std::size_t at = kPadding / 2;
  for (std::size_t j = at; j < last; ++j) {
    if (std::norm(bins[j]) > std::norm(bins[at])) at = j;
  }
  const double covered = static_cast<double>(n * block) / static_cast<double>(squares.size());
  const double scale = 2.0 / static_cast<double>(n);
  Profile best = fit_depth(relative, squares,
                           {.kind = Profile::Kind::periodic,
                            .cycles = static_cast<double>(at) / kPadding / covered,
                            .cosine = std::clamp(scale * bins[at].real(), -0.7, 0.7),
                            .sine = std::clamp(-scale * bins[at].imag(), -0.7, 0.7)});
  constexpr double kWorthPlacing = 5.0;  // nats
  constexpr double kFinestStep = 0.01;   // cycles
  for (double step = 0.5 / kPadding; best.gain_nats > kWorthPlacing && step > kFinestStep;
       step *= 0.5) {
    for (const double sign : {-1.0, 1.0}) {
      Profile start = best;
      start.cycles += sign * step;
      const Profile beside = fit_depth(relative, squares, start);
      if (beside.gain_nats <= best.gain_nats) continue;
      best = beside;
      break;
    }
  }
  if (best.gain_nats > kWorthPlacing) {
    best.fewest_cycles = end_of_cycles(relative, squares, best, -1.0);
    best.most_cycles = end_of_cycles(relative, squares, best, 1.0);
  }
  best.surprisal_nats = statistics::surprisal_of_search(
      best.gain_nats, 2.0, crossings_of_frequency(best.gain_nats, kMostCycles));
  return best;
}

constexpr std::size_t kValuesOfTick = 8;

/// Mean squares of neighbouring values of the whitened record.
std::vector<double> squares_of_ticks(const Hypothesis& all) {
  const std::vector<double>& values = all.whitened();
  std::vector<double> squares(values.size() / kValuesOfTick);
  for (std::size_t tick = 0; tick < squares.size(); ++tick) {
    for (std::size_t k = tick * kValuesOfTick; k < (tick + 1) * kValuesOfTick; ++k) {
      squares[tick] += values[k] * values[k] / static_cast<double>(kValuesOfTick);
    }
  }
  return squares;
}

/// How much better than a constant the node foretells the squares.
double foretold_nats(const std::vector<double>& squares, std::size_t values, double sigma,
                     double time_constants) {
  const core::NoiseLevel model{.variance = static_cast<float>(sigma * sigma),
                               .time_constants_per_tick = static_cast<float>(time_constants)};
  core::NoiseLevelTrack track(model);
  double sum = 0.0;
  for (const double square : squares) {
    track.advance(1);
    const double level = double{track.level()};
    sum -= std::log(level) + square / level - square;
    track.observe(static_cast<float>(square), static_cast<float>(values));
  }
  return 0.5 * static_cast<double>(values) * sum;
}

/// White noise whose strength changes: at a moment, over a stretch, or periodically. The part's
/// shape: 0 for steps with first, end and ratio of the variances; 1 for periodic with cycles over
/// the record, depth, and the ends of the interval of the cycles.
class VariableNoise final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "variable_noise"; }

  [[nodiscard]] std::string_view obstacle(const Hypothesis& without) const override {
    if (without.data().series().is_ticks) return kUnevenSamples;
    return without.is_coarse() ? "levels too coarse" : std::string_view{};
  }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const std::vector<double>& shape = fitted.part().shape;
    return shape[0] == 0.0 ? describe_steps(fitted, shape) : describe_periodic(fitted, shape);
  }

  /// A node that starts again knows no moment of the record: it follows the strength by what it
  /// sees, with the memory and the reach that would have foretold this record best.
  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const std::vector<double> squares = squares_of_ticks(fitted.hypothesis);
    const double tick_s = fitted.hypothesis.data().span_s() / static_cast<double>(squares.size());
    double best = 0.0;
    for (const double sigma : {0.02, 0.05, 0.1, 0.2, 0.4, 0.8}) {
      for (double time_s = fitted.hypothesis.data().span_s() / 3.0; time_s > 10.0 * tick_s;
           time_s *= 0.5) {
        const double gain = foretold_nats(squares, kValuesOfTick, sigma, tick_s / time_s);
        if (gain <= best) continue;
        best = gain;
        model.variable_noise =
            model::VariableNoise{.variance_sigma = sigma, .time_constant_s = time_s};
      }
    }
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    const Squares squares(without.white_band_residual());
    Profile best = best_steps(squares);
    const Profile periodic = best_periodic(squares);
    if (periodic.surprisal_nats > best.surprisal_nats) best = periodic;
    if (best.gain_nats <= 0.0) return std::nullopt;
    Candidate candidate{.part = {.effect = name()},
                        .gain_nats = best.gain_nats,
                        .surprisal_nats = best.surprisal_nats - std::log(kWays)};
    const std::size_t n = without.data().size();
    std::vector<float>& sigma = candidate.part.relative_sigma;
    sigma.reserve(n);
    double mean = 0.0;
    for (std::size_t k = 0; k < n; ++k) mean += best.variance(k, n);
    mean /= static_cast<double>(n);
    for (std::size_t k = 0; k < n; ++k) {
      sigma.push_back(static_cast<float>(std::sqrt(best.variance(k, n) / mean)));
    }
    if (best.kind == Profile::Kind::steps) {
      candidate.part.shape = {0.0, static_cast<double>(best.first), static_cast<double>(best.end),
                              best.ratio};
    } else {
      candidate.part.shape = {1.0, best.cycles, std::hypot(best.cosine, best.sine),
                              best.fewest_cycles, best.most_cycles};
    }
    return candidate;
  }

  static Description describe_steps(const FittedPart& fitted, const std::vector<double>& shape) {
    const FitData& data = fitted.hypothesis.data();
    const double from_s = data.series().time_s(static_cast<std::size_t>(shape[1]));
    const double to_s = data.series().time_s(static_cast<std::size_t>(shape[2]));
    const double factor = std::sqrt(shape[3]);
    const double inside = shape[2] - shape[1];
    const double outside = static_cast<double>(data.size()) - inside;
    const double log_error = std::sqrt(0.5 / inside + 0.5 / outside);
    return {
        .parameters = {positive_parameter("sigma_ratio", factor, log_error),
                       {"from_s", from_s, from_s, from_s},
                       {"to_s", to_s, to_s, to_s}},
        .sentence = fmt::format("Between {} s and {} s the white noise is {:.2f} times "
                                "as strong as before and after.",
                                units::in_figures(from_s, 4), units::in_figures(to_s, 4), factor)};
  }
  static Description describe_periodic(const FittedPart& fitted, const std::vector<double>& shape) {
    const double depth_error =
        std::sqrt(4.0 / static_cast<double>(fitted.hypothesis.data().size()));
    const double span_s = fitted.hypothesis.data().span_s();
    const double period_s = span_s / shape[1];
    return {.parameters = {{"swing_period_s", period_s, span_s / shape[4], span_s / shape[3]},
                           parameter("variance_swing", shape[2], depth_error)},
            .sentence = fmt::format("The variance of the white noise swings by {:.0f} % around its "
                                    "mean, with a period of {} s.",
                                    100.0 * shape[2], units::in_figures(period_s))};
  }
};

}  // namespace

std::unique_ptr<Effect> make_variable_noise() {
  return std::make_unique<VariableNoise>();
}

}  // namespace zerorate::diagnose
