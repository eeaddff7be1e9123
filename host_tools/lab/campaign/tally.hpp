/// @file
/// Answers of a campaign, counted, and the gain of their extended models on the data held out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host_tools/lab/campaign/answer.hpp"
#include "host_tools/lab/campaign/scenario.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::campaign {

/// The gains of all recordings that hid one effect, and named it.
class GainSummary {
 public:
  GainSummary(std::string effect, std::uint64_t seed) : effect_(std::move(effect)), seed_(seed) {}

  /// Counts an answer that has a gain.
  /// @param is_in_model  the effect is an extension of the model that was written
  void add(const Gain& gain, bool is_in_model) {
    gains_.push_back(gain);
    if (is_in_model) ++extensions_;
  }
  [[nodiscard]] std::size_t size() const { return gains_.size(); }

  /// Median over the recordings, and its interval by drawing recordings.
  [[nodiscard]] statistics::BootstrapFigure median(double Gain::*figure) const;
  /// Mean over the recordings; of coverages that over all drives, for each recording has as many.
  [[nodiscard]] statistics::BootstrapFigure mean(double Gain::*figure) const;

  /// The bars: a log score that is surely better, or worse (the whole interval of the median),
  /// errors not worse by more than 1 %, and a coverage between 0.93 and 0.97.
  [[nodiscard]] bool scores_better() const;
  [[nodiscard]] bool scores_worse() const;
  [[nodiscard]] bool errs_no_more() const;
  [[nodiscard]] bool covers() const;

  /// Row of a table; see header().
  [[nodiscard]] std::string row() const;
  [[nodiscard]] static std::string header();

 private:
  std::string effect_;
  std::uint64_t seed_;
  std::vector<Gain> gains_;
  std::size_t extensions_ = 0;
};

/// A share of runs.
struct Rate {
  std::size_t hits = 0;
  std::size_t runs = 0;

  void count(bool hit) {
    ++runs;
    if (hit) ++hits;
  }
  [[nodiscard]] double share() const;
  /// The exact 95 % interval of Clopper and Pearson.
  [[nodiscard]] double lo95() const;
  [[nodiscard]] double hi95() const;
};

/// Tests that so many hits, or fewer (more), happen less than once in a thousand campaigns of a
/// tool whose true rate is p. More than that no test of few runs can assert.
[[nodiscard]] bool is_surely_below(const Rate& rate, double p);
[[nodiscard]] bool is_surely_above(const Rate& rate, double p);

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

/// Stated probabilities of causes against how often they were right: a reliability diagram.
class Reliability {
 public:
  void count(double probability, bool right);
  /// Mean distance between stated and right, weighed by the number of causes.
  [[nodiscard]] double expected_calibration_error() const;
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] std::string markdown() const;

 private:
  struct Bin {
    double stated = 0.0;  ///< sum
    Rate right;
  };
  std::array<Bin, 10> bins_;
};

class Tally {
 public:
  explicit Tally(const ScenarioOptions& options) : options_(options) {}

  void add(std::size_t run, const Scenario& scenario, const Answer& answer);

  [[nodiscard]] std::vector<Bar> bars() const;
  /// One line for each recording whose answer was not the right one.
  [[nodiscard]] const std::vector<std::string>& misses() const { return misses_; }
  /// Coverage: the share of named effects whose 95 % interval of a parameter held the truth.
  [[nodiscard]] const std::map<std::string, Rate>& coverage() const { return coverage_; }
  /// Bars, coverage, confusion matrix and misses.
  [[nodiscard]] std::string markdown() const;
  [[nodiscard]] std::string json() const;

 private:
  void count_certainties(const Scenario& scenario, const Answer& answer);
  void count_coverage(const Scenario& scenario, const Answer& answer);
  [[nodiscard]] std::string matrix() const;
  [[nodiscard]] std::string coverage_table() const;

  ScenarioOptions options_;
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
