/// @file
/// Answers of a campaign, counted.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "host_tools/lab/campaign/answer.hpp"
#include "host_tools/lab/campaign/blind_recording.hpp"
#include "host_tools/lab/campaign/rates.hpp"

namespace zerorate::campaign {

/// Bars that the whole campaign must meet.
struct Bar {
  std::string what;
  Rate rate;
  double bar = 0.0;
  bool at_least = true;

  [[nodiscard]] bool holds() const { return at_least ? rate.share() >= bar : rate.share() <= bar; }
};

/// One row of the confusion matrix: of all recordings with the same truth.
struct Row {
  std::size_t runs = 0;
  std::size_t named = 0;
  std::size_t first_and_alone = 0;
  std::size_t alternative = 0;
  std::map<std::string, std::size_t> verdicts;
  std::map<std::string, std::size_t> answers;  ///< key: strongest cause, or the verdict without one
};

class Tally {
 public:
  explicit Tally(const BlindOptions& options) : options_(options) {}

  void add(std::size_t run, const BlindRecording& blind, const Answer& answer);

  [[nodiscard]] std::vector<Bar> bars() const;
  /// One line for each recording whose answer was not the right one.
  [[nodiscard]] const std::vector<std::string>& misses() const { return misses_; }
  /// Coverage: the share of named effects whose 95 % interval of a parameter held the truth.
  [[nodiscard]] const std::map<std::string, Rate>& coverage() const { return coverage_; }
  /// Bars, coverage, confusion matrix and misses.
  [[nodiscard]] std::string markdown() const;
  [[nodiscard]] std::string json() const;

 private:
  void count_certainties(const BlindRecording& blind, const Answer& answer);
  void count_coverage(const BlindRecording& blind, const Answer& answer);
  [[nodiscard]] std::string matrix() const;
  [[nodiscard]] std::string coverage_table() const;

  BlindOptions options_;
  std::map<std::string, Row> rows_;
  Rate named_;
  Rate first_and_alone_;
  Rate both_named_;
  Rate false_alarms_;
  Rate outside_unexplained_;
  Rate wrong_;
  Reliability reliability_;  ///< causes of answers `explained`
  Rate in_set95_;            ///< rate of sets that hold a hidden effect
  std::map<std::string, Rate> coverage_;
  std::vector<std::string> misses_;
};

}  // namespace zerorate::campaign
