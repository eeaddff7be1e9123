/// @file
/// A program that predicts biases from the rows at rest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace zerorate::contest {

/// A command line of /bin/sh that reads a file and writes an answer, for a limited time.
class Script {
 public:
  /// @param limit_s  time that it may take
  Script(std::string command, double limit_s);

  /// Standard input of the program, to be written before it runs.
  [[nodiscard]] std::FILE* input() const { return input_.get(); }

  /// Runs it to its end, and gives what it wrote on its standard output. Throws
  /// recording::DataError where it fails, with the end of its error output, or takes longer than
  /// the limit: it is ended then.
  [[nodiscard]] std::string run();

 private:
  struct Close {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;

  static File temporary_file();
  static std::string text_of(std::FILE* file);

  std::string command_;
  double limit_s_;
  File input_ = temporary_file();
  File output_ = temporary_file();
  File errors_ = temporary_file();
};

/// Reads the answer of a program: for each stop a line with the bias of each axis [deg/s],
/// separated by commas; lines of words are skipped before the first. Biases are in rad/s. Throws
/// recording::DataError.
[[nodiscard]] std::vector<std::array<double, 3>> biases_of(std::string_view answer,
                                                           std::size_t stops, std::size_t axes);

}  // namespace zerorate::contest
