#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

constexpr double kLengthGrid = 1.6;
constexpr std::size_t kMostEvents = 40;

struct Event {
  std::size_t first = 0;
  std::size_t end = 0;
  double gain_nats = 0.0;
  double peak_rad_s = 0.0;
};

/// Keeps the best of neighbouring events of one length that overlap.
void keep_better(std::vector<Event>& peaks, const Event& event) {
  if (!peaks.empty() && peaks.back().end - peaks.back().first == event.end - event.first &&
      event.first < peaks.back().end) {
    if (event.gain_nats > peaks.back().gain_nats) peaks.back() = event;
  } else {
    peaks.push_back(event);
  }
}

/// |X|^2 of a half-sine of unit peak, x_i = sin(pi (i + 1/2) / L), at the angular frequency w: two
/// geometric series.
double half_sine_power(std::size_t length, double angle) {
  const auto samples = static_cast<double>(length);
  const double own = std::numbers::pi / samples;
  const double sine = std::sin(0.5 * angle);
  const double own_sine = std::sin(0.5 * own);
  const double distance = own_sine * own_sine - sine * sine;  // (cos w - cos own) / 2
  constexpr double kOnPeak = 1e-9;
  if (std::abs(distance) < kOnPeak * own_sine * own_sine) return 0.25 * samples * samples;
  const double magnitude =
      std::cos(0.5 * angle * samples) * own_sine * std::sqrt(1.0 - sine * sine) / distance;
  return magnitude * magnitude;
}

/// x' Sigma^-1 x of a half-sine, the same at all places but the very ends: from the frequencies of
/// a transform in which it has room. The density is that of the coefficients beside them; at the
/// lowest ones, which are not like those of a stretch, that of the spectrum.
double information_of_half_sine(const Hypothesis& hypothesis, std::size_t length) {
  constexpr std::size_t kRoom = 16;
  constexpr double kLowest = 128.0;
  const std::vector<double>& density = hypothesis.density();
  const NoiseSpectrum& noise = hypothesis.noise().spectrum;
  const auto n = static_cast<double>(density.size());
  const std::size_t size = spectrum::fast_length_below(kRoom * length);
  double sum = 0.0;
  for (std::size_t j = 1; 2 * j <= size; ++j) {
    const double cycles = static_cast<double>(j) / static_cast<double>(size);
    const double angle = 2.0 * std::numbers::pi * cycles;
    const double place = 2.0 * n * cycles;
    const auto below = std::min(static_cast<std::size_t>(place), density.size() - 2);
    const double share = place - static_cast<double>(below);
    const double strength = place < kLowest
                                ? noise.density(2.0 * std::sin(0.5 * angle), 0, density.size())
                                : (1.0 - share) * density[below] + share * density[below + 1];
    const double twice = 2 * j == size ? 1.0 : 2.0;
    sum += twice * half_sine_power(length, angle) / strength;
  }
  return sum / static_cast<double>(size);
}

/// Gains of a half-sine of one length at all places: a matched filter on Sigma^-1 y, which follows
/// from one place to the next by turning the sum of e^(i pi k / length).
class Matched {
 public:
  Matched(const Hypothesis& hypothesis, std::size_t length)
      : weighted_(hypothesis.precision_weighted_residual()),
        length_(length),
        information_(information_of_half_sine(hypothesis, length)),
        rounding_(hypothesis.rounding_rad_s()) {
    const double turn = std::numbers::pi / static_cast<double>(length);
    back_ = std::polar(1.0, -turn);
    first_ = std::polar(1.0, 0.5 * turn);
    last_ = std::polar(1.0, turn * (static_cast<double>(length) - 0.5));
    for (std::size_t i = 0; i < length; ++i) {
      sum_ += weighted_[i] * std::polar(1.0, turn * (static_cast<double>(i) + 0.5));
    }
  }

  /// How many places the pulse fits in.
  [[nodiscard]] std::size_t places() const { return weighted_.size() - length_ + 1; }

  /// Looks at place `at`, those before having been looked at.
  void look(std::size_t at, double least_nats) {
    const double amplitude = sum_.imag() / information_;
    const double beyond = std::max(0.0, std::abs(amplitude) - rounding_);
    const double gain = 0.5 * beyond * beyond * information_;
    if (gain >= least_nats) keep_better(peaks_, {at, at + length_, gain, amplitude});
    if (at + length_ >= weighted_.size()) return;
    sum_ = product(back_, sum_ - weighted_[at] * first_) + weighted_[at + length_] * last_;
  }

  [[nodiscard]] const std::vector<Event>& peaks() const { return peaks_; }

 private:
  // Without the NaN rules of std::complex's operator*.
  static std::complex<double> product(std::complex<double> a, std::complex<double> b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
  }

  std::span<const double> weighted_;
  std::size_t length_;
  double information_;
  double rounding_;
  std::complex<double> back_;
  std::complex<double> first_;
  std::complex<double> last_;
  std::complex<double> sum_;
  std::vector<Event> peaks_;
};

/// Sums of squares of sums over blocks, [first, end) in blocks.
class Power {
 public:
  Power(const std::vector<double>& values, std::size_t block) : sums_(values.size() / block + 1) {
    for (std::size_t b = 0; b + 1 < sums_.size(); ++b) {
      double sum = 0.0;
      for (std::size_t k = b * block; k < (b + 1) * block; ++k) sum += values[k];
      sums_[b + 1] = sums_[b] + sum * sum / static_cast<double>(block);
    }
  }
  [[nodiscard]] std::size_t blocks() const { return sums_.size() - 1; }
  /// -log P of so much power by chance.
  [[nodiscard]] double surprise(std::size_t first, std::size_t end) const {
    constexpr double kPlain = 4.0;  // standard deviations, not worth an incomplete gamma function
    const auto freedom = static_cast<double>(end - first);
    const double squares = sums_[end] - sums_[first];
    if (squares < freedom + kPlain * std::sqrt(2.0 * freedom)) return 0.0;
    return -statistics::log_chi_squared_tail(squares, freedom);
  }

 private:
  std::vector<double> sums_;
};

/// Motion to and fro has no shape to be matched, but more power than the noise over a short time.
/// It is slow: where all frequencies together are as surprising, the noise itself was stronger.
std::vector<Event> find_swings(const Hypothesis& hypothesis, double price) {
  constexpr std::size_t kFewestBlocks = 5;
  constexpr std::size_t kMostBlocks = 128;
  const std::vector<double> values = StandardisedResidual(hypothesis).values;
  const Power all(values, 1);
  std::vector<Event> peaks;
  for (const std::size_t block : {4U, 16U}) {
    const Power slow(values, block);
    for (std::size_t length = kFewestBlocks; length <= kMostBlocks; length += 1 + length / 2) {
      for (std::size_t b = 0; b + length <= slow.blocks(); b += 1 + length / 8) {
        const double gain = slow.surprise(b, b + length);
        const std::size_t first = b * block;
        const std::size_t end = (b + length) * block;
        if (gain < price + 1.0 || all.surprise(first, end) >= gain) continue;
        const auto [least, most] = std::minmax_element(
            hypothesis.repaired_values().begin() + static_cast<std::ptrdiff_t>(first),
            hypothesis.repaired_values().begin() + static_cast<std::ptrdiff_t>(end));
        keep_better(peaks, {first, end, gain, 0.5 * (*most - *least)});
      }
    }
  }
  return peaks;
}

/// Half-sines of all lengths. Each sum waits for the one before it, so that several lengths side by
/// side take little longer than one.
std::vector<Event> find_pulses(const Hypothesis& hypothesis, double least_nats) {
  constexpr std::size_t kSideBySide = 4;
  constexpr double kShortest = 4.0;        // samples
  constexpr double kLongest = 1.0 / 16.0;  // share of the record
  const double longest = kLongest * static_cast<double>(hypothesis.data().size());
  std::vector<Event> peaks;
  double length = kShortest;
  while (length < longest) {
    std::vector<Matched> filters;
    for (; length < longest && filters.size() < kSideBySide; length *= kLengthGrid) {
      filters.emplace_back(hypothesis, static_cast<std::size_t>(length));
    }
    std::size_t at = 0;
    if (filters.size() == kSideBySide) {
      for (; at < filters.back().places(); ++at) {
        for (std::size_t i = 0; i < kSideBySide; ++i) filters[i].look(at, least_nats);
      }
    }
    for (Matched& filter : filters) {
      for (std::size_t rest = at; rest < filter.places(); ++rest) filter.look(rest, least_nats);
      peaks.insert(peaks.end(), filter.peaks().begin(), filter.peaks().end());
    }
  }
  return peaks;
}

/// Rotation inside what is held for a standstill. The part's shape: first, end and peak (rad/s) of
/// every event, one after the other.
class MotionContamination final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "motion_contamination"; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const std::vector<double>& shape = fitted.part().shape;
    const FitData& data = fitted.hypothesis.data();
    const auto [events, duration_s, peak_sigma_rad_s] = shape_of(fitted);
    Description description;
    description.drawing.effect = name();
    for (std::size_t i = 0; i < shape.size(); i += 3) {
      for (auto k = static_cast<std::size_t>(shape[i]); k < static_cast<std::size_t>(shape[i + 1]);
           k += 1 + static_cast<std::size_t>(shape[i + 1] - shape[i]) / 50) {
        description.drawing.marks.push_back(
            {data.series().time_s(k), data.rate_rad_s()[k] + data.median_rad_s()});
      }
    }
    const double peak = peak_sigma_rad_s * kDegPerRad;
    const double error = 1.0 / std::sqrt(2.0 * events);
    description.parameters = {
        {"events", events, events, events},
        positive_parameter("peak_sigma_dps", peak, error),
        positive_parameter("duration_s", duration_s, 0.5 / std::sqrt(events))};
    description.sentence = fmt::format(
        "The sensor was turned {:.0f} time{} although it was held for still, the first time at "
        "{} s, "
        "for about {} s at up to {:.2g} deg/s.",
        events, events > 1.0 ? "s" : "",
        units::in_figures(data.series().time_s(static_cast<std::size_t>(shape.front())), 5),
        units::in_figures(duration_s, 2), peak);
    return description;
  }

  /// A half-sine has half the square of its peak on average.
  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const Shape shape = shape_of(fitted);
    const double interval_s = fitted.hypothesis.data().span_s() / shape.events - shape.duration_s;
    model.motion_contamination =
        model::MotionContamination{.interval_s = std::max(interval_s, shape.duration_s),
                                   .duration_s = shape.duration_s,
                                   .sigma_rad_s = shape.peak_sigma_rad_s / std::numbers::sqrt2};
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    const double price = price_nats(without.data().size());
    const std::vector<Event> events = find_events(without, price);
    if (events.empty()) return std::nullopt;
    Candidate candidate{.part = {.effect = name()}};
    for (const Event& event : events) {
      const std::size_t margin = (event.end - event.first) / 4;
      candidate.part.replaced.push_back(
          {event.first - std::min(event.first, margin), event.end + margin});
      candidate.part.shape.insert(
          candidate.part.shape.end(),
          {static_cast<double>(event.first), static_cast<double>(event.end), event.peak_rad_s});
      candidate.gain_nats += event.gain_nats;
      candidate.surprisal_nats += event.gain_nats - price;
    }
    candidate.surprisal_nats += 1.0;
    return candidate;
  }

  /// Figures that the events have in common.
  struct Shape {
    double events = 0.0;
    double duration_s = 0.0;        ///< mean
    double peak_sigma_rad_s = 0.0;  ///< root mean square
  };
  static Shape shape_of(const FittedPart& fitted) {
    const std::vector<double>& shape = fitted.part().shape;
    const std::size_t events = shape.size() / 3;
    Shape mean{.events = static_cast<double>(events)};
    double squares = 0.0;
    for (std::size_t i = 0; i < shape.size(); i += 3) {
      mean.duration_s +=
          (shape[i + 1] - shape[i]) * fitted.hypothesis.data().period_s() / mean.events;
      squares += shape[i + 2] * shape[i + 2] / mean.events;
    }
    mean.peak_sigma_rad_s = std::sqrt(squares);
    return mean;
  }

  /// An event has a place and a length.
  static double price_nats(std::size_t size) { return std::log(static_cast<double>(size)) + 2.0; }

  static std::vector<Event> find_events(const Hypothesis& without, double price) {
    std::vector<Event> peaks = find_swings(without, price);
    const std::vector<Event> pulses = find_pulses(without, price + 1.0);
    peaks.insert(peaks.end(), pulses.begin(), pulses.end());
    std::ranges::stable_sort(peaks, std::greater{}, &Event::gain_nats);
    std::vector<Event> events;
    for (const Event& peak : peaks) {
      const std::size_t length = peak.end - peak.first;
      const bool overlaps = std::ranges::any_of(events, [&](const Event& event) {
        const std::size_t margin = event.end - event.first + length;
        return peak.first < event.end + margin && event.first < peak.end + margin;
      });
      if (!overlaps) events.push_back(peak);
      if (events.size() == kMostEvents) break;
    }
    std::ranges::sort(events, {}, &Event::first);
    return events;
  }
};

}  // namespace

std::unique_ptr<Effect> make_motion_contamination() {
  return std::make_unique<MotionContamination>();
}

}  // namespace zerorate::diagnose
