#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

constexpr double kShortestDecay = 0.012;  // share of the record: a shorter one is motion
constexpr double kFewestValues = 4.0;     // values within one decay
constexpr double kLongestDecay = 0.25;    // share of the record: a longer one is a jump
constexpr double kDecayGrid = 1.6;
constexpr std::size_t kMostJumps = 8;
constexpr std::size_t kMostPlaces = 24;  ///< places tried together
constexpr int kMostDecaySteps = 3;       ///< make a factor of two
constexpr double kWorthAJump = 2.0;      ///< nats beyond the price of its place

/// Gains of a decay that begins at each value, at the noise of a search. Of a decay that the end of
/// the record cuts off the gain is too low: the visible part of the decay has less information than
/// a whole one.
class DecayGains {
 public:
  /// @param decay  time constant in values
  DecayGains(const ColumnSearch& scan, double decay) : decay_(decay) {
    const std::vector<double>& precision = scan.precision();
    const std::vector<double>& sines = scan.data().sines();
    const std::size_t n = scan.data().size();
    const double kept = std::exp(-1.0 / decay);
    double information = 0.0;
    double beside = 0.0;  // product of two decays, the second a value later
    for (std::size_t k = 1; k < n; ++k) {
      const double cosine = 1.0 - 0.5 * sines[k] * sines[k];
      const double power = precision[k] / (1.0 + kept * (kept - 2.0 * cosine));
      information += power;
      beside += power * cosine;
    }
    crossings_ = static_cast<double>(n) / std::numbers::pi *
                 std::sqrt(std::max(0.0, 2.0 * (1.0 - beside / information)));
    information /= static_cast<double>(n);

    gains_.resize(n);
    const std::vector<double>& weighted = scan.precision_weighted_residual();
    double sum = 0.0;
    for (std::size_t k = n; k-- > kEdge;) {
      sum = weighted[k] + kept * sum;
      if (k + kEdge < n) gains_[k] = 0.5 * sum * sum / information;
    }
  }

  [[nodiscard]] double decay() const { return decay_; }
  /// Neighbours of a place at which a jump is about as likely.
  [[nodiscard]] Run about(std::size_t place) const {
    const double least = gains_[place] - kIntervalOfPlace_nats;
    Run run{place, place};
    while (run.first > 0 && gains_[run.first - 1] >= least) --run.first;
    while (run.end + 1 < gains_.size() && gains_[run.end + 1] >= least) ++run.end;
    return run;
  }
  [[nodiscard]] double greatest() const { return *std::ranges::max_element(gains_); }
  /// Price of the place of one jump: how often a gain G is exceeded by chance, over e^(-G).
  [[nodiscard]] double price_nats() const { return std::log(std::max(1.0, crossings_)); }

  /// The greatest gains that are worth their place, no two of them closer than a quarter of a
  /// decay; greatest first.
  [[nodiscard]] std::vector<std::size_t> places() const {
    std::vector<std::size_t> worthy;
    for (std::size_t k = 0; k < gains_.size(); ++k) {
      if (gains_[k] > price_nats() + kWorthAJump) worthy.push_back(k);
    }
    std::ranges::sort(worthy, std::ranges::greater{}, [&](std::size_t k) { return gains_[k]; });
    std::vector<std::size_t> places;
    for (const std::size_t k : worthy) {
      const bool is_near = std::ranges::any_of(places, [&](std::size_t other) {
        return std::abs(static_cast<double>(k) - static_cast<double>(other)) < 0.25 * decay_;
      });
      if (!is_near) places.push_back(k);
      if (places.size() == kMostPlaces) break;
    }
    return places;
  }

 private:
  static constexpr std::size_t kEdge = 8;

  double decay_;
  double crossings_ = 0.0;
  std::vector<double> gains_;
};

/// Where a gain is greatest.
struct Peak {
  double at = 0.0;         ///< in steps
  double deviation = 0.0;  ///< standard deviation, in the unit of a step's length
};

/// Climbs from step 0 to the greatest gain at most kMostDecaySteps away. The vertex of a parabola
/// through it and its neighbours is the peak; the curvature of the parabola is its precision.
/// @param step  length of a step
template <class Gain>
Peak peak_of(Gain gain_at, double step) {
  int at = 0;
  std::array<double, 3> gain{gain_at(-1), gain_at(0), gain_at(1)};
  while (gain[2] > gain[1] && at < kMostDecaySteps) gain = {gain[1], gain[2], gain_at(++at + 1)};
  while (gain[0] > gain[1] && at > -kMostDecaySteps) gain = {gain_at(--at - 1), gain[0], gain[1]};
  const double curvature = gain[0] - 2.0 * gain[1] + gain[2];
  if (!(curvature < 0.0)) return {static_cast<double>(at), step * kMostDecaySteps};
  return {.at = at + std::clamp(0.5 * (gain[0] - gain[2]) / curvature, -0.5, 0.5),
          .deviation = step / std::sqrt(-curvature)};
}

/// Jumps of the bias, each of its own height, that decay with one time constant, as stress in a
/// package relaxes. A column a jump; the part's shape: the time constant in s, the standard
/// deviation of its logarithm, the price of a place in nats, and of each jump the time of the first
/// value, the earliest and the latest [s from the first value].
class Relaxation final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "relaxation"; }
  [[nodiscard]] Pace pace() const override { return Pace::slow; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const std::size_t largest = largest_jump(fitted);
    const double height = fitted.amplitude(largest) * kDegPerRad;
    const double decay_s = fitted.part().shape[kDecay];
    const auto jumps = static_cast<double>(fitted.part().columns.size());
    const auto time_s = [&](std::size_t i) {
      return fitted.hypothesis.data().series().start_s +
             fitted.part().shape[kFirstPlace + kPlaceFigures * largest + i];
    };
    return {.parameters = {{"jumps", jumps, jumps, jumps},
                           positive_parameter("time_constant_s", decay_s,
                                              fitted.part().shape[kDecayDeviation]),
                           parameter("largest_height_dps", height,
                                     fitted.amplitude_error(largest) * kDegPerRad),
                           {"largest_time_s", time_s(0), time_s(1), time_s(2)}},
            .sentence = fmt::format("The bias jumps {:.0f} time{}, the furthest by {:.3g} deg/s at "
                                    "{} s, and comes back with a time constant of {} s.",
                                    jumps, jumps > 1.0 ? "s" : "", height,
                                    units::in_figures(time_s(0), 5), units::in_figures(decay_s)),
            .drawing = drawing_of(fitted)};
  }

  /// Jumps may come again: a filter that is to follow takes them for Gauss-Markov noise of the same
  /// variance, half of rate times time constant times squared height.
  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const double decay_s = fitted.part().shape[kDecay];
    double squares = 0.0;
    for (std::size_t i = 0; i < fitted.part().columns.size(); ++i) {
      squares += fitted.amplitude(i) * fitted.amplitude(i);
    }
    const double variance = 0.5 * squares * decay_s / fitted.hypothesis.data().span_s();
    model.gauss_markov.push_back({.sigma_rad_s = std::sqrt(variance), .time_constant_s = decay_s});
  }

 private:
  static constexpr std::size_t kDecay = 0;
  static constexpr std::size_t kDecayDeviation = 1;
  static constexpr std::size_t kPrice = 2;
  static constexpr std::size_t kFirstPlace = 3;
  static constexpr std::size_t kPlaceFigures = 3;

  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    std::optional<Candidate> candidate =
        mean_candidate(without, [this](const ColumnSearch& scan) { return search(scan); });
    if (!candidate) return std::nullopt;
    const auto jumps = static_cast<double>(candidate->part.columns.size());
    const double of_one = statistics::surprisal_of_search(candidate->gain_nats / jumps, 1.0,
                                                          std::exp(candidate->part.shape[kPrice]));
    candidate->surprisal_nats = jumps * of_one - std::log(decays_tried(without.data()));
    return candidate;
  }

  static double longest_decay(const FitData& data) {
    return kLongestDecay * static_cast<double>(data.size());
  }
  static double shortest_decay(const FitData& data) {
    return std::max(kFewestValues, kShortestDecay * static_cast<double>(data.size()));
  }
  static double decays_tried(const FitData& data) {
    return 1.0 + std::log(longest_decay(data) / shortest_decay(data)) / std::log(kDecayGrid);
  }

  static std::size_t largest_jump(const FittedPart& fitted) {
    std::size_t largest = 0;
    for (std::size_t i = 1; i < fitted.part().columns.size(); ++i) {
      if (std::abs(fitted.amplitude(i)) > std::abs(fitted.amplitude(largest))) largest = i;
    }
    return largest;
  }

  [[nodiscard]] std::optional<Part> search(const ColumnSearch& scan) const {
    const FitData& data = scan.data();
    std::optional<DecayGains> best;
    for (double decay = longest_decay(data); decay >= shortest_decay(data); decay /= kDecayGrid) {
      DecayGains gains(scan, decay);
      if (!best || gains.greatest() - gains.price_nats() > best->greatest() - best->price_nats()) {
        best = std::move(gains);
      }
    }
    if (!best) return std::nullopt;
    std::vector<std::size_t> places = chosen_places(scan, *best);
    if (places.empty()) return std::nullopt;
    return best_decay(scan, *best, places);
  }

  /// The jumps that are worth their places beside each other, added one after the other.
  static std::vector<std::size_t> chosen_places(const ColumnSearch& scan, const DecayGains& gains) {
    const std::vector<std::size_t> places = gains.places();
    const double decay_s = gains.decay() * scan.data().period_s();
    std::vector<Column> columns;
    columns.reserve(places.size());
    for (const std::size_t place : places) {
      columns.push_back(fast_decay_column(scan.data(), decay_s, place));
    }
    ColumnPursuit pursuit(scan, std::move(columns));
    std::vector<std::size_t> chosen;
    while (chosen.size() < kMostJumps) {
      const ColumnPursuit::Best best = pursuit.best();
      if (best.gain <= gains.price_nats() + kWorthAJump) break;
      pursuit.choose(best.candidate);
      chosen.push_back(places[best.candidate]);
    }
    return chosen;
  }

  /// log P of jumps at such even times, were they independent of each other.
  static double log_p_of_even_times(std::vector<std::size_t> places) {
    std::ranges::sort(places);
    std::vector<double> waits;
    for (std::size_t i = 1; i < places.size(); ++i) {
      waits.push_back(static_cast<double>(places[i] - places[i - 1]));
    }
    return statistics::log_p_of_even_lengths({&waits, 1});
  }

  /// The time constant that suits all jumps best, within a factor of two of the one of the
  /// greatest.
  [[nodiscard]] Part best_decay(const ColumnSearch& scan, const DecayGains& gains,
                                const std::vector<std::size_t>& places) const {
    const double step = std::numbers::ln2 / kMostDecaySteps;
    const double period_s = scan.data().period_s();
    const auto columns_at = [&](double steps) {
      const double decay_s = gains.decay() * std::exp(steps * step) * period_s;
      std::vector<Column> columns;
      columns.reserve(places.size());
      for (const std::size_t place : places) {
        columns.push_back(fast_decay_column(scan.data(), decay_s, place));
      }
      return columns;
    };
    const Peak peak = peak_of([&](int steps) { return scan.gain(columns_at(steps)); }, step);
    Part part{.effect = name(),
              .columns = columns_at(peak.at),
              .shape = {gains.decay() * std::exp(peak.at * step) * period_s, peak.deviation,
                        gains.price_nats()},
              .log_p_of_even_times = log_p_of_even_times(places)};
    for (const std::size_t place : places) {
      const Run about = gains.about(place);
      for (const std::size_t value : {place, about.first, about.end}) {
        part.shape.push_back(scan.data().time_s(value));
      }
    }
    return part;
  }
};

}  // namespace

std::unique_ptr<Effect> make_relaxation() {
  return std::make_unique<Relaxation>();
}

}  // namespace zerorate::diagnose
