#include "host_tools/lab/campaign/tally.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_tools/lab/campaign/outside_catalogue.hpp"
#include "host_tools/lib/simulate/sizing/sized_effect.hpp"

namespace zerorate::campaign {
namespace {

constexpr double kGreatestErrorRatio = 1.01;
constexpr double kLeastCoverage = 0.93;
constexpr double kGreatestCoverage = 0.97;

double median_of(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

}  // namespace

statistics::BootstrapFigure GainSummary::median(double Gain::*figure) const {
  return statistics::bootstrap(
      gains_.size(),
      [&](const std::vector<std::size_t>& drawn) {
        std::vector<double> values;
        values.reserve(drawn.size());
        for (const std::size_t i : drawn) values.push_back(gains_[i].*figure);
        return values.empty() ? std::nan("") : median_of(std::move(values));
      },
      random::RandomStream(seed_));
}

statistics::BootstrapFigure GainSummary::mean(double Gain::*figure) const {
  return statistics::bootstrap(
      gains_.size(),
      [&](const std::vector<std::size_t>& drawn) {
        double sum = 0.0;
        for (const std::size_t i : drawn) sum += gains_[i].*figure;
        return sum / static_cast<double>(drawn.size());
      },
      random::RandomStream(seed_));
}

bool GainSummary::scores_better() const {
  return median(&Gain::log_score_gain_nats_per_sample).lo > 0.0;
}
bool GainSummary::scores_worse() const {
  return median(&Gain::log_score_gain_nats_per_sample).hi < 0.0;
}
bool GainSummary::errs_no_more() const {
  return median(&Gain::rsse_ratio).value <= kGreatestErrorRatio &&
         median(&Gain::heading_drift_ratio).value <= kGreatestErrorRatio;
}
bool GainSummary::covers() const {
  const double coverage = mean(&Gain::coverage95_extended).value;
  return coverage >= kLeastCoverage && coverage <= kGreatestCoverage;
}

std::string GainSummary::header() {
  return "| hidden effect | recordings | in the model | log score gain, 10^-3 nats a sample | RSSE "
         "| heading drift | coverage before | after | the models |\n"
         "|---|---|---|---|---|---|---|---|---|\n";
}

std::string GainSummary::row() const {
  const auto score = median(&Gain::log_score_gain_nats_per_sample);
  const auto after = mean(&Gain::coverage95_extended);
  std::string misses;
  if (scores_worse()) misses += " log score";
  if (!errs_no_more()) misses += " error";
  if (!covers()) misses += " coverage";
  return fmt::format(
      "| {} | {} | {} | {:.3g} ({:.3g} to {:.3g}) | {:.4f} | {:.3f} | {:.3f} | {:.3f} ({:.3f} to "
      "{:.3f}) "
      "| {} |\n",
      effect_, size(), extensions_, 1e3 * score.value, 1e3 * score.lo, 1e3 * score.hi,
      median(&Gain::rsse_ratio).value, median(&Gain::heading_drift_ratio).value,
      mean(&Gain::coverage95_base).value, after.value, after.lo, after.hi,
      misses.empty() ? (scores_better() ? "pay" : "do no harm") : "harm:" + misses);
}

namespace {

constexpr double kOnceInAThousand = 1e-3;

std::string truth_of(const Scenario& scenario) {
  switch (scenario.kind) {
    case Kind::clean:
      return "clean";
    case Kind::pair:
      return "two effects";
    case Kind::single:
    case Kind::outside:
      break;
  }
  return scenario.truth.front();
}

bool is_right(const Scenario& scenario, const Answer& answer, const Score& result) {
  switch (scenario.kind) {
    case Kind::clean:
      return answer.verdict == "consistent";
    case Kind::single:
    case Kind::pair:
      return result.named && result.alone;
    case Kind::outside:
      return answer.verdict == "unexplained";
  }
  return false;
}

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

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

void Tally::add(std::size_t run, const Scenario& scenario, const Answer& answer) {
  const Score result = score(scenario, answer);
  Row& row = rows_[truth_of(scenario)];
  ++row.runs;
  if (result.named) ++row.named;
  if (result.named && result.alone) ++row.first_and_alone;
  if (result.alternative && !result.named) ++row.alternative;
  ++row.verdicts[answer.verdict];
  ++row.answers[answer.causes.empty() ? answer.verdict : answer.causes.front()];
  switch (scenario.kind) {
    case Kind::clean:
      false_alarms_.count(answer.verdict != "consistent");
      break;
    case Kind::single:
      named_.count(result.named);
      first_and_alone_.count(result.named && result.alone);
      break;
    case Kind::pair:
      both_named_.count(result.named);
      break;
    case Kind::outside:
      outside_unexplained_.count(answer.verdict == "unexplained");
      break;
  }
  if (answer.verdict == "explained") {
    wrong_.count(result.wrong);
    count_certainties(scenario, answer);
  }
  count_coverage(scenario, answer);
  if (!is_right(scenario, answer, result)) {
    misses_.push_back(fmt::format(
        "run {}: {} ({}) was answered: {}, causes [{}], alternatives [{}]", run,
        scenario.truth.empty() ? "clean" : fmt::format("{}", fmt::join(scenario.truth, " + ")),
        scenario.description, answer.verdict, fmt::join(answer.causes, ", "),
        fmt::join(answer.alternatives, ", ")));
  }
}

void Tally::count_certainties(const Scenario& scenario, const Answer& answer) {
  const auto hidden = [&](const std::string& name) {
    return std::ranges::find(scenario.truth, name) != scenario.truth.end();
  };
  for (std::size_t i = 0; i < answer.certainties.size(); ++i) {
    reliability_.count(answer.certainties[i].probability, hidden(answer.causes[i]));
    in_set95_.count(std::ranges::any_of(answer.certainties[i].set95, hidden));
  }
}

void Tally::count_coverage(const Scenario& scenario, const Answer& answer) {
  for (const auto& [effect, intervals] : answer.intervals) {
    const auto truths = scenario.figures.find(effect);
    if (truths == scenario.figures.end()) continue;
    for (const auto& [name, truth] : truths->second) {
      const auto interval = intervals.find(name);
      if (interval == intervals.end()) continue;
      const auto [lo, hi] = interval->second;
      coverage_[fmt::format("{}: {}", effect, name)].count(lo <= truth && truth <= hi);
    }
  }
}

std::vector<Bar> Tally::bars() const {
  const double single = options_.nats >= 40.0 ? 0.95 : 0.90;
  std::vector<Bar> bars{
      {"single effects named", named_, single},
      {"single effects named first and alone", first_and_alone_,
       options_.nats >= 40.0 ? 0.92 : 0.87},
      {"two effects, both named", both_named_, 0.80},
      {"false alarms on clean recordings", false_alarms_, 0.02, false},
      {"outside the catalogue, called unexplained", outside_unexplained_, 0.85},
      {"wrong cause that stands alone, among answers `explained`", wrong_, 0.05, false}};
  std::erase_if(bars, [](const Bar& bar) { return bar.rate.runs == 0; });
  return bars;
}

std::string Tally::markdown() const {
  std::string text =
      "| what | bar | measured | 95 % interval | runs | |\n|---|---|---|---|---|---|\n";
  for (const Bar& bar : bars()) {
    text +=
        fmt::format("| {} | {} {:.0f} % | {} | {} to {} | {} | {} |\n", bar.what,
                    bar.at_least ? "at least" : "at most", 100.0 * bar.bar,
                    percent(bar.rate.share()), percent(bar.rate.lo95()), percent(bar.rate.hi95()),
                    bar.rate.runs, bar.holds() ? "holds" : "**missed**");
  }
  text += fmt::format(
      "\nProbabilities of the causes of answers `explained`: expected calibration error {:.3f} "
      "over "
      "{} causes; {} of the sets that hold the cause with 95 % hold a hidden effect ({} to "
      "{}).\n\n{}",
      reliability_.expected_calibration_error(), reliability_.size(), percent(in_set95_.share()),
      percent(in_set95_.lo95()), percent(in_set95_.hi95()), reliability_.markdown());
  text += "\n" + coverage_table() + "\n" + matrix();
  if (misses_.empty()) return text;
  text += "\nAnswers that were not the right one:\n\n";
  for (const std::string& miss : misses_) text += "- " + miss + "\n";
  return text;
}

std::string Tally::coverage_table() const {
  std::string text =
      "| parameter | truth in its 95 % interval | of | share, 95 % interval |\n|---|---|---|---|\n";
  Rate all;
  for (const auto& [name, rate] : coverage_) {
    text += fmt::format("| {} | {} | {} | {} to {} |\n", name, rate.hits, rate.runs,
                        percent(rate.lo95()), percent(rate.hi95()));
    all.hits += rate.hits;
    all.runs += rate.runs;
  }
  return text + fmt::format("| all | {} ({}) | {} | {} to {} |\n", all.hits, percent(all.share()),
                            all.runs, percent(all.lo95()), percent(all.hi95()));
}

std::string Tally::matrix() const {
  std::vector<std::string> rows;
  for (const sizing::EffectEntry& entry : sizing::catalogue()) rows.emplace_back(entry.name);
  std::string text = "| hidden | runs | named | alone | rival |";
  for (std::size_t column = 1; column <= rows.size(); ++column)
    text += fmt::format(" {} |", column);
  text += " consistent | unexplained | verdict unexplained |\n|---|---|---|---|---|";
  for (std::size_t column = 0; column < rows.size() + 3; ++column) text += "---|";
  text += "\n";
  const std::size_t columns = rows.size();
  rows.insert(rows.end(), {"clean", "two effects"});
  for (const sizing::EffectEntry& entry : outside_catalogue()) rows.emplace_back(entry.name);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto found = rows_.find(rows[i]);
    if (found == rows_.end()) continue;
    const Row& row = found->second;
    const auto cell = [](const std::map<std::string, std::size_t>& counts, const std::string& key) {
      const auto count = counts.find(key);
      return count == counts.end() ? std::string(" |") : fmt::format(" {} |", count->second);
    };
    text += fmt::format("| {}{} | {} | {} | {} | {} |",
                        i < columns ? fmt::format("{} ", i + 1) : std::string(), rows[i], row.runs,
                        row.named, row.first_and_alone, row.alternative);
    for (std::size_t column = 0; column < columns; ++column)
      text += cell(row.answers, rows[column]);
    text += cell(row.answers, "consistent") + cell(row.answers, "unexplained") +
            cell(row.verdicts, "unexplained") + "\n";
  }
  return text;
}

std::string Tally::json() const {
  nlohmann::ordered_json document{
      {"schema", "zerorate.hidden_effect_campaign/1"},
      {"seed", options_.seed},
      {"samples", options_.samples},
      {"nats", options_.nats},
      {"bars", nlohmann::json::array()},
      {"expected_calibration_error", reliability_.expected_calibration_error()},
      {"in_set95", in_set95_.share()},
      {"misses", misses_}};
  for (const Bar& bar : bars()) {
    document["bars"].push_back({{"what", bar.what},
                                {"bar", bar.bar},
                                {"share", bar.rate.share()},
                                {"lo95", bar.rate.lo95()},
                                {"hi95", bar.rate.hi95()},
                                {"runs", bar.rate.runs},
                                {"holds", bar.holds()}});
  }
  for (const auto& [name, rate] : coverage_) {
    document["coverage"][name] = {{"hits", rate.hits}, {"runs", rate.runs}};
  }
  for (const auto& [truth, row] : rows_) {
    document["confusion"][truth] = {{"runs", row.runs},
                                    {"named", row.named},
                                    {"first_and_alone", row.first_and_alone},
                                    {"alternative", row.alternative},
                                    {"verdicts", row.verdicts},
                                    {"answers", row.answers}};
  }
  return document.dump(2) + "\n";
}

}  // namespace zerorate::campaign
