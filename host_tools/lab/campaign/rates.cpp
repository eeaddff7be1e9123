#include "host_tools/lab/campaign/rates.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>

namespace zerorate::campaign {
namespace {

constexpr double kOnceInAThousand = 1e-3;

}  // namespace

double Rate::share() const {
  return runs == 0 ? 0.0 : static_cast<double>(hits) / static_cast<double>(runs);
}

double Rate::lo95() const {
  if (hits == 0) return 0.0;
  return boost::math::quantile(
      boost::math::beta_distribution<>(static_cast<double>(hits),
                                       static_cast<double>(runs - hits) + 1.0),
      0.025);
}

double Rate::hi95() const {
  if (hits == runs) return 1.0;
  return boost::math::quantile(boost::math::beta_distribution<>(static_cast<double>(hits) + 1.0,
                                                                static_cast<double>(runs - hits)),
                               0.975);
}

bool is_surely_below(const Rate& rate, double p) {
  const boost::math::binomial_distribution<> hits(static_cast<double>(rate.runs), p);
  return boost::math::cdf(hits, static_cast<double>(rate.hits)) < kOnceInAThousand;
}

bool is_surely_above(const Rate& rate, double p) {
  if (rate.hits == 0) return false;
  const boost::math::binomial_distribution<> hits(static_cast<double>(rate.runs), p);
  return boost::math::cdf(boost::math::complement(hits, static_cast<double>(rate.hits) - 1.0)) <
         kOnceInAThousand;
}

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

void Reliability::count(double probability, bool right) {
  const auto last = static_cast<double>(bins_.size() - 1);
  Bin& bin = bins_[static_cast<std::size_t>(std::clamp(probability * 10.0, 0.0, last))];
  bin.stated += probability;
  bin.right.count(right);
}

std::size_t Reliability::size() const {
  std::size_t all = 0;
  for (const Bin& bin : bins_) all += bin.right.runs;
  return all;
}

double Reliability::expected_calibration_error() const {
  double sum = 0.0;
  for (const Bin& bin : bins_) sum += std::abs(bin.stated - static_cast<double>(bin.right.hits));
  return sum / static_cast<double>(std::max<std::size_t>(1, size()));
}

std::string Reliability::markdown() const {
  std::string text =
      "| stated | causes | mean stated | right | share, 95 % interval |\n|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    const Bin& bin = bins_[i];
    if (bin.right.runs == 0) continue;
    text +=
        fmt::format("| {:.1f} to {:.1f} | {} | {:.3f} | {} ({:.3f}) | {} to {} |\n",
                    0.1 * static_cast<double>(i), 0.1 * static_cast<double>(i + 1), bin.right.runs,
                    bin.stated / static_cast<double>(bin.right.runs), bin.right.hits,
                    bin.right.share(), percent(bin.right.lo95()), percent(bin.right.hi95()));
  }
  return text;
}

}  // namespace zerorate::campaign
