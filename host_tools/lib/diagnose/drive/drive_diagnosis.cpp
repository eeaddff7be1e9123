#include "host_tools/lib/diagnose/drive/drive_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_tools/lib/diagnose/drive/drive_gain.hpp"
#include "host_tools/lib/diagnose/drive/drive_selection.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

/// A reference that errs by more on a way is none of drives, and the scatter is left
/// unexplained.
constexpr double kLargestWaySigma_rad = 0.5 * units::kRadPerDeg;

double rms_of(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

MotionFinding finding_of(const DriveRecord& record, const std::vector<MotionChoice>& choices,
                         std::size_t which, const DriveFit& fit) {
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < which; ++i) first += choices[i].variant.share.columns.cols();
  const Eigen::Index columns = choices[which].variant.share.columns.cols();
  const double share = columns > 0 ? fit.share_of_drives.segment(first, columns).mean() : 1.0;
  MotionFinding finding{
      .record = &record, .variant = choices[which].variant, .freedom = fit.freedom(share)};
  for (Eigen::Index k = first; k < first + columns; ++k) {
    const double sigma = std::sqrt(fit.covariance(k, k));
    finding.coefficients.push_back(
        {fit.coefficients[k], student_half_width95(finding.freedom) * sigma, sigma});
  }
  return finding;
}

/// The effects that may stand in the place of one, and how much less likely they are.
std::vector<Alternative> rivals_of(const MotionChoice& choice, const MotionSelection& selection,
                                   const std::vector<MotionChoice>& others) {
  std::vector<Alternative> rivals;
  for (const MotionChoice& rival : selection.examine(others)) {
    if (rival.effect == choice.effect) continue;
    const double behind = choice.evidence_nats - rival.evidence_nats;
    rivals.push_back({std::string(rival.effect->name()), std::max(0.0, behind)});
  }
  return rivals;
}

/// The other variants of an effect, such as "bias_in_motion_by_metres", and how much less likely
/// they are.
std::vector<Alternative> variants_beside(const MotionChoice& choice,
                                         const MotionSelection& selection,
                                         const std::vector<MotionChoice>& others) {
  std::vector<Alternative> beside;
  for (const Variant& variant : selection.variants_of(*choice.effect)) {
    if (variant.by == choice.variant.by) continue;
    const MotionChoice other = selection.weighed(*choice.effect, variant, others);
    beside.push_back({fmt::format("{}_by_{}", choice.effect->name(), variant.by),
                      std::max(0.0, choice.evidence_nats - other.evidence_nats)});
  }
  return beside;
}

Cause cause_of(const MotionChoice& choice, const MotionSelection& selection,
               const std::vector<MotionChoice>& others, MotionDescription description) {
  std::vector<Alternative> rivals = rivals_of(choice, selection, others);
  const auto explanations = weigh(choice.effect->name(), choice.surprisal_nats, rivals);
  const auto own = std::ranges::find(explanations, choice.effect->name(), &Explanation::effect);
  Cause cause{.effect = std::string(choice.effect->name()),
              .gain_nats = choice.gain_nats,
              .p_value = std::exp(-choice.surprisal_nats),
              .parameters = std::move(description.parameters),
              .probability = own->probability,
              .set95 = set95_of(explanations),
              .sentence = std::move(description.sentence)};
  // A variant of the effect does not speak against it.
  std::ranges::move(variants_beside(choice, selection, others), std::back_inserter(rivals));
  std::ranges::stable_sort(rivals, {}, &Alternative::less_likely_by_nats);
  std::ranges::copy_if(
      rivals, std::back_inserter(cause.alternatives),
      [](const Alternative& rival) { return rival.less_likely_by_nats <= kAlternativeNats; });
  return cause;
}

std::vector<SelectionEvidence> evidence_of(
    const DriveRecord& record, const std::vector<std::unique_ptr<MotionEffect>>& effects,
    const MotionSelection& selection, const std::vector<MotionChoice>& chosen) {
  std::vector<SelectionEvidence> evidence;
  for (const MotionChoice& alone : selection.examine({})) {
    evidence.push_back({.effect = std::string(alone.effect->name()),
                        .gain_nats = alone.gain_nats,
                        .price_nats = alone.gain_nats - alone.surprisal_nats + kDriveThreshold_nats,
                        .selected = std::ranges::find(chosen, alone.effect,
                                                      &MotionChoice::effect) != chosen.end()});
  }
  for (const auto& effect : effects) {
    std::string obstacle = effect->obstacle(record);
    if (obstacle.empty()) continue;
    evidence.push_back(
        {.effect = std::string(effect->name()), .not_examined = std::move(obstacle)});
  }
  std::ranges::stable_sort(evidence, std::greater{}, &SelectionEvidence::gain_nats);
  return evidence;
}

/// Causes that are found without the errors of the heading.
void add_findings(const DriveRecord& record, DriveDiagnosis& diagnosis) {
  for (const TraceFinding& finding : record.findings) {
    const auto explanations = weigh(finding.effect, finding.surprisal_nats, {});
    diagnosis.causes.push_back({.effect = finding.effect,
                                .gain_nats = finding.surprisal_nats,
                                .p_value = std::exp(-finding.surprisal_nats),
                                .parameters = finding.parameters,
                                .probability = explanations.front().probability,
                                .set95 = set95_of(explanations),
                                .sentence = finding.sentence,
                                .in_model = false,
                                .left_out_because = finding.left_out_because});
    diagnosis.evidence.push_back({.effect = finding.effect,
                                  .gain_nats = finding.surprisal_nats,
                                  .price_nats = kDriveThreshold_nats,
                                  .selected = true});
  }
}

void add_points(const DriveRecord& record, const std::vector<MotionChoice>& chosen,
                const DriveFit& fit, DriveDiagnosis& diagnosis) {
  const Share share = joint_share(chosen, record);
  Eigen::VectorXd by_causes = share.known;
  if (share.columns.cols() > 0) by_causes += share.columns * fit.coefficients;
  const Eigen::MatrixXd covariance = record.covariance();
  for (std::size_t i = 0; i < record.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const DriveEvidence& drive = record.drives[i];
    diagnosis.points.push_back({.departure_s = drive.departure_s,
                                .turn_rad = drive.turn_rad,
                                .moving_s = drive.moving_s,
                                .metres = drive.metres,
                                .error_rad = drive.error_rad,
                                .share_rad = by_causes[row],
                                .sigma_rad = std::sqrt(covariance(row, row))});
  }
  const auto drives = static_cast<Eigen::Index>(record.size());
  diagnosis.rms_rad = rms_of(record.errors().head(drives));
  diagnosis.rms_left_rad = rms_of((record.errors() - by_causes).head(drives));
  diagnosis.scatter = std::sqrt(fit.drives.factor());
}

/// Takes causes out with which the heading of the drives held out errs by more, certainly: those of
/// some drives that the others contradict.
void drop_contradicted(const DriveRecord& record, std::vector<MotionChoice>& chosen,
                       DriveDiagnosis& diagnosis) {
  for (std::size_t i = 0; i < chosen.size();) {
    if (!(drift_ratio_of(record, chosen, i).lo > 1.0)) {
      ++i;
      continue;
    }
    diagnosis.remarks.push_back(
        fmt::format("The first drives look like an effect, {}, that the last ones contradict: the "
                    "reference may "
                    "have been at fault.",
                    chosen[i].effect->name()));
    chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;
  }
}

/// Takes causes out whose sizes may all be zero by their intervals: slopes would do as well.
void drop_what_slopes_do(const DriveRecord& record, const MotionSelection& selection,
                         std::vector<MotionChoice>& chosen) {
  const auto may_be_zero = [](const Parameter& size) { return size.lo <= 0.0 && size.hi >= 0.0; };
  for (std::size_t i = 0; i < chosen.size();) {
    const MotionFinding finding = finding_of(record, chosen, i, selection.fit(chosen));
    const MotionDescription description = chosen[i].effect->describe(finding);
    if (!std::ranges::all_of(description.parameters, may_be_zero)) {
      ++i;
      continue;
    }
    chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;
  }
}

/// Whether more is left than noise and bias let expect, with a probability below 1 in 1000.
bool is_left_unexplained(const DriveFit& fit) {
  constexpr double kRare = 1e-3;
  return statistics::chi_squared_tail(fit.drives.squares, fit.drives.freedom) < kRare;
}

/// Error of the reference on each way with which what is left is as large as expected.
double way_sigma_by_scatter(const DriveRecord& record, const std::vector<MotionChoice>& chosen) {
  const Share share = joint_share(chosen, record);
  DriveRecord trial = record;
  double lo = 0.0;
  double hi = 2.0 * kLargestWaySigma_rad;
  constexpr int kHalvings = 30;
  for (int i = 0; i < kHalvings; ++i) {
    trial.way_sigma_rad = 0.5 * (lo + hi);
    const bool is_too_small = DriveRegression(trial).fit(share).drives.factor() > 1.0;
    (is_too_small ? lo : hi) = trial.way_sigma_rad;
  }
  return hi;
}

/// Where more is left than expected, the reference may err more on the way than at its stops. Says
/// so, and chooses again.
DriveRecord with_reference_by_scatter(const DriveRecord& record, DriveDiagnosis& diagnosis) {
  const auto effects = make_motion_effects();
  const MotionSelection selection{record, effects};
  const std::vector<MotionChoice> chosen = selection.choose();
  if (!is_left_unexplained(selection.fit(chosen))) return record;
  DriveRecord wider = record;
  wider.way_sigma_rad = way_sigma_by_scatter(record, chosen);
  if (wider.way_sigma_rad > kLargestWaySigma_rad) return record;
  diagnosis.remarks.push_back(fmt::format(
      "The error of the reference was estimated from what is left: {:.2g} deg of a drive's turn, "
      "where its headings at rest show {:.2g} deg. An error of the gyro that no effect describes "
      "would look alike.",
      wider.way_sigma_rad * units::kDegPerRad,
      std::numbers::sqrt2 * record.reference_sigma_rad * units::kDegPerRad));
  return wider;
}

}  // namespace

DriveDiagnosis diagnose_drives(const DriveRecord& given, model::SensorModel& model) {
  DriveDiagnosis diagnosis{.vertical = truth::name(given.vertical, given.axis_count),
                           .drives = given.size(),
                           .left_out = given.left_out,
                           .obstacle = given.obstacle};
  if (diagnosis.obstacle.empty() && given.size() < kFewestDrives) {
    diagnosis.obstacle =
        fmt::format("{} drives between true stops without a flaw, and {} are needed", given.size(),
                    kFewestDrives);
  }
  if (!diagnosis.obstacle.empty()) {
    add_findings(given, diagnosis);
    return diagnosis;
  }
  if (given.has_headings_at_stops_only) {
    diagnosis.remarks.emplace_back(
        "The heading was measured at stops only. The gyro counted the whole turns between them, "
        "and faults and the delay of the reference were not looked for.");
  }
  const DriveRecord record = with_reference_by_scatter(given, diagnosis);
  const auto effects = make_motion_effects();
  const MotionSelection selection{record, effects};
  std::vector<MotionChoice> chosen = selection.choose();
  drop_what_slopes_do(record, selection, chosen);
  drop_contradicted(record, chosen, diagnosis);
  const DriveFit fit = selection.fit(chosen);
  const double tolerance = model.scale_factor.value_or(model::ScaleFactor{}).sigma;
  diagnosis.gain = measure_drive_gain(record, chosen, tolerance);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const MotionFinding finding = finding_of(record, chosen, i, fit);
    Cause cause =
        cause_of(chosen[i], selection, without(chosen, i), chosen[i].effect->describe(finding));
    cause.heading_drift_ratio = drift_ratio_of(record, chosen, i);
    cause.left_out_because = cause.heading_drift_ratio->value < 1.0
                                 ? chosen[i].effect->add_to_model(finding, model)
                                 : "on the drives held out the heading errs by no less";
    cause.in_model = cause.left_out_because.empty();
    diagnosis.causes.push_back(std::move(cause));
  }
  diagnosis.evidence = evidence_of(record, effects, selection, chosen);
  add_findings(record, diagnosis);
  add_points(record, chosen, fit, diagnosis);
  const bool are_many = chosen.size() == kMostCauses;
  if (are_many) {
    diagnosis.remarks.emplace_back(
        "Three effects at once would be needed, and so many can draw the errors of most drives: "
        "none of them is proven.");
  }
  diagnosis.verdict = are_many || is_left_unexplained(fit) ? Verdict::unexplained
                      : diagnosis.causes.empty()           ? Verdict::consistent
                                                           : Verdict::explained;
  return diagnosis;
}

}  // namespace zerorate::diagnose
