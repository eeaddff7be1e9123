#include "host_tools/lib/fleet/database.hpp"

#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "host_tools/lib/fleet/left_files.hpp"
#include "host_tools/lib/fleet/statement.hpp"
#include "host_tools/lib/output/output_file.hpp"

namespace zerorate::fleet {
namespace {

constexpr const char* kSchema = R"(
CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE recording(hash TEXT PRIMARY KEY, name TEXT NOT NULL, sensor TEXT NOT NULL,
  lot TEXT NOT NULL, problem TEXT NOT NULL, rows INTEGER NOT NULL, sample_period_s REAL NOT NULL,
  rest_s REAL NOT NULL) WITHOUT ROWID;
CREATE TABLE axis(hash TEXT, axis TEXT, angle_random_walk_rad_per_sqrt_s REAL NOT NULL,
  angle_random_walk_error REAL NOT NULL, bias_instability_rad_s REAL, bias_instability_error REAL,
  "order" REAL, order_error REAL, mean_rate_rad_s REAL NOT NULL,
  temperature_slope_rad_s_per_k REAL, temperature_slope_error REAL, verdict TEXT NOT NULL,
  adequacy_p_value REAL NOT NULL, remark TEXT NOT NULL, innovations INTEGER NOT NULL,
  log_likelihood BLOB NOT NULL, white BLOB NOT NULL, PRIMARY KEY(hash, axis)) WITHOUT ROWID;
CREATE TABLE cause(hash TEXT, axis TEXT, place INTEGER, effect TEXT NOT NULL,
  gain_nats REAL NOT NULL, p_value REAL NOT NULL, probability REAL NOT NULL,
  may_be_order INTEGER NOT NULL, PRIMARY KEY(hash, axis, place)) WITHOUT ROWID;
)";
/// Name of SQLite for a database of this process alone, without a file.
constexpr const char* kInMemory = ":memory:";
/// Tables with the columns of their keys.
constexpr std::array kTables = {std::pair{"meta", "1"}, std::pair{"recording", "1"},
                                std::pair{"axis", "1, 2"}, std::pair{"cause", "1, 2, 3"}};

AxisResult axis_of(const Statement& row) {
  return {.axis = row.text(1),
          .angle_random_walk_rad_per_sqrt_s = row.real(2),
          .angle_random_walk_error = row.real(3),
          .bias_instability_rad_s = row.maybe_real(4),
          .bias_instability_error = row.maybe_real(5),
          .order = row.maybe_real(6),
          .order_error = row.maybe_real(7),
          .mean_rate_rad_s = row.real(8),
          .temperature_slope_rad_s_per_k = row.maybe_real(9),
          .temperature_slope_error = row.maybe_real(10),
          .verdict = row.text(11),
          .adequacy_p_value = row.real(12),
          .remark = row.text(13),
          .causes = {},
          .innovations = static_cast<std::size_t>(row.integer(14)),
          .log_likelihood = row.floats(15),
          .white = row.floats(16)};
}

}  // namespace

void Database::Closer::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

Database::Database(const std::filesystem::path& path, Access access) : path_(path) {
  if (access == Access::write && path != kInMemory)
    lock_ = std::make_unique<const WriterLock>(path);
  // Also to be read: what a process that was killed has left half is rolled back.
  const int flags = SQLITE_OPEN_READWRITE | (access == Access::write ? SQLITE_OPEN_CREATE : 0);
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &handle, flags | SQLITE_OPEN_FULLMUTEX, nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) fail(handle, path_);
  // A reader waits for a transaction, and a writer for readers, who read all recordings.
  constexpr int kReaderPatience_ms = 10'000;
  constexpr int kWriterPatience_ms = 600'000;
  const bool writes = access == Access::write;
  sqlite3_busy_timeout(handle, writes ? kWriterPatience_ms : kReaderPatience_ms);
  execute(writes ? "PRAGMA journal_mode = DELETE; PRAGMA synchronous = FULL" : "BEGIN");
  check_engine(access);
}

std::string Database::engine() {
  return fmt::format("zerorate {}, analysis {}", ZERORATE_VERSION, kAnalysisVersion);
}

void Database::check_engine(Access access) {
  if (access == Access::write) {
    Statement tables{handle_.get(), path_, "SELECT COUNT(*) FROM sqlite_master"};
    static_cast<void>(tables.step());
    if (tables.integer(0) == 0) {
      execute(fmt::format("BEGIN;{}INSERT INTO meta VALUES('engine', '{}'); COMMIT", kSchema,
                          engine()));
      return;
    }
  }
  std::string found;
  {
    Statement tables{handle_.get(), path_,
                     "SELECT COUNT(*) FROM sqlite_master WHERE name IN ('meta', 'recording', "
                     "'axis', 'cause')"};
    static_cast<void>(tables.step());
    if (tables.integer(0) != static_cast<std::int64_t>(kTables.size())) {
      throw std::runtime_error(path_.string() + ": this is no database of zerorate fleet run");
    }
    Statement engines{handle_.get(), path_, "SELECT value FROM meta WHERE key = 'engine'"};
    if (engines.step()) found = engines.text(0);
  }
  if (found != engine()) {
    throw std::runtime_error(fmt::format(
        "{}: written by \"{}\", and this is \"{}\"; figures of two engines are not comparable. Run "
        "the recordings again into another database, or use that program.",
        path_.string(), found, engine()));
  }
}

void Database::require_format(const std::string& options) {
  const std::string found = format();
  if (found == options) return;
  if (size() > 0) {
    throw std::runtime_error(fmt::format(
        "{}: its recordings were read with {}, and now with {}; figures of two readings are not "
        "comparable. Run the recordings again into another database, or use those options.",
        path_.string(), found.empty() ? "no options" : found, options.empty() ? "none" : options));
  }
  Statement{handle_.get(), path_, "INSERT OR REPLACE INTO meta VALUES('format', ?1)"}
      .bind(std::string_view{options})
      .step();
}

std::string Database::format() const {
  Statement found{handle_.get(), path_, "SELECT value FROM meta WHERE key = 'format'"};
  return found.step() ? found.text(0) : std::string{};
}

void Database::execute(const std::string& statements) const {
  if (sqlite3_exec(handle_.get(), statements.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    fail(handle_.get(), path_);
  }
}

std::optional<std::string> Database::problem_of(std::string_view hash) const {
  Statement found{handle_.get(), path_, "SELECT problem FROM recording WHERE hash = ?1"};
  if (!found.bind(hash).step()) return std::nullopt;
  return found.text(0);
}

void Database::store(const StoredRecording& recording) {
  execute("BEGIN IMMEDIATE");
  try {
    const RecordingResult& result = recording.result;
    for (const char* table : {"axis", "cause"}) {
      Statement old{handle_.get(), path_, fmt::format("DELETE FROM {} WHERE hash = ?1", table)};
      old.bind(std::string_view{recording.hash}).step();
    }
    Statement{handle_.get(), path_, "INSERT OR REPLACE INTO recording VALUES(?,?,?,?,?,?,?,?)"}
        .bind(recording.hash, recording.entry.name, recording.entry.sensor, recording.entry.lot,
              recording.problem, static_cast<std::int64_t>(result.rows), result.sample_period_s,
              result.rest_s)
        .step();
    Statement axes{handle_.get(), path_,
                   "INSERT INTO axis VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"};
    Statement causes{handle_.get(), path_, "INSERT INTO cause VALUES(?,?,?,?,?,?,?,?)"};
    for (const AxisResult& axis : result.axes) {
      axes.bind(recording.hash, axis.axis, axis.angle_random_walk_rad_per_sqrt_s,
                axis.angle_random_walk_error, axis.bias_instability_rad_s,
                axis.bias_instability_error, axis.order, axis.order_error, axis.mean_rate_rad_s,
                axis.temperature_slope_rad_s_per_k, axis.temperature_slope_error, axis.verdict,
                axis.adequacy_p_value, axis.remark, static_cast<std::int64_t>(axis.innovations),
                axis.log_likelihood, axis.white)
          .step();
      std::int64_t place = 0;
      for (const Cause& cause : axis.causes) {
        causes
            .bind(recording.hash, axis.axis, place++, cause.effect, cause.gain_nats, cause.p_value,
                  cause.probability, std::int64_t{cause.may_be_order ? 1 : 0})
            .step();
      }
    }
  } catch (...) {
    static_cast<void>(sqlite3_exec(handle_.get(), "ROLLBACK", nullptr, nullptr, nullptr));
    throw;
  }
  execute("COMMIT");
}

void Database::rename(std::string_view hash, const Entry& entry) {
  Statement{handle_.get(), path_,
            "UPDATE recording SET name = ?2, sensor = ?3, lot = ?4 WHERE hash = ?1 AND (name <> ?2 "
            "OR sensor <> ?3 OR lot <> ?4)"}
      .bind(hash, entry.name, entry.sensor, entry.lot)
      .step();
}

void Database::remove(std::string_view hash) {
  Statement{handle_.get(), path_, "DELETE FROM recording WHERE hash = ?1"}.bind(hash).step();
}

std::size_t Database::size() const {
  Statement count{handle_.get(), path_, "SELECT COUNT(*) FROM recording"};
  static_cast<void>(count.step());
  return static_cast<std::size_t>(count.integer(0));
}

void Database::for_each(const std::function<void(const StoredRecording&)>& take) const {
  Statement recordings{handle_.get(), path_, "SELECT * FROM recording ORDER BY hash"};
  Statement axes{handle_.get(), path_, "SELECT * FROM axis WHERE hash = ?1 ORDER BY axis"};
  Statement causes{handle_.get(), path_,
                   "SELECT * FROM cause WHERE hash = ?1 AND axis = ?2 ORDER BY place"};
  while (recordings.step()) {
    StoredRecording one{.hash = recordings.text(0),
                        .entry = {.path = recordings.text(1),
                                  .name = recordings.text(1),
                                  .sensor = recordings.text(2),
                                  .lot = recordings.text(3)},
                        .problem = recordings.text(4),
                        .result = {.rows = static_cast<std::size_t>(recordings.integer(5)),
                                   .sample_period_s = recordings.real(6),
                                   .rest_s = recordings.real(7)}};
    axes.bind(one.hash);
    while (axes.step()) {
      AxisResult axis = axis_of(axes);
      causes.bind(one.hash, axis.axis);
      while (causes.step()) {
        axis.causes.push_back({.effect = causes.text(3),
                               .gain_nats = causes.real(4),
                               .p_value = causes.real(5),
                               .probability = causes.real(6),
                               .may_be_order = causes.integer(7) != 0});
      }
      one.result.axes.push_back(std::move(axis));
    }
    take(one);
  }
}

std::string Database::dump() const {
  std::string text;
  for (const auto& [table, key] : kTables) {
    Statement rows{handle_.get(), path_, fmt::format("SELECT * FROM {} ORDER BY {}", table, key)};
    while (rows.step()) {
      text += table;
      for (int column = 0; column < rows.columns(); ++column) text += '\t' + rows.printed(column);
      text += '\n';
    }
  }
  return text;
}

void merge(const std::vector<std::filesystem::path>& shards, const std::filesystem::path& out) {
  namespace fs = std::filesystem;
  std::vector<fs::path> sources = shards;
  if (fs::exists(out)) sources.push_back(out);
  const fs::path work = fmt::format("{}.{}.merging", out.string(), ::getpid());
  const fs::path partial = fmt::format("{}.{}.partial", out.string(), ::getpid());
  const auto clean = [&] {
    std::error_code ignored;
    for (const fs::path& file : {work, partial, fs::path(work.string() + "-journal")}) {
      fs::remove(file, ignored);
    }
  };
  clean();
  remove_of_dead_processes(out);
  try {
    {
      Database joined{work, Database::Access::write};
      for (const fs::path& source : sources) {
        joined.require_format(Database{source, Database::Access::read}.format());
        Statement{joined.handle_.get(), joined.path_, "ATTACH ?1 AS shard"}
            .bind(source.string())
            .step();
        joined.execute(
            "BEGIN;"
            "INSERT INTO recording SELECT * FROM shard.recording WHERE true ON CONFLICT(hash) DO "
            "UPDATE SET name = excluded.name, sensor = excluded.sensor, lot = excluded.lot, "
            "problem = excluded.problem WHERE (excluded.name, excluded.sensor, excluded.lot, "
            "excluded.problem) < (name, sensor, lot, problem);"
            "INSERT OR IGNORE INTO axis SELECT * FROM shard.axis;"
            "INSERT OR IGNORE INTO cause SELECT * FROM shard.cause;"
            "COMMIT; DETACH shard");
      }
      joined.execute(
          "DELETE FROM recording WHERE hash LIKE 'missing:%' AND name IN (SELECT name FROM "
          "recording WHERE hash NOT LIKE 'missing:%')");
      Statement{joined.handle_.get(), joined.path_, "VACUUM INTO ?1"}.bind(partial.string()).step();
    }
    output::replace_file(partial, out);
  } catch (...) {
    clean();
    throw;
  }
  clean();
}

}  // namespace zerorate::fleet
