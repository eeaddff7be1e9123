/// @file
/// Worth of the extended models on the data held out, over the recordings of a campaign.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/lab/campaign/answer.hpp"
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

}  // namespace zerorate::campaign
