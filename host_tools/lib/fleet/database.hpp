/// @file
/// Results of a fleet in one SQLite file, and the run that fills it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/fleet/analysis.hpp"
#include "host_tools/lib/fleet/writer_lock.hpp"

struct sqlite3;

namespace zerorate::fleet {

/// Recording as the user names it.
struct Entry {
  std::filesystem::path path;
  std::string name;    ///< path as the list or the folder has it: equal on every machine
  std::string sensor;  ///< serial number, or the name without its extension
  std::string lot;     ///< lot or date code; empty where none is known
};

/// Name of the list that a folder of recordings may hold.
inline constexpr const char* kListName = "fleet.csv";

/// Recordings of a folder or a list, in the order of their names.
///
/// A list is a text file: one recording a line, or CSV whose header names the columns `recording`,
/// `sensor` and `lot` (also `date_code`), of which the first is needed and others are left alone.
/// Paths are relative to the list. A folder that holds a kListName is that list; another one is
/// searched for *.csv, *.csv.gz, *.db3 and *.bag, also in its folders. Throws std::runtime_error
/// that names file, line and reason.
[[nodiscard]] std::vector<Entry> list_recordings(const std::filesystem::path& folder_or_list);

/// Sets the lots of recordings that the list gives none.
/// @param rule  "folder": the folder that a recording lies in; else a regular expression
///   (ECMAScript) whose first group, or whole match, in the name is the lot
/// Throws std::invalid_argument for an expression that is none, and where a recording has no lot by
/// the rule.
void set_lots(std::vector<Entry>& recordings, const std::string& rule);

/// Recording with its results.
struct StoredRecording {
  std::string hash;
  Entry entry;
  std::string problem;  ///< why it could not be used; empty where it was
  RecordingResult result;
};

/// Database file. One transaction a recording with a rollback journal, which works on network
/// file systems too: a process that is killed leaves every recording whole or absent. One process
/// writes at a time; a second one is refused. Members throw std::runtime_error that names the file,
/// and are for one thread at a time.
class Database {
 public:
  enum class Access { read, write };

  /// Opens a database, or makes one if it is to be written. A reader sees it as it is at that
  /// moment, also while another process writes to it. Refuses a database of another engine: results
  /// of two are not comparable.
  Database(const std::filesystem::path& path, Access access);

  /// Remembers how recordings are read: options as typed, empty for none. Refuses a database whose
  /// recordings were read otherwise: the results would not be comparable.
  void require_format(const std::string& options);

  /// Version of the program and of its analysis.
  [[nodiscard]] static std::string engine();

  /// Problem of a recording, empty where there was none; nullopt where it is not stored.
  [[nodiscard]] std::optional<std::string> problem_of(std::string_view hash) const;
  /// Stores a recording in one transaction; one of the same hash is replaced.
  void store(const StoredRecording& recording);
  /// Gives a recording that is stored another name, sensor and lot.
  void rename(std::string_view hash, const Entry& entry);
  void remove(std::string_view hash);
  /// Calls `take` with every recording in the order of the hashes.
  void for_each(const std::function<void(const StoredRecording&)>& take) const;
  [[nodiscard]] std::size_t size() const;

  /// Contents as text that does not depend on how they came in: one line a row, in order.
  [[nodiscard]] std::string dump() const;

 private:
  friend void merge(const std::vector<std::filesystem::path>&, const std::filesystem::path&);

  struct Closer {
    void operator()(sqlite3* database) const;
  };

  [[nodiscard]] std::string format() const;
  void check_engine(Access access);
  void execute(const std::string& statements) const;

  std::filesystem::path path_;
  // Closing any descriptor of a file frees the process's locks of SQLite, so this one outlives it.
  std::unique_ptr<const WriterLock> lock_;
  std::unique_ptr<sqlite3, Closer> handle_;
};

/// Joins databases, and `out` if it is there already. Idempotent, in any order: the bytes of `out`
/// depend on the contents only. Where a recording came under two names, the first in the alphabet
/// stays. Throws std::runtime_error where the engines differ; `out` is then as it was.
void merge(const std::vector<std::filesystem::path>& shards, const std::filesystem::path& out);

/// Share of the work: every `count`th recording from the one with this number on.
struct Shard {
  std::size_t index = 0;  ///< from 0
  std::size_t count = 1;
};

struct Progress {
  std::size_t found_done = 0;  ///< recordings, by earlier runs
  std::size_t analysed = 0;    ///< recordings analysed by this run
  std::size_t to_analyse = 0;  ///< recordings that this run has to analyse
  double per_second = 0.0;
};

struct RunOptions {
  Shard shard;
  unsigned jobs = 1;          ///< threads; 0: as many as the machine has
  recording::Input format{};  ///< layout of every recording; its path does not count
  std::string axis = "all";   ///< x, y, z or all
  std::function<void(const Progress&)> on_progress;
};

struct BadRecording {
  std::string name;
  std::string problem;
};

struct RunSummary {
  std::size_t total = 0;          ///< recordings of the shard
  std::size_t analysed = 0;       ///< recordings analysed by this run
  std::size_t found_done = 0;     ///< stored by earlier runs
  std::size_t repeated = 0;       ///< same content as another one
  double seconds = 0.0;           ///< wall time
  std::vector<BadRecording> bad;  ///< bad recordings of this run and earlier ones, by name
};

/// Analyses the recordings that the database does not hold yet. A recording that cannot be used is
/// stored with its problem; one that cannot be read is tried again by the next run. May be killed
/// at any moment and started again: stored results stay, and nothing is stored twice. Memory: one
/// recording a job.
[[nodiscard]] RunSummary run(const std::vector<Entry>& recordings, Database& database,
                             const RunOptions& options);

}  // namespace zerorate::fleet
