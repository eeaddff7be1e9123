#include "host_tools/lib/diagnose/hypothesis/noise_density.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_tools/lib/diagnose/hypothesis/spectrum_fit.hpp"
#include "host_tools/lib/identify/whittle.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::diagnose {
namespace {

/// identify::dct_power_ratios by interpolation in the order.
class RatioTable {
 public:
  static const RatioTable& get() {
    static const RatioTable table;
    return table;
  }
  [[nodiscard]] double operator()(double order, std::size_t index) const {
    if (index == 0 || index > identify::kDctRatios) return 1.0;
    const double at = std::clamp(order, 0.0, 1.0) * kSteps;
    const std::size_t low = std::min(static_cast<std::size_t>(at), kSteps - 1);
    const double share = at - static_cast<double>(low);
    return (1.0 - share) * ratios_[low][index - 1] + share * ratios_[low + 1][index - 1];
  }

 private:
  static constexpr std::size_t kSteps = 20;
  RatioTable() {
    for (std::size_t i = 0; i <= kSteps; ++i) {
      ratios_[i] = identify::dct_power_ratios(static_cast<double>(i) / static_cast<double>(kSteps));
    }
  }
  std::array<std::array<double, identify::kDctRatios>, kSteps + 1> ratios_{};
};

/// Ratio for the covariance exp(-a u), a the record in time constants: the double integral of
/// 2 cos(p u) exp(-a |u - v|) cos(p v), p = pi k, over its nominal value.
double markov_ratio(double record_in_time_constants, std::size_t index) {
  const double a = record_in_time_constants;
  const double p = std::numbers::pi * static_cast<double>(index);
  const double rest = index % 2 == 0 ? std::exp(-a) : -std::exp(-a);
  return 1.0 - 2.0 * a * (1.0 - rest) / (a * a + p * p);
}

/// A power of a small exponent.
double power(double base, int exponent) {
  double product = 1.0;
  for (int i = 0; i < exponent; ++i) product *= base;
  return product;
}

}  // namespace

AngularBand::AngularBand(double centre, double whole_width)
    : half_centre(std::polar(1.0, 0.5 * centre)),
      quarter_width(std::polar(1.0, 0.25 * whole_width)),
      width(whole_width) {}

SpectralPlace::SpectralPlace(double at, std::size_t of, std::size_t in, double count, bool has_line)
    : sine(at), log_sine(std::log(at)), index(of), size(in) {
  if (!has_line) return;
  band.emplace(2.0 * std::asin(std::min(0.5 * at, 1.0)),
               std::numbers::pi * count / static_cast<double>(in));
}

LineSide::LineSide(double coth, std::complex<double> half_distance, const AngularBand& band)
    : coth_(coth),
      width_(band.width),
      sine_of_half_width_(2.0 * band.quarter_width.real() * band.quarter_width.imag()),
      lo_(spectrum::product(half_distance, std::conj(band.quarter_width))),
      hi_(spectrum::product(half_distance, band.quarter_width)) {}

double LineSide::mean() const {
  const double along = lo_.real() * hi_.real();
  const double across = lo_.imag() * hi_.imag();
  return 2.0 * std::atan2(coth_ * sine_of_half_width_, along + coth_ * coth_ * across) / width_;
}

double LineSide::slope_of_distance(double sinh, double cosh) const {
  const auto kernel = [&](std::complex<double> half) {
    return sinh / (cosh - 1.0 + 2.0 * half.imag() * half.imag());
  };
  return (kernel(hi_) - kernel(lo_)) / width_;
}

double LineSide::slope_of_log_coherence(double decay) const {
  return decay * 0.5 * (coth_ * coth_ - 1.0) * (slope_of_coth(hi_) - slope_of_coth(lo_)) / width_;
}

/// d integral / d coth.
double LineSide::slope_of_coth(std::complex<double> half) const {
  const double cosine = half.real();
  const double sine = half.imag();
  return 2.0 * sine * cosine / (cosine * cosine + coth_ * coth_ * sine * sine);
}

DensityFactors::DensityFactors(const NoiseSpectrum& spectrum) : spectrum_(&spectrum) {
  if (spectrum.markov_variance > 0.0) {
    markov_phi_ = std::exp(-1.0 / spectrum.markov_samples);
    markov_lost_ = -std::expm1(-1.0 / spectrum.markov_samples);
  }
  if (spectrum.line_variance > 0.0) {
    line_decay_ = 1.0 / spectrum.line_samples;
    line_coth_ = 1.0 / std::tanh(0.5 * line_decay_);
    line_sinh_ = std::sinh(line_decay_);
    line_cosh_ = std::cosh(line_decay_);
    half_line_angle_ = std::polar(1.0, 0.5 * spectrum.line_angle);
  }
  if (spectrum.filter_order > 0) {
    cut_off_ = std::tan(0.5 * std::numbers::pi * spectrum.low_pass_share);
  }
}

NoiseDensity::NoiseDensity(const DensityFactors& factors, const SpectralPlace& place)
    : factors_(&factors), place_(&place) {
  const NoiseSpectrum& spectrum = factors.spectrum();
  const double d = spectrum.flicker_order;
  white_ = spectrum.white_variance;
  flicker_ = spectrum.flicker_variance * std::exp(-2.0 * d * place.log_sine);
  if (place.index > 0) flicker_ *= RatioTable::get()(d, place.index);
  walk_ = spectrum.walk_variance / (place.sine * place.sine);
  if (spectrum.markov_variance > 0.0) add_markov();
  if (spectrum.line_variance > 0.0) {
    line_sides_ = factors.line_sides(*place.band);
    line_ = spectrum.line_variance * line_sides_->mean();
  }
  pass_ = factors.low_pass_gain(place.sine);
}

void NoiseDensity::derivatives(const NoiseTerms& terms, NoiseSlopes& slopes) const {
  using enum NoiseParameterId;
  const NoiseSpectrum& spectrum = factors_->spectrum();
  const double share = pass_ / total();
  const auto slope = [&](NoiseParameterId id) -> double& {
    return slopes[static_cast<std::size_t>(id)];
  };
  slope(white_variance) = white_ * share;
  slope(flicker_variance) = flicker_ * share;
  if (terms.free_order) slope(flicker_order) = -2.0 * place_->log_sine * flicker_ * share;
  if (terms.random_walk) slope(walk_variance) = walk_ * share;
  if (terms.gauss_markov) {
    slope(markov_variance) = markov_ * share;
    slope(markov_samples) = markov_ * markov_slope_ * share;
  }
  if (terms.line) {
    const double a = spectrum.line_angle;
    const double decay = factors_->line_decay_;
    const double sinh = factors_->line_sinh_;
    const double cosh = factors_->line_cosh_;
    const auto& [below, above] = *line_sides_;
    const double unit = 0.5 * spectrum.line_variance / total();
    slope(line_variance) = line_ / total();
    slope(line_angle) =
        unit * (above.slope_of_distance(sinh, cosh) - below.slope_of_distance(sinh, cosh)) * a *
        (1.0 - a / std::numbers::pi);
    slope(line_samples) =
        unit * (above.slope_of_log_coherence(decay) + below.slope_of_log_coherence(decay));
  }
  if (terms.low_pass) slope(low_pass_share) = low_pass_slope() * inner() * share;
}

/// d log H / d logit a.
double NoiseDensity::low_pass_slope() const {
  const NoiseSpectrum& spectrum = factors_->spectrum();
  const double a = spectrum.low_pass_share;
  if (spectrum.filter_order > 0) {
    return (1.0 - pass_) * 2.0 * spectrum.filter_order * std::numbers::pi * a * (1.0 - a) /
           std::sin(std::numbers::pi * a);
  }
  const double square = place_->sine * place_->sine;
  if (spectrum.filter_order == NoiseSpectrum::kTwoNeighbours) {
    return 0.25 * square * a * (1.0 - a) / pass_;
  }
  return (1.0 - a) * (2.0 - a * (2.0 * a - square) / (a * a + (1.0 - a) * square));
}

void NoiseDensity::add_markov() {
  const double sine = place_->sine;
  const double tau = factors_->spectrum().markov_samples;
  const double phi = factors_->markov_phi_;
  const double lost = factors_->markov_lost_;
  const double bottom = lost * lost + phi * sine * sine;
  const double top = lost * (1.0 + phi);
  markov_ = factors_->spectrum().markov_variance * top / bottom;
  if (place_->index > 0) {
    markov_ *= markov_ratio(static_cast<double>(place_->size) / tau, place_->index);
  }
  // d log / d phi, times d phi / d log tau = phi / tau.
  markov_slope_ = (-2.0 * phi / top + (2.0 * lost - sine * sine) / bottom) * phi / tau;
}

double DensityFactors::low_pass_gain(double sine) const {
  const int order = spectrum_->filter_order;
  const double a = spectrum_->low_pass_share;
  const double square = sine * sine;
  if (a >= 1.0) return 1.0;
  if (order == NoiseSpectrum::kTwoNeighbours) return 1.0 - 0.25 * (1.0 - a) * square;
  if (order == NoiseSpectrum::kRecursive) return a * a / (a * a + (1.0 - a) * square);
  const double ratio = square / (std::max(4.0 - square, 1e-300) * cut_off_ * cut_off_);
  return 1.0 / (1.0 + power(ratio, order));
}

LineSides DensityFactors::line_sides(const AngularBand& band) const {
  const auto side = [&](std::complex<double> half_line_angle) {
    return LineSide(line_coth_, spectrum::product(band.half_centre, half_line_angle), band);
  };
  return {side(std::conj(half_line_angle_)), side(half_line_angle_)};
}

double DensityFactors::density(double sine, std::size_t index, std::size_t size) const {
  const bool has_line = spectrum_->line_variance > 0.0;
  const SpectralPlace place(sine, index <= kSingleBins ? index : 0, size, 1.0, has_line);
  return NoiseDensity(*this, place).total();
}

NoiseSpectrum NoiseSpectrum::of_single_values(double count) const {
  NoiseSpectrum values = *this;
  values.white_variance *= count;
  values.flicker_variance *= std::pow(count, 1.0 - 2.0 * flicker_order);
  values.walk_variance /= count;
  values.markov_samples *= count;
  values.line_angle /= count;
  values.line_samples *= count;
  return values;
}

double NoiseSpectrum::low_pass_gain(double sine) const {
  return DensityFactors(*this).low_pass_gain(sine);
}

double NoiseSpectrum::line_density(double angle, double width) const {
  return line_variance * DensityFactors(*this).line_sides({angle, width}).mean();
}

double NoiseSpectrum::density(double sine, std::size_t index, std::size_t size) const {
  return DensityFactors(*this).density(sine, index, size);
}

namespace {

/// Nodes in each octave: a line is narrow.
std::size_t nodes_for(const NoiseSpectrum& spectrum) {
  return spectrum.line_variance > 0.0 ? 2048 : 256;
}

}  // namespace

std::vector<double> density_table(const NoiseSpectrum& spectrum, std::span<const double> sines,
                                  std::size_t end) {
  const std::size_t n = sines.size();
  const DensityFactors factors(spectrum);
  const std::size_t nodes = nodes_for(spectrum);
  const auto at = [&](std::size_t k) { return factors.density(sines[k], k, n); };
  std::vector<double> density(end);
  if (end == 0) return density;
  density[0] = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < std::min(end, 2 * nodes); ++k) density[k] = at(k);
  for (std::size_t first = 2 * nodes; first < end;) {
    const std::size_t next = std::min(first + first / nodes, n - 1);
    const double start = at(first);
    const double rise = next > first ? (at(next) - start) / static_cast<double>(next - first) : 0.0;
    const std::size_t last = std::min(next > first ? next : first + 1, end);
    for (std::size_t k = first; k < last; ++k) {
      density[k] = start + rise * static_cast<double>(k - first);
    }
    first = last;
  }
  return density;
}

}  // namespace zerorate::diagnose
