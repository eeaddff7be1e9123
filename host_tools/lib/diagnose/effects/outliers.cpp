#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

constexpr double kMostProbable = 0.03;    // a more frequent value is not an outlier
constexpr double kWorthAnInterval = 5.0;  // nats
constexpr double kLeastSize = 2.0;        // in standard deviations of the rest
constexpr double kBinsPerSigma = 20.0;
constexpr std::size_t kBins = 2000;  // the last one holds all that is farther out

/// A share p of N(0, v (1 + s^2)) in N(0, v).
struct Mixture {
  double variance = 1.0;
  double probability = 1e-3;
  double size = 6.0;

  /// Log density over that of a standard normal, and the posterior probability of an outlier.
  struct At {
    double log_ratio;
    double posterior;
  };
  [[nodiscard]] At at(double z) const {
    const double wide = variance * (1.0 + size * size);
    const double good =
        std::log1p(-probability) - 0.5 * std::log(variance) - 0.5 * z * z / variance;
    const double bad = std::log(probability) - 0.5 * std::log(wide) - 0.5 * z * z / wide;
    const double larger = std::max(good, bad);
    const double sum = larger + std::log(std::exp(good - larger) + std::exp(bad - larger));
    return {sum + 0.5 * z * z, std::exp(bad - sum)};
  }
};

/// Deletion residuals: how far each value is from what all others let expect, in sigma. Of values
/// on coarse levels, what rounding cannot have done.
std::vector<double> deletion_residuals(const Hypothesis& hypothesis) {
  std::vector<double> residuals = hypothesis.precision_weighted_residual();
  const double root = std::sqrt(hypothesis.mean_precision());
  const double rounding = hypothesis.rounding_rad_s() * root;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    const double z = hypothesis.is_replaced()[k] ? 0.0 : residuals[k] / root;
    residuals[k] = std::copysign(std::max(0.0, std::abs(z) - rounding), z);
  }
  return residuals;
}

/// Counts and mean squares of |z|, so that fitting does not depend on the length of the record.
class Histogram {
 public:
  /// @param least_variance  of the noise
  /// @param is_replaced  values that were not measured, and do not count
  Histogram(const std::vector<double>& residuals, const std::vector<bool>& is_replaced,
            double least_variance)
      : least_variance_(least_variance), bins_(kBins) {
    for (std::size_t k = 0; k < residuals.size(); ++k) {
      if (is_replaced[k]) continue;
      const double z = residuals[k];
      const double place = std::min(std::abs(z) * kBinsPerSigma, double{kBins - 1});
      Bin& bin = bins_[static_cast<std::size_t>(place)];
      bin.count += 1.0;
      bin.squares += z * z;
    }
  }

  /// Expectation maximisation; the bounds keep the gain at 0 where there are no outliers.
  /// @param held  is not fitted
  [[nodiscard]] Mixture fit(Mixture mixture, double Mixture::*held = nullptr) const {
    for (int i = 0; i < 60; ++i) {
      double bad = 0.0;
      double bad_squares = 0.0;
      double total = 0.0;
      double good_squares = 0.0;
      for (const Bin& bin : bins_) {
        if (bin.count == 0.0) continue;
        const double posterior = mixture.at(std::sqrt(bin.squares / bin.count)).posterior;
        bad += posterior * bin.count;
        bad_squares += posterior * bin.squares;
        good_squares += (1.0 - posterior) * bin.squares;
        total += bin.count;
      }
      mixture.variance = std::max(least_variance_, good_squares / (total - bad));
      if (held != &Mixture::probability) {
        mixture.probability = std::clamp(bad / total, 1e-9, kMostProbable);
      }
      if (held != &Mixture::size) {
        const double size = std::sqrt(std::max(0.0, bad_squares / bad / mixture.variance - 1.0));
        mixture.size = std::max(size, kLeastSize);
      }
    }
    return mixture;
  }

  /// The ends of the 95 % interval of a figure of the mixture by its profile likelihood.
  struct Ends {
    double lo = 0.0;
    double hi = 0.0;
  };
  [[nodiscard]] Ends interval(const Mixture& best, double Mixture::*figure) const {
    const double least = gain(best) - statistics::kHalfChiSquared95;
    const auto end = [&](double factor) {
      constexpr int kBits = 6;
      double inside = 0.0;
      double outside = std::log(factor);
      const auto is_inside = [&](double log_ratio) {
        return gain(fit(beside(best, figure, log_ratio), figure)) >= least;
      };
      for (int i = 0; i < kBits && is_inside(outside); ++i) outside *= 2.0;
      for (int i = 0; i < kBits; ++i) {
        const double middle = 0.5 * (inside + outside);
        (is_inside(middle) ? inside : outside) = middle;
      }
      return best.*figure * std::exp(0.5 * (inside + outside));
    };
    return {end(0.7), end(1.4)};
  }

  static Mixture beside(Mixture mixture, double Mixture::*figure, double log_ratio) {
    mixture.*figure *= std::exp(log_ratio);
    return mixture;
  }

  /// Gain over one normal distribution of the best variance.
  [[nodiscard]] double gain(const Mixture& mixture) const {
    double squares = 0.0;
    double total = 0.0;
    double sum = 0.0;
    for (const Bin& bin : bins_) {
      if (bin.count == 0.0) continue;
      squares += bin.squares;
      total += bin.count;
      sum += bin.count * (mixture.at(std::sqrt(bin.squares / bin.count)).log_ratio) -
             0.5 * bin.squares;
    }
    const double variance = std::max(least_variance_, squares / total);
    return sum + 0.5 * total * std::log(variance) + 0.5 * squares / variance;
  }

 private:
  struct Bin {
    double count = 0.0;
    double squares = 0.0;
  };
  double least_variance_;
  std::vector<Bin> bins_;
};

/// Single wild samples. The part's shape: probability, size in sigma, sigma in rad/s, number of
/// plain outliers; the ends of the intervals of the first two, where they are worth naming.
class Outliers final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "outliers"; }

  /// Means over ticks of unequal numbers of samples have unequal variances.
  [[nodiscard]] std::string_view obstacle(const Hypothesis& without) const override {
    return without.data().series().is_ticks ? kUnevenSamples : std::string_view{};
  }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const auto size = static_cast<double>(fitted.hypothesis.data().size());
    std::vector<double> shape = fitted.part().shape;
    const double probability = shape[0];
    const double unit = shape[2] * kDegPerRad;
    const double sigma = shape[1] * unit;
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    shape.resize(8, kUnknown);
    // Those that are plain are at least so many. What the noise may hide is an extrapolation.
    const double plain = shape[3];
    const Parameter count{"count", std::max(plain, probability * size), plain, shape[5] * size};
    Description description{
        .parameters = {count,
                       {"probability", probability, shape[4], shape[5]},
                       {"sigma_dps", sigma, shape[6] * unit, shape[7] * unit}},
        .sentence = fmt::format("{} single samples are off by {:.2g} deg/s (rms), {:.3g} times the "
                                "noise of the others.",
                                in_words(count), sigma, shape[1])};
    description.drawing.effect = name();
    for (const Run& run : fitted.part().replaced) {
      const FitData& data = fitted.hypothesis.data();
      description.drawing.marks.push_back(
          {data.series().time_s(run.first), data.rate_rad_s()[run.first] + data.median_rad_s()});
    }
    return description;
  }

  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const std::vector<double>& shape = fitted.part().shape;
    model.outliers = model::Outliers{.probability = shape[0], .sigma_rad_s = shape[1] * shape[2]};
  }

 private:
  /// "8 to 14", or "About 11" where the interval is not worth naming.
  static std::string in_words(const Parameter& count) {
    return std::isnan(count.hi) ? fmt::format("About {:.0f}", count.value)
                                : fmt::format("{:.0f} to {:.0f}", count.lo, std::ceil(count.hi));
  }

  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    const std::vector<double> residuals = deletion_residuals(without);
    // The part that rounding may have done was taken away, so that nothing may be left of the
    // noise.
    const Histogram histogram(residuals, without.is_replaced(), without.is_coarse() ? 1.0 : 0.0);
    Mixture best;
    double best_gain = 0.0;
    for (const double size : {3.0, 10.0, 50.0}) {
      const Mixture mixture = histogram.fit({.size = size});
      const double gain = histogram.gain(mixture);
      if (gain <= best_gain) continue;
      best = mixture;
      best_gain = gain;
    }
    if (best_gain <= 0.0) return std::nullopt;
    const double sigma = std::sqrt(best.variance / without.mean_precision());
    std::vector<double> shape{best.probability, best.size, sigma, plain_outliers(best, residuals)};
    if (best_gain > kWorthAnInterval) {
      for (const auto figure : {&Mixture::probability, &Mixture::size}) {
        const auto [lo, hi] = histogram.interval(best, figure);
        shape.insert(shape.end(), {lo, hi});
      }
    }
    Candidate candidate{.part = {.effect = name(),
                                 .shape = std::move(shape),
                                 .replaced = replaced_by(best, residuals, without.data().seed())},
                        .gain_nats = best_gain};
    // Two parameters, searched over sizes; probability 0 lies at the edge.
    candidate.surprisal_nats = statistics::surprisal_of_search(best_gain, 2.0, 3.0);
    return candidate;
  }

  /// Number of the values of which hardly one in a hundred is noise.
  static double plain_outliers(const Mixture& mixture, const std::vector<double>& residuals) {
    constexpr double kPlain = 0.99;
    return static_cast<double>(std::ranges::count_if(
        residuals, [&](double residual) { return mixture.at(residual).posterior > kPlain; }));
  }

  /// Each value goes with the probability that it is an outlier, so that those which stay are
  /// normal, in the tails too.
  static std::vector<Run> replaced_by(const Mixture& mixture, const std::vector<double>& residuals,
                                      std::uint64_t seed) {
    const random::RandomStream stream = random::RandomStream(seed).substream("outliers");
    std::vector<Run> runs;
    for (std::size_t k = 0; k < residuals.size(); ++k) {
      const double posterior = mixture.at(residuals[k]).posterior;
      if (stream.uniform(static_cast<std::int64_t>(k)) < posterior) runs.push_back({k, k + 1});
    }
    return runs;
  }
};

}  // namespace

std::unique_ptr<Effect> make_outliers() {
  return std::make_unique<Outliers>();
}

}  // namespace zerorate::diagnose
