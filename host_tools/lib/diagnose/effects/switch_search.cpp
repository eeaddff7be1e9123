#include "host_tools/lib/diagnose/effects/switch_search.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kPlaces = 200;        // at which new switches are tried, then moved
constexpr std::size_t kMostSwitches = 128;  // more are left to the Viterbi search

/// +1 where a path goes up, if it begins below.
double sign_of(std::size_t i) {
  return i % 2 == 0 ? 1.0 : -1.0;
}

}  // namespace

double price_of_switches(std::size_t count, std::size_t size, double white_over_square) {
  if (count == 0) return 0.0;
  const auto k = static_cast<double>(count);
  const double stay = static_cast<double>(size) / k;
  const double unknown_places = std::min(4.0 * white_over_square, 0.25 * stay);
  return k * (std::log(stay) + 1.0 - std::log1p(unknown_places));
}

SwitchSearch::SwitchSearch(const spectrum::CosineTransform& transform,
                           std::span<const double> coefficients, std::span<const double> density,
                           double white_variance)
    : record_(coefficients.size() + 1), white_variance_(white_variance) {
  const std::size_t n = coefficients.size();
  std::vector<double> weighted(n);
  std::vector<double> strength(n);
  std::vector<double> along(n);  // strength times the cosine and the sine of half a bin's turn
  std::vector<double> across(n);
  for (std::size_t k = 1; k < n; ++k) {
    const double turn = std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    const double sine = 2.0 * std::sin(0.5 * turn);
    weighted[k] = coefficients[k] / density[k];
    strength[k] = 1.0 / (static_cast<double>(n) * sine * sine * density[k]);
    along[k] = strength[k] * (1.0 - 0.5 * sine * sine);
    across[k] = strength[k] * sine * std::sqrt(1.0 - 0.25 * sine * sine);
  }
  weighted = transform.inverse(weighted);
  for (std::size_t j = n; j-- > 0;) record_[j] = record_[j + 1] + weighted[j];
  // Steps before a and b: sum of 2/n sin(pi k a/n) sin(pi k b/n) / (s_k^2 S_k). At even distances
  // the cosines of the sum are those of a Fourier transform, at odd ones half a bin beside.
  const spectrum::RealFft& fft = transform.fourier();
  const auto bins_of = [&](const std::vector<double>& values) {
    std::vector<std::complex<double>> bins(fft.bins());
    fft.forward(values, bins);
    return bins;
  };
  const auto even = bins_of(strength);
  const auto odd_along = bins_of(along);
  const auto odd_across = bins_of(across);
  distance_.resize(2 * n + 1);
  for (std::size_t m = 0; m <= n; ++m) {
    const std::size_t j = m / 2;
    distance_[m] = m % 2 == 0 ? even[j].real() : odd_along[j].real() + odd_across[j].imag();
    distance_[2 * n - m] = distance_[m];
  }
}

double SwitchSearch::product(std::size_t a, std::size_t b) const {
  return distance_[a > b ? a - b : b - a] - distance_[a + b];
}

double SwitchSearch::product(const Switches& path, std::size_t step) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) sum += sign_of(i) * product(path[i], step);
  return sum;
}

SwitchSearch::Products SwitchSearch::products(const Switches& path) const {
  Products all;
  for (std::size_t i = 0; i < path.size(); ++i) {
    all.record += sign_of(i) * record_[path[i]];
    all.itself += sign_of(i) * product(path, path[i]);
  }
  return all;
}

double SwitchSearch::score(const Products& products, std::size_t count) const {
  if (count == 0) return 0.0;
  if (!(products.itself > 0.0)) return -std::numeric_limits<double>::infinity();
  const double height = products.record / products.itself;
  const double gain = 0.5 * products.record * height;
  return gain - price_of_switches(count, size(), white_variance_ / (height * height));
}

/// The other level in [first, end) of a stay, or from one end of the record on.
SwitchSearch::Move SwitchSearch::best_addition(const Switches& path) const {
  const Products now = products(path);
  const std::size_t n = size();
  Move best{-std::numeric_limits<double>::infinity(), {}};
  std::size_t at_first = 0;
  std::size_t at_end = 0;
  std::vector<double> beside;
  std::vector<std::size_t> places;
  for (std::size_t stay = 0; stay <= path.size(); ++stay) {
    const std::size_t from = stay == 0 ? 0 : path[stay - 1] + 1;
    const std::size_t to = stay == path.size() ? n : path[stay];
    const double sign = sign_of(stay);
    places.clear();
    beside.clear();
    for (std::size_t i = 1; i < kPlaces; ++i) {
      const std::size_t place = i * n / kPlaces;
      if (place < from || place >= to) continue;
      places.push_back(place);
      beside.push_back(product(path, place));
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      const std::size_t first = places[i];
      const double own = product(first, first);
      const auto keep = [&](const Products& sums, std::size_t count, std::size_t end) {
        const double reached = score(sums, count);
        if (reached <= best.score) return;
        best.score = reached;
        at_first = first;
        at_end = end;
      };
      if (stay == path.size()) {
        keep({now.record + sign * record_[first], now.itself + 2.0 * sign * beside[i] + own},
             path.size() + 1, n);
      }
      if (stay == 0 && !path.empty()) {
        keep({record_[first] - now.record, own - 2.0 * beside[i] + now.itself}, path.size() + 1, 0);
      }
      for (std::size_t j = i + 1; j < places.size(); ++j) {
        const std::size_t end = places[j];
        keep({now.record + sign * (record_[first] - record_[end]),
              now.itself + 2.0 * sign * (beside[i] - beside[j]) + own + product(end, end) -
                  2.0 * product(first, end)},
             path.size() + 2, end);
      }
    }
  }
  best.path = path;
  best.path.push_back(at_first);
  if (at_end != 0 && at_end != n) best.path.push_back(at_end);
  std::ranges::sort(best.path);
  if (!std::isfinite(best.score)) best.path = path;
  return best;
}

/// Without two neighbours, or without the first or the last one.
SwitchSearch::Move SwitchSearch::best_removal(const Switches& path) const {
  Move best{-std::numeric_limits<double>::infinity(), {}};
  const auto without = [&](std::size_t first, std::size_t end) {
    Switches fewer = path;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(first),
                fewer.begin() + static_cast<std::ptrdiff_t>(end));
    const double reached = score(fewer);
    if (reached > best.score) best = {reached, std::move(fewer)};
  };
  if (path.empty()) return best;
  without(0, 1);
  without(path.size() - 1, path.size());
  for (std::size_t i = 0; i + 1 < path.size(); ++i) without(i, i + 2);
  return best;
}

void SwitchSearch::settle(Switches& path) const {
  Products now = products(path);
  for (std::size_t step = size() / kPlaces; step > 0; step /= 2) {
    for (std::size_t i = 0; i < path.size(); ++i) {
      const std::size_t lowest = i == 0 ? 1 : path[i - 1] + 1;
      const std::size_t highest = i + 1 == path.size() ? size() - 1 : path[i + 1] - 1;
      const double sign = sign_of(i);
      const std::size_t old = path[i];
      const double beside_old = product(path, old);
      const double reached = score(now, path.size());
      for (const std::size_t place : {old - std::min(step, old), old + step}) {
        if (place < lowest || place > highest) continue;
        const double change = product(place, place) + product(old, old) - 2.0 * product(place, old);
        const Products moved{
            now.record + sign * (record_[place] - record_[old]),
            now.itself + 2.0 * sign * (product(path, place) - beside_old) + change};
        if (score(moved, path.size()) <= reached) continue;
        path[i] = place;
        now = moved;
        break;
      }
    }
  }
}

Switches SwitchSearch::improve(Switches path) const {
  settle(path);
  double reached = score(path);
  while (path.size() < kMostSwitches) {
    Move best = best_addition(path);
    Move removal = best_removal(path);
    if (removal.score > best.score) best = std::move(removal);
    settle(best.path);
    best.score = score(best.path);
    if (best.score <= reached) break;
    path = std::move(best.path);
    reached = best.score;
  }
  return path;
}

}  // namespace zerorate::diagnose
