#include "host_tools/lab/campaign/answer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace zerorate::campaign {
namespace {

/// Runs a program without its output; its exit code.
int run(std::vector<std::string> arguments) {
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int fault = posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (fault != 0) throw std::system_error(fault, std::generic_category(), arguments[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Null is no figure.
double figure(const nlohmann::json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Gain gain_in(const nlohmann::json& json) {
  return {.rsse_ratio = figure(json.at("rsse_ratio")),
          .heading_drift_ratio = figure(json.at("heading_drift_ratio")),
          .coverage95_base = figure(json.at("coverage95_base")),
          .coverage95_extended = figure(json.at("coverage95_extended")),
          .log_score_gain_nats_per_sample = figure(json.at("log_score_gain_nats_per_sample"))};
}

constexpr double kStandsAlone = 0.8;  ///< below it the answer is "one of"

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

void add_cause(const nlohmann::json& cause, Answer& answer) {
  constexpr std::string_view kEnd = "_ci95";
  answer.causes.push_back(cause.at("name"));
  if (cause.at("in_model").get<bool>()) answer.extensions.push_back(answer.causes.back());
  for (const auto& [key, interval] : cause.at("parameters").items()) {
    if (!key.ends_with(kEnd) || interval[0].is_null() || interval[1].is_null()) continue;
    answer.intervals[answer.causes.back()][key.substr(0, key.size() - kEnd.size())] = {
        interval[0].get<double>(), interval[1].get<double>()};
  }
  Certainty certainty{.probability = cause.at("probability").get<double>()};
  for (const auto& one : cause.at("set95")) certainty.set95.push_back(one.at("name"));
  answer.certainties.push_back(std::move(certainty));
  for (const auto& rival : cause.at("alternatives")) {
    answer.alternatives.push_back(rival.at("name"));
  }
}

/// Output of `zerorate diagnose`, and its exit code.
struct Written {
  nlohmann::json document;
  int code = 0;
};

Written written_by(const std::filesystem::path& zerorate, const std::filesystem::path& recording) {
  const std::filesystem::path json = recording.string() + ".json";
  const int code =
      run({zerorate.string(), "diagnose", recording.string(), "--json", json.string()});
  if (code > 1) throw std::runtime_error(fmt::format("zerorate diagnose ended with {}", code));
  return {nlohmann::json::parse(std::ifstream{json}), code};
}

}  // namespace

Answer diagnose(const std::filesystem::path& zerorate, const std::filesystem::path& recording) {
  const auto [document, code] = written_by(zerorate, recording);
  Answer answer{.verdict = document.at("verdict"),
                .gain = gain_in(document.at("gain_over_data_sheet"))};
  for (const char* list : {"causes", "further_causes"}) {
    for (const auto& cause : document.at(list)) add_cause(cause, answer);
  }
  if ((code == 1) != (answer.verdict == "unexplained")) {
    throw std::runtime_error(fmt::format("exit code {} with {}", code, answer.verdict));
  }
  return answer;
}

Answer diagnose_drives(const std::filesystem::path& zerorate,
                       const std::filesystem::path& recording) {
  const nlohmann::json document = written_by(zerorate, recording).document;
  Answer answer{.verdict = "not examined"};
  if (!document.contains("drives")) return answer;
  const nlohmann::json& drives = document.at("drives");
  for (const auto& cause : drives.at("causes")) add_cause(cause, answer);
  const auto& verdict = drives.at("verdict");
  if (!verdict.is_null()) answer.verdict = verdict;
  if (verdict.is_null() && !answer.causes.empty()) answer.verdict = "explained";
  for (const std::string remark : drives.at("remarks")) {
    const bool is_doubt = remark.starts_with("The error of the reference was estimated");
    if (is_doubt && answer.verdict == "consistent") answer.verdict = kReferenceDoubted;
  }
  return answer;
}

Score score(const BlindRecording& blind, const Answer& answer) {
  const auto hidden = [&](const std::string& name) {
    return contains(blind.truth, name) || contains(blind.also, name);
  };
  const auto named = [&](const std::string& name) { return contains(answer.causes, name); };
  const auto mentioned = [&](const std::string& name) {
    return named(name) || contains(answer.alternatives, name);
  };
  const bool any_hidden = !blind.truth.empty();
  Score score;
  score.named = any_hidden && std::ranges::all_of(blind.truth, named);
  score.first = !answer.causes.empty() && hidden(answer.causes.front());
  score.alone = score.first && std::ranges::all_of(answer.causes, hidden);
  score.alternative = any_hidden && std::ranges::all_of(blind.truth, mentioned);
  for (std::size_t i = 0; i < answer.causes.size(); ++i) {
    const bool stands_alone =
        i >= answer.certainties.size() || answer.certainties[i].probability >= kStandsAlone;
    score.wrong |= answer.verdict == "explained" && stands_alone && !hidden(answer.causes[i]);
  }
  return score;
}

}  // namespace zerorate::campaign
