#include "host_tools/lib/diagnose/drive/drive_selection.hpp"

#include <Eigen/LU>
#include <algorithm>
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

Eigen::MatrixXd rows_of(const Eigen::MatrixXd& matrix, const std::vector<std::size_t>& places) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(places.size()), matrix.cols());
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      rows(static_cast<Eigen::Index>(i), column) =
          matrix(static_cast<Eigen::Index>(places[i]), column);
    }
  }
  return rows;
}

}  // namespace

DriveRecord picked(const DriveRecord& record, const std::vector<std::size_t>& places) {
  DriveRecord some = record;
  some.drives.clear();
  some.number.clear();
  for (const std::size_t place : places) {
    some.drives.push_back(record.drives[place]);
    some.number.push_back(record.number[place]);
  }
  some.bias_rad2 = rows_of(rows_of(record.bias_rad2, places).transpose(), places);
  return some;
}

Share picked(const Share& share, const std::vector<std::size_t>& places) {
  return {.columns = rows_of(share.columns, places), .known = rows_of(share.known, places)};
}

Share joint_share(const std::vector<MotionChoice>& choices, std::size_t drives) {
  const auto rows = static_cast<Eigen::Index>(drives);
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
    : record_(record), effects_(effects), regression_(record) {}

DriveFit MotionSelection::fit(const std::vector<MotionChoice>& choices) const {
  return regression_.fit(joint_share(choices, record_.size()));
}

MotionChoice MotionSelection::weighed(const MotionEffect& effect, const Variant& variant,
                                      std::size_t variants,
                                      const std::vector<MotionChoice>& others) const {
  MotionChoice choice{.effect = &effect, .variant = variant};
  std::vector<MotionChoice> all = others;
  all.push_back(choice);
  const DriveFit with = fit(all);
  choice.gain_nats = regression_.gain(fit(others), with);
  const auto parameters =
      std::max<std::size_t>(1, static_cast<std::size_t>(variant.prior_sigma.size()));
  const double surprisal =
      surprisal_of_drives(choice.gain_nats, parameters, with.freedom, record_.size());
  choice.surprisal_nats = std::max(0.0, surprisal - std::log(static_cast<double>(variants)));
  choice.evidence_nats = choice.gain_nats + occam_nats(with, variant.prior_sigma);
  return choice;
}

std::vector<MotionChoice> MotionSelection::examine(const std::vector<MotionChoice>& chosen) const {
  std::vector<MotionChoice> examined;
  for (const auto& effect : effects_) {
    const bool is_chosen =
        std::ranges::find(chosen, effect.get(), &MotionChoice::effect) != chosen.end();
    if (is_chosen || !effect->obstacle(record_).empty()) continue;
    const std::vector<Variant> variants = effect->variants(record_);
    std::optional<MotionChoice> best;
    for (const Variant& variant : variants) {
      MotionChoice choice = weighed(*effect, variant, variants.size(), chosen);
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
  const Share with = joint_share(all, record_.size());
  const Share without = joint_share(others, record_.size());
  for (std::size_t left_out = 0; left_out < record_.size(); ++left_out) {
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < record_.size(); ++k) {
      if (k != left_out) places.push_back(k);
    }
    const DriveRegression regression{picked(record_, places)};
    const DriveFit fit = regression.fit(picked(with, places));
    const double gain = regression.gain(regression.fit(picked(without, places)), fit);
    const auto parameters =
        std::max<std::size_t>(1, static_cast<std::size_t>(choice.variant.prior_sigma.size()));
    if (surprisal_of_drives(gain, parameters, fit.freedom, places.size()) <
        0.5 * kDriveThreshold_nats) {
      return false;
    }
  }
  return true;
}

void MotionSelection::drop_superfluous(std::vector<MotionChoice>& chosen) const {
  for (std::size_t i = 0; i < chosen.size();) {
    const MotionChoice& one = chosen[i];
    const std::size_t variants = one.effect->variants(record_).size();
    MotionChoice again = weighed(*one.effect, one.variant, variants, without(chosen, i));
    if (again.surprisal_nats < kDriveThreshold_nats) {
      chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      chosen[i++] = std::move(again);
    }
  }
}

std::vector<MotionChoice> MotionSelection::choose() const {
  std::vector<MotionChoice> chosen;
  while (chosen.size() < kMostCauses) {
    const std::vector<MotionChoice> examined = examine(chosen);
    const auto next = std::ranges::find_if(examined, [&](const MotionChoice& choice) {
      return choice.surprisal_nats >= kDriveThreshold_nats && choice.evidence_nats > 0.0 &&
             rests_on_many_drives(choice, chosen);
    });
    if (next == examined.end()) break;
    chosen.push_back(*next);
    drop_superfluous(chosen);
    if (chosen.empty() || chosen.back().effect != next->effect) break;
  }
  std::ranges::stable_sort(chosen, std::greater{}, &MotionChoice::gain_nats);
  return chosen;
}

}  // namespace zerorate::diagnose
