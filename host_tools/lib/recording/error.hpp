/// @file
/// Exceptions for recordings: data that cannot be used, and a file that cannot be read.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace zerorate::recording {

/// A place in a text file.
struct Place {
  std::string file;          ///< the path as the user gave it, or "standard input"
  std::uint64_t line = 0;    ///< counted from 1; 0 where no line is meant
  std::uint64_t column = 0;  ///< character in the line, counted from 1; 0 where none is meant
};

/// Data that cannot be used, e.g. a record that is too short or constant. what() is one line for
/// the user. Wrong usage throws std::invalid_argument.
class DataError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Thrown by Reader and Writer: what is wrong with a recording, where, and how to mend it. what()
/// is one line for the user:
///
///     run.csv:17:6: found "abc" as gx_dps; expected a number in deg/s. Leave the cell empty ...
class Error : public DataError {
 public:
  Error(Place place, std::string found, std::string expected, std::string mend);

  [[nodiscard]] const Place& place() const { return place_; }
  [[nodiscard]] const std::string& found() const { return found_; }
  [[nodiscard]] const std::string& expected() const { return expected_; }
  /// Sentence with the cure for the user.
  [[nodiscard]] const std::string& mend() const { return mend_; }

 private:
  Place place_;
  std::string found_;
  std::string expected_;
  std::string mend_;
};

/// The text in double quotes, cut after 60 bytes, with bytes that do not print as `\xNN`: safe to
/// show whatever the file holds.
[[nodiscard]] std::string excerpt(std::string_view text);

}  // namespace zerorate::recording
