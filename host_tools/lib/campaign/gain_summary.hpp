/// @file
/// Gain of the extended models of a campaign on the data held out, effect by effect.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host_tools/lib/campaign/answer.hpp"
#include "host_tools/lib/statistics/bootstrap.hpp"

namespace zerorate::campaign {

/// The gains of all recordings that hid one effect, and named it.
class GainSummary {
 public:
  GainSummary(std::string effect, std::uint64_t seed) : effect_(std::move(effect)), seed_(seed) {}

  /// Counts an answer that has a gain.
  void add(const Gain& gain) { gains_.push_back(gain); }
  [[nodiscard]] std::size_t size() const { return gains_.size(); }

  /// Median over the recordings, and its interval by drawing recordings.
  [[nodiscard]] statistics::BootstrapFigure median(double Gain::*figure) const;
  /// Mean over the recordings; of coverages that over all drives, for each recording has as many.
  [[nodiscard]] statistics::BootstrapFigure mean(double Gain::*figure) const;

  /// The bars: a log score that is surely better (the whole interval of the median), errors not
  /// worse by more than 1 %, and a coverage between 0.93 and 0.97.
  [[nodiscard]] bool scores_better() const;
  [[nodiscard]] bool errs_no_more() const;
  [[nodiscard]] bool covers() const;

  /// Row of a table; see header().
  [[nodiscard]] std::string row() const;
  [[nodiscard]] static std::string header();

 private:
  std::string effect_;
  std::uint64_t seed_;
  std::vector<Gain> gains_;
};

}  // namespace zerorate::campaign
