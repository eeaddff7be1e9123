/// @file
/// Predictors that people have already, beside the node in a replay of their log.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/recording/input.hpp"

namespace zerorate::contest {

/// Predictor that the node is compared with.
struct Rival {
  enum class Kind : std::uint8_t { last_mean, exponential, column, script };

  Kind kind = Kind::last_mean;
  double memory_s = 0.0;             ///< memory of an exponential mean of the samples at rest [s]
  std::vector<std::string> columns;  ///< columns of bias estimates: one for a single axis, or three
  std::string command;               ///< command line of a program that predicts
  double limit_s = 60.0;             ///< time of the program for a log

  [[nodiscard]] std::string name() const;
};

/// Reads "last-mean", "exponential:SECONDS", "column:NAME[,NAME,NAME]" or "script:COMMAND". Throws
/// std::invalid_argument.
[[nodiscard]] Rival parse_rival(std::string_view text);

/// Bias by a predictor that is not the node's, over one replay. Biases are NaN where there is none.
class RivalBias {
 public:
  virtual ~RivalBias() = default;
  RivalBias() = default;
  RivalBias(const RivalBias&) = delete;
  RivalBias& operator=(const RivalBias&) = delete;

  /// Takes each sample of the replay.
  void take(const evaluate::ReplayedSample& sample);

  /// Bias that it predicts after the newest sample [rad/s].
  [[nodiscard]] double bias_rad_s(std::size_t axis) const { return bias_rad_s_[axis]; }
  /// Bias that it predicted for the newest stop, before that began [rad/s].
  [[nodiscard]] double held_rad_s(std::size_t axis) const { return held_rad_s_[axis]; }

 protected:
  using Biases = std::array<double, 3>;

  /// Bias after a sample.
  /// @param before  bias before it
  virtual Biases follow(const evaluate::ReplayedSample& sample, const Biases& before) = 0;

 private:
  Biases bias_rad_s_ = kUnknown;
  Biases driven_rad_s_ = kUnknown;  ///< after the newest departure or sample in motion
  Biases held_rad_s_ = kUnknown;
  bool stood_ = false;
  bool has_driven_ = false;  ///< since the newest rest
  evaluate::MotionOfReplay motion_;

  static const Biases kUnknown;
};

/// The rival of a log, which is read besides where that needs it; nullptr for the mean of the last
/// stop, which the node has. A program runs once, before: over the rows at rest of the whole log.
/// @param input  the log
/// @param axes  axes that are compared
/// Throws recording::Error, recording::DataError where a program fails or is late, and
/// std::invalid_argument.
[[nodiscard]] std::unique_ptr<RivalBias> make_rival(const Rival& rival,
                                                    const recording::Input& input,
                                                    const std::vector<std::size_t>& axes,
                                                    const evaluate::ReplayOptions& replay);

}  // namespace zerorate::contest
