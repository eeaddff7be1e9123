/// @file
/// The right to write to a database, of one process at a time.
#pragma once

#include <filesystem>

namespace zerorate::fleet {

/// Held from one transaction to the next, which the locks of SQLite are only by keeping readers
/// out. The lock is of one byte behind all that a database may hold, so it meets none of SQLite's.
class WriterLock {
 public:
  /// Makes the file if it is not there. Throws std::runtime_error, which names it, where another
  /// process has the right, and std::system_error where the file cannot be opened.
  explicit WriterLock(const std::filesystem::path& database);
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;
  ~WriterLock();

 private:
  int descriptor_;
};

}  // namespace zerorate::fleet
