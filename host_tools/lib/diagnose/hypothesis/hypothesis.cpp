#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"
#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"
#include "host_tools/lib/diagnose/hypothesis/noise_density.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

constexpr int kMostRounds = 8;
constexpr double kSettled = 0.02;  // nats

std::vector<double> inverse_of(std::vector<double> density) {
  for (double& strength : density) strength = 1.0 / strength;
  return density;
}

}  // namespace

Hypothesis::Hypothesis(const FitData& data, std::vector<Part> parts, const Hypothesis* before)
    : data_(&data), parts_(std::move(parts)) {
  for (const Part& part : parts_) terms_ = terms_ | part.terms;
  mark_replaced();
  const bool is_as_before =
      before != nullptr && clipped() == before->clipped() &&
      (is_replaced_ == before->is_replaced_ || is_replaced() == before->is_replaced());
  if (is_as_before) {
    repaired_ = before->repaired_;
    coefficients_ = before->coefficients_;
  } else {
    repair_values();
  }
  fit(before);
}

Hypothesis::Hypothesis(const FitData& data, std::vector<Part> parts, std::vector<double> density)
    : data_(&data), parts_(std::move(parts)) {
  density[0] = std::numeric_limits<double>::infinity();
  given_density_ = std::make_shared<const std::vector<double>>(std::move(density));
  mark_replaced();
  repair_values();
  residual_ = coefficients_;
  if (!columns().empty()) {
    fit_amplitudes();
    const auto residual = std::make_shared<std::vector<double>>(*coefficients_);
    subtract_means(*residual);
    residual_ = residual;
  }
  noise_.log_likelihood = log_likelihood_of_coefficients();
}

void Hypothesis::repair_values() {
  repaired_ = std::make_shared<const std::vector<double>>(
      repair(data_->rate_rad_s(), is_replaced(), clipped(), data_->seed()));
  std::vector<double> coefficients = data_->transform().forward(*repaired_);
  coefficients[0] = 0.0;
  coefficients_ = std::make_shared<const std::vector<double>>(std::move(coefficients));
}

double Hypothesis::log_likelihood_of_coefficients() const {
  const std::vector<double>& density = this->density();
  statistics::SumOfLogs logs;
  double squares = 0.0;
  for (std::size_t k = 1; k < residual().size(); ++k) {
    logs.add(density[k]);
    squares += residual()[k] * residual()[k] / density[k];
  }
  return -0.5 * (logs.value() + squares);
}

std::size_t Hypothesis::first_amplitude(std::size_t part) const {
  std::size_t first = 0;
  for (std::size_t i = 0; i < part; ++i) first += parts_[i].columns.size();
  return first;
}

Range Hypothesis::clipped() const {
  Range range;
  for (const Part& part : parts_) {
    range = {std::max(range.lo, part.clipped.lo), std::min(range.hi, part.clipped.hi)};
  }
  return range;
}

void Hypothesis::mark_replaced() {
  is_replaced_ = data_->lost();
  if (std::ranges::all_of(parts_, [](const Part& part) { return part.replaced.empty(); })) return;
  std::vector<bool> is_replaced = *is_replaced_;
  for (const Part& part : parts_) {
    for (const Run& run : part.replaced) {
      for (std::size_t k = run.first; k < std::min(run.end, is_replaced.size()); ++k) {
        is_replaced[k] = true;
      }
    }
  }
  is_replaced_ = std::make_shared<const std::vector<bool>>(std::move(is_replaced));
}

Hypothesis Hypothesis::with(Part part) const {
  std::vector<Part> parts = parts_;
  parts.push_back(std::move(part));
  return {*data_, std::move(parts), this};
}

void Hypothesis::fit(const Hypothesis* before) {
  residual_ = coefficients_;
  std::vector<SpectralBin> bins = this->bins();
  std::vector<NoiseSpectrum> starts = this->starts(bins, before);
  const bool has_columns = !columns().empty();
  if (has_columns && before != nullptr) {
    noise_ = before->noise();
  } else {
    noise_ = fit_spectrum(bins, data_->size(), terms_, starts);
  }
  if (!has_columns) return;
  const auto residual = std::make_shared<std::vector<double>>(*coefficients_);
  residual_ = residual;
  double reached = -std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds; ++round) {
    fit_amplitudes();
    subtract_means(*residual);
    update_bins(bins, *residual, end_of_columns());
    if (round > 0) starts = {noise_.spectrum};
    noise_ = fit_spectrum(bins, data_->size(), terms_, starts);
    if (noise_.log_likelihood - reached < kSettled) break;
    reached = noise_.log_likelihood;
  }
}

/// Those of the parts and the noise before; the likeliest of them where that noise has the terms of
/// the fit. Where the fit does not know where to look for its terms, also what a rough look at the
/// record gives.
std::vector<NoiseSpectrum> Hypothesis::starts(std::span<const SpectralBin> bins,
                                              const Hypothesis* before) const {
  std::vector<NoiseSpectrum> starts;
  for (const Part& part : parts_) {
    starts.insert(starts.end(), part.starts.begin(), part.starts.end());
  }
  const bool are_given = starts.size() > 1;
  if (before != nullptr) starts.insert(starts.begin(), before->noise().spectrum);
  if (before != nullptr && before->terms() == terms_) {
    return {likeliest_of(starts, bins, data_->size())};
  }
  if (are_given) return starts;
  const NoiseSpectrum rough = rough_spectrum(bins);
  for (const double factor : {1.0, 1e-2}) {
    starts.push_back(rough);
    starts.back().flicker_variance *= factor;
  }
  return starts;
}

/// Fine around the line that a part looks for.
std::vector<SpectralBin> Hypothesis::bins() const {
  std::size_t line = 0;
  for (const Part& part : parts_) {
    if (!part.terms.line) continue;
    line = static_cast<std::size_t>(part.starts.front().line_angle / std::numbers::pi *
                                    static_cast<double>(data_->size()));
  }
  return bin_coefficients(*residual_, line);
}

std::vector<const Column*> Hypothesis::columns() const {
  std::vector<const Column*> columns;
  for (const Part& part : parts_) {
    for (const Column& column : part.columns) columns.push_back(&column);
  }
  return columns;
}

std::size_t Hypothesis::end_of_columns() const {
  std::size_t end = 0;
  for (const Column* column : columns()) end = std::max(end, column->end());
  return end;
}

void Hypothesis::fit_amplitudes() {
  const std::vector<const Column*> columns = this->columns();
  const std::vector<double> precision = inverse_of(density_below(end_of_columns()));
  NormalEquations equations;
  std::vector<double> with_record;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::vector<double> with_earlier;
    for (std::size_t j = 0; j < i; ++j) {
      with_earlier.push_back(inner(*columns[i], *columns[j], precision));
    }
    equations.add(with_earlier, inner(*columns[i], *columns[i], precision));
    with_record.push_back(inner(*columns[i], *coefficients_, precision));
  }
  amplitudes_ = equations.amplitudes(with_record);
  variances_ = equations.variances();
}

/// @param residual  above the end of the columns: the coefficients
void Hypothesis::subtract_means(std::vector<double>& residual) const {
  std::copy_n(coefficients_->begin(), end_of_columns(), residual.begin());
  const std::vector<const Column*> columns = this->columns();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Column& column = *columns[i];
    const double amplitude = amplitudes_[i];
    for (std::size_t k = column.first; k < column.end(); ++k) {
      residual[k] -= amplitude * column.coefficients[k - column.first];
    }
  }
}

std::vector<double> Hypothesis::density_below(std::size_t end) const {
  if (given_density_) {
    return {given_density_->begin(), given_density_->begin() + static_cast<std::ptrdiff_t>(end)};
  }
  return density_table(noise_.spectrum, data_->sines(), end);
}

const std::vector<double>& Hypothesis::density() const {
  if (given_density_) return *given_density_;
  return density_.get([&] { return density_below(data_->size()); });
}

const std::vector<double>& Hypothesis::precision() const {
  return precision_.get([&] { return inverse_of(density()); });
}

double Hypothesis::mean_precision() const {
  return mean_precision_.get([&] {
    return std::reduce(precision().begin(), precision().end()) / static_cast<double>(data_->size());
  });
}

const std::vector<double>& Hypothesis::whitened() const {
  return whitened_.get([&] {
    const std::vector<double>& density = this->density();
    std::vector<double> flat(residual().size());
    for (std::size_t k = 1; k < flat.size(); ++k) flat[k] = residual()[k] / std::sqrt(density[k]);
    return data_->transform().inverse(flat);
  });
}

std::vector<double> Hypothesis::precision_weighted(std::vector<double> coefficients) const {
  const std::vector<double>& precision = this->precision();
  for (std::size_t k = 0; k < coefficients.size(); ++k) coefficients[k] *= precision[k];
  return data_->transform().inverse(coefficients);
}

const std::vector<double>& Hypothesis::precision_weighted_residual() const {
  return precision_weighted_residual_.get([&] { return precision_weighted(residual()); });
}

bool Hypothesis::is_coarse() const {
  if (!data_->lattice()) return false;
  const double step = data_->lattice()->step * std::sqrt(mean_precision());
  // Rounding adds -step^4 / 120 to the fourth cumulant of values of unit variance. From 1.75 sigma
  // on the variance also depends on where between two levels the bias lies.
  constexpr double kChance = 1.2;  // standard deviations
  constexpr double kMost = 1.75;
  const double chance = std::sqrt(24.0 / static_cast<double>(data_->size()));
  return step > kMost || std::pow(step, 4.0) / 120.0 > kChance * chance;
}

Hypothesis::WhiteBandResidual Hypothesis::white_band_residual() const {
  const NoiseSpectrum& noise = noise_.spectrum;
  const std::vector<double>& density = this->density();
  std::vector<double> flat(residual().size());
  double kept = 0.0;
  for (std::size_t k = 1; k < flat.size(); ++k) {
    const double white =
        noise.low_pass_gain(data_->sines()[k]) * noise.white_variance + noise.rounding_variance;
    if (white < 0.5 * density[k]) continue;
    flat[k] = residual()[k] / std::sqrt(density[k]);
    kept += 1.0;
  }
  const double share = kept / static_cast<double>(flat.size());
  constexpr double kTooLittle = 0.1;
  if (share < kTooLittle) return {whitened(), 1.0};
  WhiteBandResidual fast{data_->transform().inverse(flat), share};
  for (double& value : fast.values) value /= std::sqrt(share);
  return fast;
}

StandardisedResidual::StandardisedResidual(const Hypothesis& of)
    : hypothesis(&of), values(of.whitened()) {
  for (const Part& part : of.parts()) {
    for (std::size_t k = 0; k < part.relative_sigma.size(); ++k) {
      values[k] /= double{part.relative_sigma[k]};
    }
  }
}

}  // namespace zerorate::diagnose
