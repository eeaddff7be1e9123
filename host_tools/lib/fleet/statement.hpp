/// @file
/// Statements of SQLite.
#pragma once

#include <fmt/format.h>
#include <sqlite3.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/fleet/analysis.hpp"

namespace zerorate::fleet {

/// Throws what a database has last refused, as std::runtime_error that names the file.
[[noreturn]] inline void fail(sqlite3* database, const std::filesystem::path& path) {
  const int code = database == nullptr ? SQLITE_NOMEM : sqlite3_errcode(database);
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED) {
    throw std::runtime_error(path.string() +
                             ": another process has locked this database for too long");
  }
  throw std::runtime_error(
      path.string() + ": " +
      (database == nullptr ? "no memory" : std::string(sqlite3_errmsg(database))));
}

/// A prepared statement.
class Statement {
 public:
  Statement(sqlite3* database, const std::filesystem::path& path, const std::string& text)
      : database_(database), path_(path) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database, text.c_str(), -1, &statement, nullptr) != SQLITE_OK) {
      fail(database, path);
    }
    statement_.reset(statement);
  }

  template <class... Values>
  Statement& bind(const Values&... values) {
    sqlite3_reset(get());
    int place = 0;
    (bind_one(++place, values), ...);
    return *this;
  }
  /// Whether there is a row.
  bool step() {
    const int code = sqlite3_step(get());
    if (code != SQLITE_ROW && code != SQLITE_DONE) fail(database_, path_);
    return code == SQLITE_ROW;
  }

  [[nodiscard]] std::string text(int column) const {
    const auto* const bytes = static_cast<const char*>(sqlite3_column_blob(get(), column));
    return bytes == nullptr ? std::string{} : std::string(bytes, size(column));
  }
  [[nodiscard]] double real(int column) const { return sqlite3_column_double(get(), column); }
  [[nodiscard]] std::optional<double> maybe_real(int column) const {
    if (sqlite3_column_type(get(), column) == SQLITE_NULL) return std::nullopt;
    return real(column);
  }
  [[nodiscard]] std::int64_t integer(int column) const {
    return sqlite3_column_int64(get(), column);
  }
  /// Throws where the column has another size than the grid.
  [[nodiscard]] std::vector<float> floats(int column) const {
    const void* const bytes = sqlite3_column_blob(get(), column);
    std::vector<float> values(size(column) / sizeof(float));
    if (values.size() != Grid::kCells || size(column) % sizeof(float) != 0) {
      throw std::runtime_error(path_.string() + ": a likelihood has not the size of the grid");
    }
    std::memcpy(values.data(), bytes, size(column));
    return values;
  }
  /// Any value as text, in which a number has all its digits.
  [[nodiscard]] std::string printed(int column) const {
    switch (sqlite3_column_type(get(), column)) {
      case SQLITE_FLOAT:
        return fmt::format("{}", real(column));
      case SQLITE_INTEGER:
        return fmt::format("{}", integer(column));
      case SQLITE_NULL:
        return "NULL";
      case SQLITE_BLOB: {
        std::string hexadecimal;
        for (const char byte : text(column)) {
          hexadecimal += fmt::format("{:02x}", static_cast<unsigned char>(byte));
        }
        return hexadecimal;
      }
      default:
        return text(column);
    }
  }
  [[nodiscard]] int columns() const { return sqlite3_column_count(get()); }

 private:
  struct Finaliser {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };

  [[nodiscard]] sqlite3_stmt* get() const { return statement_.get(); }
  [[nodiscard]] std::size_t size(int column) const {
    return static_cast<std::size_t>(sqlite3_column_bytes(get(), column));
  }
  void check(int code) const {
    if (code != SQLITE_OK) fail(database_, path_);
  }
  void bind_one(int place, std::string_view text) const {
    check(
        sqlite3_bind_text64(get(), place, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
  }
  void bind_one(int place, double number) const {
    check(sqlite3_bind_double(get(), place, number));
  }
  void bind_one(int place, std::int64_t number) const {
    check(sqlite3_bind_int64(get(), place, number));
  }
  void bind_one(int place, const std::optional<double>& number) const {
    check(number ? sqlite3_bind_double(get(), place, *number) : sqlite3_bind_null(get(), place));
  }
  void bind_one(int place, const std::vector<float>& values) const {
    check(sqlite3_bind_blob64(get(), place, values.data(), values.size() * sizeof(float),
                              SQLITE_TRANSIENT));
  }

  sqlite3* database_;
  const std::filesystem::path& path_;
  std::unique_ptr<sqlite3_stmt, Finaliser> statement_;
};

}  // namespace zerorate::fleet
