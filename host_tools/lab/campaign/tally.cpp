#include "host_tools/lab/campaign/tally.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "host_tools/lab/campaign/drive_recording.hpp"
#include "host_tools/lab/campaign/outside_catalogue.hpp"
#include "host_tools/lab/campaign/standstill_recording.hpp"
#include "host_tools/lib/simulate/sizing/sized_effect.hpp"

namespace zerorate::campaign {
namespace {

std::string truth_of(const BlindRecording& blind) {
  switch (blind.kind) {
    case Kind::clean:
      return "clean";
    case Kind::pair:
      return "two effects";
    case Kind::single:
    case Kind::outside:
      break;
  }
  return blind.truth.front();
}

/// Effects of the matrix; "quantization" comes with "truncation", and may be the strongest.
std::vector<std::string> effects_of(const BlindOptions& options) {
  std::vector<std::string> names;
  if (options.drives) return {kDriveEffects.begin(), kDriveEffects.end()};
  if (options.standstills) {
    names.assign(kStandstillEffects.begin(), kStandstillEffects.end());
    names.emplace_back("quantization");
    return names;
  }
  for (const sizing::EffectEntry& entry : sizing::catalogue()) names.emplace_back(entry.name);
  return names;
}

/// Rows of effects from outside the catalogue.
std::vector<std::string> outside_of(const BlindOptions& options) {
  if (options.drives) return {kDriveEffectsOutside.begin(), kDriveEffectsOutside.end()};
  std::vector<std::string> names;
  for (const sizing::EffectEntry& entry : outside_catalogue()) names.emplace_back(entry.name);
  return names;
}

/// Whether an answer states that more is there than its causes explain.
bool tells_of_more(const Answer& answer) {
  return answer.verdict == "unexplained" || answer.verdict == kReferenceDoubted;
}

bool is_right(const BlindRecording& blind, const Answer& answer, const Score& result) {
  switch (blind.kind) {
    case Kind::clean:
      return answer.verdict == "consistent";
    case Kind::single:
    case Kind::pair:
      return result.named && result.alone;
    case Kind::outside:
      return tells_of_more(answer);
  }
  return false;
}

}  // namespace

void Tally::add(std::size_t run, const BlindRecording& blind, const Answer& answer) {
  const Score result = score(blind, answer);
  Row& row = rows_[truth_of(blind)];
  ++row.runs;
  if (result.named) ++row.named;
  if (result.named && result.alone) ++row.first_and_alone;
  if (result.alternative && !result.named) ++row.alternative;
  ++row.verdicts[answer.verdict];
  ++row.answers[answer.causes.empty() ? answer.verdict : answer.causes.front()];
  switch (blind.kind) {
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
      outside_unexplained_.count(tells_of_more(answer));
      break;
  }
  if (answer.verdict == "explained") {
    wrong_.count(result.wrong);
    count_certainties(blind, answer);
  }
  count_coverage(blind, answer);
  if (!is_right(blind, answer, result)) {
    misses_.push_back(fmt::format(
        "run {}: {} ({}) was answered: {}, causes [{}], alternatives [{}]", run,
        blind.truth.empty() ? "clean" : fmt::format("{}", fmt::join(blind.truth, " + ")),
        blind.description, answer.verdict, fmt::join(answer.causes, ", "),
        fmt::join(answer.alternatives, ", ")));
  }
}

void Tally::count_certainties(const BlindRecording& blind, const Answer& answer) {
  const auto hidden = [&](const std::string& name) {
    return std::ranges::find(blind.truth, name) != blind.truth.end() ||
           std::ranges::find(blind.also, name) != blind.also.end();
  };
  for (std::size_t i = 0; i < answer.certainties.size(); ++i) {
    reliability_.count(answer.certainties[i].probability, hidden(answer.causes[i]));
    in_set95_.count(std::ranges::any_of(answer.certainties[i].set95, hidden));
  }
}

void Tally::count_coverage(const BlindRecording& blind, const Answer& answer) {
  for (const auto& [effect, intervals] : answer.intervals) {
    const auto truths = blind.figures.find(effect);
    if (truths == blind.figures.end()) continue;
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
       (options_.drives ? 0.90 : 0.92) - (options_.nats >= 40.0 ? 0.0 : 0.05)},
      {"two effects, both named", both_named_, 0.80},
      {"false alarms on clean recordings", false_alarms_, 0.02, false},
      {options_.drives ? "outside the catalogue, called unexplained or the reference doubted"
                       : "outside the catalogue, called unexplained",
       outside_unexplained_, 0.85},
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
  std::vector<std::string> rows = effects_of(options_);
  std::string text = "| hidden | runs | named | alone | rival |";
  for (std::size_t column = 1; column <= rows.size(); ++column)
    text += fmt::format(" {} |", column);
  text += " consistent | unexplained | verdict unexplained |\n|---|---|---|---|---|";
  for (std::size_t column = 0; column < rows.size() + 3; ++column) text += "---|";
  text += "\n";
  const std::size_t columns = rows.size();
  rows.insert(rows.end(), {"clean", "two effects"});
  for (const std::string& name : outside_of(options_)) rows.push_back(name);
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
