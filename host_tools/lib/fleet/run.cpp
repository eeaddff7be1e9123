// Lists of recordings, and the run that analyses them into a database.

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <mutex>
#include <optional>
#include <regex>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "host_tools/lib/fleet/database.hpp"
#include "host_tools/lib/parallel/parallel.hpp"
#include "host_tools/lib/recording/error.hpp"

namespace zerorate::fleet {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMissing = "missing:";

std::string without_extensions(const std::string& name) {
  std::string stem = fs::path(name).filename().string();
  for (const std::string_view extension : {".gz", ".csv", ".db3", ".bag"}) {
    if (stem.ends_with(extension)) stem.erase(stem.size() - extension.size());
  }
  return stem;
}

bool is_recording(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.ends_with(".csv") || name.ends_with(".csv.gz") || name.ends_with(".db3") ||
         name.ends_with(".bag");
}

std::vector<std::string> cells_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) {
    const auto first = cell.find_first_not_of(" \t");
    const auto last = cell.find_last_not_of(" \t");
    cell = first == std::string::npos ? "" : cell.substr(first, last - first + 1);
  }
  return cells;
}

/// A list of recordings as CSV.
class List {
 public:
  explicit List(const fs::path& path) : path_(path), file_(path) {
    if (!file_) throw std::system_error(errno, std::generic_category(), path.string());
  }

  std::vector<Entry> read() {
    std::vector<Entry> entries;
    std::set<std::string> names;
    for (std::string line; std::getline(file_, line);) {
      ++line_;
      const std::vector<std::string> cells = cells_of(line);
      if ((cells.size() == 1 && cells[0].empty()) || cells[0].starts_with('#')) continue;
      if (line.find('"') != std::string::npos) fail("quotes are not understood in a list");
      if (!is_header_read_ && take_header(cells)) continue;
      if (cells.size() < columns_) {
        fail(fmt::format("expected {} columns as in the header, found {}", columns_, cells.size()));
      }
      entries.push_back(entry_of(cells));
      if (!names.insert(entries.back().name).second) {
        fail(fmt::format("the recording {} stands in the list twice; leave one line of it",
                         entries.back().name));
      }
    }
    return entries;
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw std::runtime_error(fmt::format("{}:{}: {}", path_.string(), line_, reason));
  }

  /// Whether the first line is a header.
  bool take_header(const std::vector<std::string>& cells) {
    is_header_read_ = true;
    const auto place = [&](std::string_view name) -> std::optional<std::size_t> {
      const auto found = std::ranges::find(cells, name);
      if (found == cells.end()) return std::nullopt;
      return static_cast<std::size_t>(found - cells.begin());
    };
    const auto recording = place("recording");
    if (!recording) {
      if (cells.size() > 1) {
        fail("expected a header with the column recording, or one path a line without commas");
      }
      return false;
    }
    recording_ = *recording;
    sensor_ = place("sensor");
    lot_ = place("lot");
    if (!lot_) lot_ = place("date_code");
    columns_ = cells.size();
    return true;
  }

  [[nodiscard]] Entry entry_of(const std::vector<std::string>& cells) const {
    const std::string& name = cells[recording_];
    if (name.empty()) fail("the recording has no path");
    const std::string sensor = sensor_ ? cells[*sensor_] : "";
    return {.path = path_.parent_path() / name,
            .name = name,
            .sensor = sensor.empty() ? without_extensions(name) : sensor,
            .lot = lot_ ? cells[*lot_] : ""};
  }

  fs::path path_;
  std::ifstream file_;
  std::size_t line_ = 0;
  bool is_header_read_ = false;
  std::size_t columns_ = 1;
  std::size_t recording_ = 0;
  std::optional<std::size_t> sensor_;
  std::optional<std::size_t> lot_;
};

std::vector<Entry> search(const fs::path& folder) {
  std::vector<Entry> entries;
  const auto add = [&](const fs::path& path) {
    const std::string name = path.lexically_relative(folder).string();
    entries.push_back({.path = path, .name = name, .sensor = without_extensions(name), .lot = {}});
  };
  for (auto file = fs::recursive_directory_iterator(folder);
       file != fs::recursive_directory_iterator(); ++file) {
    std::error_code unreadable;
    if (file->is_directory(unreadable)) {
      // Stands among the recordings, so that the run says what was not seen.
      (void)fs::directory_iterator(file->path(), unreadable);
      if (!unreadable) continue;
      file.disable_recursion_pending();
      add(file->path());
    } else if (file->is_regular_file(unreadable) && is_recording(file->path())) {
      add(file->path());
    }
  }
  return entries;
}

std::regex pattern_of(const std::string& rule) {
  try {
    return std::regex{rule};
  } catch (const std::regex_error& error) {
    throw std::invalid_argument(fmt::format(
        "--lots {}: expected \"folder\" or a regular expression, such as '^(L[0-9]+)_': {}", rule,
        error.what()));
  }
}

/// One run: threads analyse, and one of them at a time writes.
class Run {
 public:
  Run(const std::vector<Entry>& recordings, Database& database, const RunOptions& options)
      : database_(database), options_(options) {
    for (std::size_t i = options.shard.index; i < recordings.size(); i += options.shard.count) {
      todo_.push_back({.hash = {}, .entry = recordings[i], .problem = {}, .result = {}});
    }
    summary_.total = todo_.size();
  }

  RunSummary perform() {
    parallel::for_each(todo_.size(), options_.jobs, [&](std::size_t i) { hash(todo_[i]); }, {});
    leave_out_repeated();
    leave_out_done();
    // Files that are gone for a moment are looked for again after all others.
    std::stable_partition(todo_.begin(), todo_.end(),
                          [](const StoredRecording& one) { return one.problem.empty(); });
    report_progress();
    parallel::for_each(todo_.size(), options_.jobs, [&](std::size_t i) { take(todo_[i]); }, {});
    summary_.seconds = seconds();
    std::ranges::sort(summary_.bad, {}, &BadRecording::name);
    return std::move(summary_);
  }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

  static void set_missing(StoredRecording& one, const char* reason) {
    one.hash = std::string{kMissing} + one.entry.name;
    one.problem = reason;
  }

  static void hash(StoredRecording& one) {
    try {
      one.hash = content_hash(one.entry.path);
    } catch (const std::system_error& error) {
      set_missing(one, error.what());
    }
  }

  /// Keeps the first name of several recordings with one content.
  void leave_out_repeated() {
    std::set<std::string> hashes;
    summary_.repeated = std::erase_if(
        todo_, [&](const StoredRecording& one) { return !hashes.insert(one.hash).second; });
  }

  void leave_out_done() {
    summary_.found_done = std::erase_if(todo_, [&](const StoredRecording& one) {
      const std::optional<std::string> problem = database_.problem_of(one.hash);
      if (!problem || one.hash.starts_with(kMissing)) return false;
      database_.rename(one.hash, one.entry);
      if (!problem->empty()) summary_.bad.push_back({one.entry.name, *problem});
      return true;
    });
  }

  void take(StoredRecording& one) {
    if (!one.problem.empty()) {
      one.problem.clear();
      hash(one);
    }
    if (one.problem.empty()) {
      try {
        analyse_again_if_away(one);
        one.problem = one.result.problem();
      } catch (const recording::DataError& error) {
        one.problem = error.what();
      } catch (const std::system_error& error) {
        set_missing(one, error.what());
      }
    }
    const std::scoped_lock lock{mutex_};
    database_.store(one);
    if (!one.hash.starts_with(kMissing)) database_.remove(std::string{kMissing} + one.entry.name);
    if (!one.problem.empty()) summary_.bad.push_back({one.entry.name, one.problem});
    one.result = {};  // stored, so that memory does not grow
    ++summary_.analysed;
    report_progress();
  }

  /// Analyses a recording again that seems to be wrong, with its content still there: a share that
  /// drops out for a moment would make it bad for ever, because results are kept by content. Throws
  /// std::system_error where the content is another.
  void analyse_again_if_away(StoredRecording& one) const {
    recording::Input input = options_.format;
    input.path = one.entry.path;
    try {
      one.result = analyse(read_population_samples(input, options_.axis));
    } catch (const recording::DataError&) {
      if (content_hash(one.entry.path) != one.hash) {
        throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again),
                                one.entry.path.string() + ": changed while it was read");
      }
      one.result = analyse(read_population_samples(input, options_.axis));
    }
  }

  void report_progress() const {
    if (!options_.on_progress || todo_.empty()) return;
    options_.on_progress({.found_done = summary_.found_done,
                          .analysed = summary_.analysed,
                          .to_analyse = todo_.size(),
                          .per_second = static_cast<double>(summary_.analysed) / seconds()});
  }

  Database& database_;
  const RunOptions& options_;
  std::vector<StoredRecording> todo_;
  Clock::time_point start_ = Clock::now();
  std::mutex mutex_;  // guards the summary and the database
  RunSummary summary_;
};

}  // namespace

std::vector<Entry> list_recordings(const fs::path& folder_or_list) {
  const bool is_folder = fs::is_directory(folder_or_list);
  const bool has_list = is_folder && fs::exists(folder_or_list / kListName);
  std::vector<Entry> entries =
      is_folder && !has_list ? search(folder_or_list)
                             : List{has_list ? folder_or_list / kListName : folder_or_list}.read();
  if (entries.empty()) {
    throw std::runtime_error(
        fmt::format("{}: no recordings here; expected {}", folder_or_list.string(),
                    is_folder ? "files *.csv, *.csv.gz, *.db3 or *.bag" : "one path a line"));
  }
  std::ranges::sort(entries, {}, &Entry::name);
  return entries;
}

void set_lots(std::vector<Entry>& recordings, const std::string& rule) {
  const bool is_by_folder = rule == "folder";
  const std::regex pattern = is_by_folder ? std::regex{} : pattern_of(rule);
  for (Entry& one : recordings) {
    if (!one.lot.empty()) continue;
    std::smatch match;
    if (is_by_folder) {
      one.lot = fs::path(one.name).parent_path().filename().string();
    } else if (std::regex_search(one.name, match, pattern)) {
      one.lot = match[match.size() > 1 ? 1 : 0];
    }
    if (one.lot.empty()) {
      throw std::invalid_argument(fmt::format(
          "--lots {}: {} {}", rule, one.name,
          is_by_folder ? "lies in no folder of its own; sort the recordings into one folder a lot"
                       : "does not match, or its lot is empty; the expression has to match every "
                         "name"));
    }
  }
}

RunSummary run(const std::vector<Entry>& recordings, Database& database,
               const RunOptions& options) {
  return Run{recordings, database, options}.perform();
}

}  // namespace zerorate::fleet
