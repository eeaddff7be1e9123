#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <span>
#include <utility>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

/// Longest record of the search for a moving tone; a longer one takes too long and tells it by its
/// patches.
constexpr std::size_t kMostStretches = 32;

/// Power of each frequency in each stretch of time, of mean 1.
struct Spectrogram {
  std::size_t stretches;
  std::size_t bins;
  std::vector<double> power;  ///< stretch after stretch

  [[nodiscard]] double at(std::size_t stretch, std::size_t bin) const {
    return power[stretch * bins + bin];
  }
};

Spectrogram spectrogram_of(const std::vector<double>& values, std::size_t stretches) {
  const std::size_t length = spectrum::fast_length_below(values.size() / stretches);
  const spectrum::RealFft fft(length);
  Spectrogram result{stretches, length / 2 - 1, {}};
  result.power.reserve(stretches * result.bins);
  std::vector<std::complex<double>> bins(fft.bins());
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t first = s * (values.size() / stretches);
    fft.forward(std::span(values).subspan(first, length), bins);
    for (std::size_t j = 1; j <= result.bins; ++j) {
      result.power.push_back(std::norm(bins[j]) / static_cast<double>(length));
    }
  }
  return result;
}

/// Sums over patches of the spectrogram, all together, and the most unlikely one.
struct Patches {
  double log_p = 0.0;
  double log_p_of_one = 0.0;
  double time_s = 0.0;  ///< time of the most unlikely patch
};

Patches patches_of(const StandardisedResidual& residual, std::size_t stretches, std::size_t bands) {
  const Spectrogram spectrogram = spectrogram_of(residual.values, stretches);
  const std::size_t width = spectrogram.bins / bands;
  if (width < 4) return {};
  double sum = 0.0;
  double most = 0.0;
  std::size_t at = 0;
  for (std::size_t s = 0; s < stretches; ++s) {
    for (std::size_t b = 0; b < bands; ++b) {
      double power = 0.0;
      for (std::size_t j = b * width; j < (b + 1) * width; ++j) power += spectrogram.at(s, j);
      const double z =
          statistics::normal_of_chi_squared(2.0 * power, 2.0 * static_cast<double>(width));
      sum += z * z;
      if (std::abs(z) <= most) continue;
      most = std::abs(z);
      at = s;
    }
  }
  const auto patches = static_cast<double>(stretches * bands);
  const FitData& data = residual.hypothesis->data();
  return {.log_p = statistics::log_chi_squared_tail(sum, patches),
          .log_p_of_one = statistics::log_of_smallest(statistics::log_normal_tails(most), patches),
          .time_s = data.series().time_s((2 * at + 1) * data.size() / (2 * stretches))};
}

/// Coarse and fine patches.
void test_patches(const StandardisedResidual& residual, Tests& tests) {
  const Patches coarse = patches_of(residual, 8, 8);
  const Patches fine = patches_of(residual, 32, 16);
  constexpr double kGrids = 2.0;
  const Patches& clearer = fine.log_p_of_one < coarse.log_p_of_one ? fine : coarse;
  tests.push_back({fmt::format("the spectrum changes over time, most near {} s",
                               units::in_figures(clearer.time_s, 4)),
                   statistics::log_of_smallest(
                       std::min({coarse.log_p, fine.log_p, clearer.log_p_of_one}), 2.0 * kGrids)});
}

/// Turning back by some cycles.
std::complex<double> turn_of(double cycles) {
  return std::polar(1.0, -2.0 * std::numbers::pi * cycles);
}

/// Sums of values over each of `blocks`, turned back along a straight line.
/// @param from cycles a value at the first  @param rate growth of them from value to value
std::vector<std::complex<double>> block_sums(std::span<const double> values, std::size_t blocks,
                                             double from, double rate) {
  const std::size_t length = values.size() / blocks;
  const std::complex<double> growth = turn_of(rate);
  std::vector<std::complex<double>> sums(blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    const auto begin = static_cast<double>(b * length);
    // In cycles: from t + rate t^2 / 2, and its step to the next value, which grows by rate.
    std::complex<double> turn = turn_of(from * begin + 0.5 * rate * begin * begin);
    std::complex<double> step = turn_of(from + rate * (begin + 0.5));
    for (const double value : values.subspan(b * length, length)) {
      sums[b] += value * turn;
      turn = spectrum::product(turn, step);
      step = spectrum::product(step, growth);
    }
  }
  return sums;
}

/// Sweeps to try, in both directions.
struct Sweeps {
  double widest;         ///< cycles over the record
  double step;           ///< cycles over the record
  double turned_at;      ///< place in its block where a sum is turned: it moves the bins a little
  std::size_t fft_size;  ///< beyond the blocks it places the frequency more finely
};

/// The most power in one bin of block sums that are turned back at each of the sweeps.
double most_power(std::span<const std::complex<double>> sums, const Sweeps& sweeps) {
  const auto blocks = static_cast<double>(sums.size());
  const spectrum::ComplexFft fft(sweeps.fft_size);
  std::vector<std::complex<double>> turned(sweeps.fft_size);
  std::vector<std::complex<double>> bins(sweeps.fft_size);
  std::vector<std::complex<double>> steps(sums.size());
  for (std::size_t b = 0; b < sums.size(); ++b) {
    const double place = (static_cast<double>(b) + sweeps.turned_at) / blocks - 0.5;
    turned[b] = sums[b] * turn_of(-0.5 * sweeps.widest * place * place);
    steps[b] = turn_of(0.5 * sweeps.step * place * place);
  }
  double most = 0.0;
  for (double sweep = -sweeps.widest; sweep <= sweeps.widest; sweep += sweeps.step) {
    fft.forward(turned, bins);
    for (const std::complex<double>& bin : bins) most = std::max(most, std::norm(bin));
    std::ranges::transform(std::span(turned).first(steps.size()), steps, turned.begin(),
                           spectrum::product);
  }
  return most;
}

/// A tone whose frequency moves at a constant rate. Each stretch is turned back at the rate before
/// it is transformed, so that a fast sweep keeps its power in one bin; the powers along the line
/// are then summed. The values are real, so the negative frequencies of a transform are what
/// turning at the opposite rate gives.
class MovingTone {
 public:
  /// Searches.
  MovingTone(std::span<const double> values, std::size_t stretches)
      : values_(values),
        stretches_(stretches),
        length_(spectrum::fast_length_below(values.size() / stretches)),
        fft_(length_),
        turned_(length_, 1.0),
        turn_(length_),
        bins_(length_),
        rising_(stretches * half()),
        falling_(stretches * half()) {
    const auto length = static_cast<double>(length_);
    for (std::size_t i = 0; i < length_; ++i) {
      const double place = (static_cast<double>(i) + 0.5) / length - 0.5;
      turn_[i] = std::polar(1.0, -std::numbers::pi * kSweepStep * place * place);
    }
    search();
    std::ranges::sort(strongest_, std::ranges::greater{}, &Line::power);
  }

  [[nodiscard]] double log_p() const {
    const double freedom = 2.0 * static_cast<double>(stretches_);
    return statistics::log_of_smallest(
        statistics::log_chi_squared_tail(2.0 * strongest_.front().power, freedom), lines_);
  }

  /// Probability of the coherent power of the strongest lines over all values. At one line it is
  /// exponential with mean 1. It exceeds a level G anywhere with at most the area of frequencies
  /// and sweeps times sqrt(det L) / pi (G - 1/2) e^(-G), where L is the covariance of the
  /// derivatives of the phase by the two (Adler and Taylor 2007).
  [[nodiscard]] double log_p_of_coherent() const {
    constexpr std::size_t kMostLines = 16;
    double most = 1.0;
    for (const Line& line : std::span(strongest_).first(std::min(kMostLines, strongest_.size()))) {
      most = std::max(most, coherent_power(line));
    }
    const auto size = static_cast<double>(values_.size());
    const double area = 0.5 * size * 2.0 * kWidestSweep * size;  // in cycles over the record
    const double root_determinant = std::numbers::pi * std::numbers::pi / std::sqrt(540.0);
    return std::min(0.0,
                    std::log(area * root_determinant / std::numbers::pi * (most - 0.5)) - most);
  }

 private:
  static constexpr double kWidestSweep = 0.3;  // cycles a sample, over the record
  /// Bins in a stretch. A tone half a step off its sweep keeps 0.95 of its power in one bin.
  static constexpr double kSweepStep = 2.0;

  /// A straight line through the spectrogram.
  struct Line {
    double power = 0.0;  ///< sum over the stretches
    double from = 0.0;   ///< bin in the first stretch
    double sweep = 0.0;  ///< bins from stretch to stretch
  };

  void search() {
    const double fastest = kWidestSweep * static_cast<double>(length_) /
                           static_cast<double>(stretches_);  // bins in a stretch
    for (double sweep = 0.0; sweep <= fastest; sweep += kSweepStep) {
      transform();
      sum_near(rising_, sweep);
      if (sweep > 0.0) sum_near(falling_, -sweep);
      turn_further();
    }
  }

  [[nodiscard]] std::size_t half() const { return length_ / 2; }

  void turn_further() {
    for (std::size_t i = 0; i < length_; ++i) turned_[i] = spectrum::product(turned_[i], turn_[i]);
  }

  void transform() {
    const auto length = static_cast<double>(length_);
    std::vector<std::complex<double>> stretch(length_);
    for (std::size_t s = 0; s < stretches_; ++s) {
      const std::size_t first = s * (values_.size() / stretches_);
      for (std::size_t i = 0; i < length_; ++i) stretch[i] = values_[first + i] * turned_[i];
      fft_.forward(stretch, bins_);
      for (std::size_t j = 0; j < half(); ++j) {
        rising_[s * half() + j] = static_cast<float>(std::norm(bins_[j]) / length);
        falling_[s * half() + j] =
            static_cast<float>(std::norm(bins_[(length_ - j) % length_]) / length);
      }
    }
  }

  /// The line is placed more finely than the turning needs.
  void sum_near(const std::vector<float>& power, double sweep) {
    strongest_.emplace_back();
    const double step = 1.0 / static_cast<double>(stretches_);
    for (double fine = sweep - 0.5 * kSweepStep; fine < sweep + 0.5 * kSweepStep - 0.5 * step;
         fine += step) {
      sum_along(power, fine);
    }
  }

  /// All lines of a sweep that stay inside the spectrum, at once: one stretch after the other.
  void sum_along(const std::vector<float>& power, double sweep) {
    const double moved = sweep * static_cast<double>(stretches_ - 1);
    const auto bins = static_cast<double>(half());
    const double first = std::max(1.0, std::ceil(1.0 - moved));
    const double end = std::min(bins, std::ceil(bins - 1.0 - moved));
    if (end <= first) return;
    sums_.assign(static_cast<std::size_t>(end - first), 0.0F);
    for (std::size_t s = 0; s < stretches_; ++s) {
      const double place = first + std::floor(static_cast<double>(s) * sweep + 0.5);
      const auto row = std::span(power).subspan(s * half() + static_cast<std::size_t>(place));
      for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += row[i];
    }
    const auto best = std::ranges::max_element(sums_);
    const double power_of_best{*best};
    if (power_of_best > strongest_.back().power) {
      strongest_.back() = {power_of_best, first + static_cast<double>(best - sums_.begin()), sweep};
    }
    lines_ += end - first;
  }

  /// Power of the values at the best straight line near one: they are turned back along it and
  /// summed in blocks, among whose few frequencies and sweeps the best is found.
  [[nodiscard]] double coherent_power(const Line& line) const {
    constexpr std::size_t kBlocks = 64;
    constexpr double kFinest = 2.0;  // cycles: loses at most 5 % of the power
    const std::size_t values_per_stretch = values_.size() / stretches_;
    const auto hop = static_cast<double>(values_per_stretch);
    const double rate = line.sweep / (hop * static_cast<double>(length_));
    const double from = line.from / static_cast<double>(length_) - 0.5 * rate * hop;
    const Sweeps near{.widest = static_cast<double>(stretches_),  // a bin of a stretch
                      .step = kFinest,
                      .turned_at = 0.5,
                      .fft_size = 4 * kBlocks};
    return most_power(block_sums(values_, kBlocks, from, rate), near) /
           static_cast<double>(values_.size());
  }

  std::span<const double> values_;
  std::size_t stretches_;
  std::size_t length_;
  spectrum::ComplexFft fft_;
  std::vector<std::complex<double>> turned_;  ///< turn of each value at the sweep
  std::vector<std::complex<double>> turn_;    ///< turn of each value for one step of the sweep
  std::vector<std::complex<double>> bins_;
  std::vector<float> rising_;    ///< power of each frequency in each stretch at a rate
  std::vector<float> falling_;   ///< power of each frequency in each stretch at the opposite rate
  std::vector<float> sums_;      ///< sums along the lines of one sweep, by where they begin
  std::vector<Line> strongest_;  ///< strongest line of each sweep
  double lines_ = 0.0;
};

/// In the whole record, in its halves and in its quarters, within which the rate of a tone that
/// does not move steadily changes less.
Test moving_tone(const std::vector<double>& values) {
  // Eight stretches; more where they would be too long to try every rate.
  constexpr std::size_t kLongest = 4096;
  double least = 0.0;
  double places = 0.0;
  for (const std::size_t parts : {1U, 2U, 4U}) {
    const std::size_t size = values.size() / parts;
    const std::size_t stretches = std::max<std::size_t>(8, size / kLongest);
    if (stretches > kMostStretches) continue;
    for (std::size_t part = 0; part < parts; ++part) {
      const MovingTone tone{std::span(values).subspan(part * size, size), stretches};
      least = std::min(least, tone.log_p());
      places += 1.0;
      if (parts > 1) continue;
      least = std::min(least, tone.log_p_of_coherent());
      places += 1.0;
    }
  }
  return {"a tone moves through the spectrum", statistics::log_of_smallest(least, places)};
}

/// The best log likelihood of a tone near an angle that moves at a constant rate.
/// @param weighted Sigma^-1 y  @param density at the angle
double gain_of_sweep(const std::vector<double>& weighted, double density, double angle,
                     std::size_t blocks) {
  const auto sums = block_sums(weighted, blocks, angle / (2.0 * std::numbers::pi), 0.0);
  const Sweeps all{.widest = 0.5 * static_cast<double>(blocks),
                   .step = 1.0,
                   .turned_at = 0.0,
                   .fft_size = blocks};
  const double most = most_power(sums, all);
  return most * density / static_cast<double>(weighted.size());
}

/// A line whose phase wanders has its power in no single sweep: under it, a likelihood ratio of
/// e^t in favour of a given sweep has the probability e^(-t) (Markov's inequality). Sweeps that are
/// wider than the blocks follow are those of MovingTone.
void test_sweeping_line(const Hypothesis& hypothesis, Tests& tests) {
  constexpr std::size_t kMostBlocks = 1024;
  constexpr double kLinewidths = 16.0;
  std::vector<Part> others;
  std::ranges::copy_if(hypothesis.parts(), std::back_inserter(others),
                       [](const Part& part) { return !part.terms.line; });
  if (others.size() == hypothesis.parts().size()) return;
  const FitData& data = hypothesis.data();
  const Hypothesis without(data, std::move(others), &hypothesis);
  const NoiseSpectrum& noise = hypothesis.noise().spectrum;
  const auto size = static_cast<double>(data.size());
  const auto blocks =
      std::min(kMostBlocks, static_cast<std::size_t>(kLinewidths * size / noise.line_samples));
  const auto index = static_cast<std::size_t>(noise.line_angle / std::numbers::pi * size);
  const double sweep = gain_of_sweep(without.precision_weighted_residual(),
                                     without.density()[index], noise.line_angle, blocks);
  const double line = hypothesis.log_likelihood() - without.log_likelihood();
  const double searched = 2.0 * std::log(static_cast<double>(blocks)) + std::log1p(2.0 * sweep);
  tests.push_back(
      {fmt::format(
           "the tone at {} Hz sweeps, it does not wander at random",
           units::in_figures(noise.line_angle / (2.0 * std::numbers::pi * data.period_s()), 4)),
       std::min(0.0, line + searched - sweep)});
}

}  // namespace

Tests test_spectrum_over_time(const StandardisedResidual& residual) {
  Tests tests;
  test_patches(residual, tests);
  tests.push_back(moving_tone(residual.values));
  test_sweeping_line(*residual.hypothesis, tests);
  return tests;
}

}  // namespace zerorate::diagnose
