#include "host_tools/lib/diagnose/drive/drive_selection.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "host_tools/lib/diagnose/drive/drive_diagnosis.hpp"

namespace zerorate::diagnose {
namespace {

/// Log of the likelihood over the prior of the last coefficients, over their greatest likelihood.
double occam_nats(const DriveFit& fit, const Eigen::VectorXd& prior_sigma) {
  const Eigen::Index count = prior_sigma.size();
  if (count == 0) return 0.0;
  const Eigen::MatrixXd own = fit.covariance.bottomRightCorner(count, count);
  const Eigen::VectorXd coefficients = fit.coefficients.tail(count);
  const Eigen::MatrixXd prior = prior_sigma.array().square().matrix().asDiagonal();
  const Eigen::MatrixXd both = own + prior;
  const double ratio = both.determinant() / own.determinant();
  if (!(own.determinant() > 0.0) || !(ratio > 0.0)) {
    return -std::numeric_limits<double>::infinity();  // the other columns describe them
  }
  return -0.5 * std::log(ratio) - 0.5 * coefficients.dot(both.inverse() * coefficients);
}

/// Log likelihood that a variant gains: by the errors of the heading and by what is measured beside
/// them, unless the errors contradict it.
double joint_gain(double by_errors_nats, const Variant& variant) {
  return by_errors_nats > -kAlternativeNats ? by_errors_nats + variant.own_nats : by_errors_nats;
}

/// log P of a gain by chance, with its sign turned.
/// @param variants that the fit has last and that gained it
double surprisal_of(std::span<const Variant> variants, double gain_nats,
                    const DriveRegression& regression, const DriveFit& fit) {
  Eigen::Index columns = 0;
  double share = 0.0;  // part of the information that the drives have
  for (const Variant& variant : variants) columns += variant.share.columns.cols();
  if (columns > 0) {
    share = fit.share_of_drives.tail(columns).mean();
  } else {
    share = regression.share_of_drives(variants.front().share.known, fit);
  }
  return surprisal_of_drives(gain_nats,
                             static_cast<std::size_t>(std::max<Eigen::Index>(1, columns)),
                             fit.freedom(share), fit.size(share));
}

}  // namespace

Share picked(const Share& share, const std::vector<std::size_t>& rows) {
  return {.columns = picked_rows(share.columns, rows), .known = picked_rows(share.known, rows)};
}

Share joint_share(const std::vector<MotionChoice>& choices, const DriveRecord& record) {
  const auto rows = static_cast<Eigen::Index>(record.rows());
  Share joint{.columns = Eigen::MatrixXd(rows, 0), .known = Eigen::VectorXd::Zero(rows)};
  for (const MotionChoice& choice : choices) {
    const Share& share = choice.variant.share;
    joint.known += share.known;
    const Eigen::Index before = joint.columns.cols();
    joint.columns.conservativeResize(Eigen::NoChange, before + share.columns.cols());
    if (share.columns.cols() > 0) joint.columns.rightCols(share.columns.cols()) = share.columns;
  }
  return joint;
}

std::vector<MotionChoice> without(const std::vector<MotionChoice>& choices, std::size_t left_out) {
  std::vector<MotionChoice> others = choices;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
  return others;
}

MotionSelection::MotionSelection(const DriveRecord& record,
                                 std::span<const std::unique_ptr<MotionEffect>> effects)
    : record_(record), effects_(static_cast<double>(effects.size())), regression_(record) {
  for (const auto& effect : effects) {
    if (effect->obstacle(record).empty()) {
      candidates_.push_back({effect.get(), effect->variants(record)});
    }
  }
}

const std::vector<Variant>& MotionSelection::variants_of(const MotionEffect& effect) const {
  return std::ranges::find(candidates_, &effect, &Candidate::effect)->variants;
}

DriveFit MotionSelection::fit(const std::vector<MotionChoice>& choices) const {
  return regression_.fit(joint_share(choices, record_));
}

MotionChoice MotionSelection::weighed(const MotionEffect& effect, const Variant& variant,
                                      const std::vector<MotionChoice>& others) const {
  MotionChoice choice{.effect = &effect, .variant = variant};
  std::vector<MotionChoice> all = others;
  all.push_back(choice);
  const DriveFit with = fit(all);
  choice.gain_nats = joint_gain(DriveRegression::gain(fit(others), with), variant);
  const double surprisal = surprisal_of({&variant, 1}, choice.gain_nats, regression_, with);
  choice.surprisal_nats =
      std::max(0.0, surprisal - std::log(static_cast<double>(variants_of(effect).size())));
  choice.evidence_nats = choice.gain_nats + occam_nats(with, variant.prior_sigma);
  return choice;
}

std::vector<MotionChoice> MotionSelection::examine(const std::vector<MotionChoice>& chosen) const {
  std::vector<MotionChoice> examined;
  for (const Candidate& candidate : candidates_) {
    if (std::ranges::find(chosen, candidate.effect, &MotionChoice::effect) != chosen.end())
      continue;
    std::optional<MotionChoice> best;
    for (const Variant& variant : candidate.variants) {
      MotionChoice choice = weighed(*candidate.effect, variant, chosen);
      if (!best || choice.evidence_nats > best->evidence_nats) best = std::move(choice);
    }
    if (best) examined.push_back(std::move(*best));
  }
  std::ranges::stable_sort(examined, std::greater{}, &MotionChoice::evidence_nats);
  return examined;
}

bool MotionSelection::rests_on_many_drives(const MotionChoice& choice,
                                           const std::vector<MotionChoice>& others) const {
  std::vector<MotionChoice> all = others;
  all.push_back(choice);
  const Share with = joint_share(all, record_);
  const Share without = joint_share(others, record_);
  for (std::size_t left_out = 0; left_out < record_.size(); ++left_out) {
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < record_.size(); ++k) {
      if (k != left_out) places.push_back(k);
    }
    const std::vector<std::size_t> rows = record_.rows_of(places);
    const DriveRegression regression{picked(record_, places)};
    const DriveFit fit = regression.fit(picked(with, rows));
    const double gain = joint_gain(
        DriveRegression::gain(regression.fit(picked(without, rows)), fit), choice.variant);
    Variant variant = choice.variant;
    variant.share = picked(variant.share, rows);
    if (surprisal_of({&variant, 1}, gain, regression, fit) < 0.5 * kDriveThreshold_nats) {
      return false;
    }
  }
  return true;
}

void MotionSelection::grow(const MotionSet& set, std::size_t first,
                           std::vector<MotionSet>& sets) const {
  if (set.choices.size() == kMostCauses) return;
  for (std::size_t i = first; i < candidates_.size(); ++i) {
    for (const Variant& variant : candidates_[i].variants) {
      MotionSet larger = set;
      larger.choices.push_back(weighed(*candidates_[i].effect, variant, set.choices));
      larger.evidence_nats += larger.choices.back().evidence_nats;
      grow(larger, i + 1, sets);
      sets.push_back(std::move(larger));
    }
  }
}

std::vector<MotionChoice> MotionSelection::weighed_together(
    const std::vector<MotionChoice>& set) const {
  std::vector<MotionChoice> together;
  for (std::size_t i = 0; i < set.size(); ++i) {
    together.push_back(weighed(*set[i].effect, set[i].variant, without(set, i)));
  }
  return together;
}

bool MotionSelection::is_plain(const MotionChoice& choice,
                               const std::vector<MotionChoice>& others) const {
  return choice.surprisal_nats >= kDriveThreshold_nats && choice.evidence_nats > 0.0 &&
         rests_on_many_drives(choice, others);
}

double MotionSelection::surprisal_of_pair(const MotionChoice& one, const MotionChoice& other,
                                          const std::vector<MotionChoice>& others) const {
  std::vector<MotionChoice> all = others;
  all.push_back(one);
  all.push_back(other);
  const DriveFit with = fit(all);
  const double gain =
      joint_gain(joint_gain(DriveRegression::gain(fit(others), with), one.variant), other.variant);
  const std::array both{one.variant, other.variant};
  return surprisal_of(both, gain, regression_, with) - std::log(0.5 * effects_ * (effects_ - 1.0));
}

bool MotionSelection::is_reached(const std::vector<MotionChoice>& set) const {
  if (set.empty()) return true;
  const std::vector<MotionChoice> together = weighed_together(set);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const std::vector<MotionChoice> others = without(set, i);
    if (together[i].surprisal_nats >= kDriveThreshold_nats && is_reached(others)) return true;
    for (std::size_t j = 0; j < i; ++j) {
      const std::vector<MotionChoice> rest = without(others, j);
      if (surprisal_of_pair(set[i], set[j], rest) >= kDriveThreshold_nats && is_reached(rest)) {
        return true;
      }
    }
  }
  return false;
}

std::vector<MotionChoice> MotionSelection::choose() const {
  std::vector<MotionSet> sets;
  grow({}, 0, sets);
  std::ranges::stable_sort(sets, std::greater{}, &MotionSet::evidence_nats);
  for (const MotionSet& set : sets) {
    if (!(set.evidence_nats > 0.0)) break;
    std::vector<MotionChoice> chosen = weighed_together(set.choices);
    const auto is_plain_beside = [&](const MotionChoice& choice) {
      const auto place = static_cast<std::size_t>(&choice - chosen.data());
      return is_plain(choice, without(chosen, place));
    };
    if (!std::ranges::all_of(chosen, is_plain_beside) || !is_reached(chosen)) continue;
    std::ranges::stable_sort(chosen, std::greater{}, &MotionChoice::gain_nats);
    return chosen;
  }
  return {};
}

}  // namespace zerorate::diagnose
