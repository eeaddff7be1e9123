/// @file
/// Reasons to doubt a recording at rest, and the user's word that overrules them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace zerorate::identify {

/// Names of doubts, as a user types them.
namespace doubt {
inline constexpr std::string_view kCounts = "counts";
inline constexpr std::string_view kUnit = "unit";
inline constexpr std::string_view kMotion = "motion";
inline constexpr std::string_view kAngles = "angles";
inline constexpr std::string_view kPeriod = "period";
inline constexpr std::string_view kSensors = "sensors";
inline constexpr std::string_view kFrozen = "frozen";
inline constexpr std::string_view kCopies = "copies";
inline constexpr std::string_view kBias = "bias";
inline constexpr std::string_view kTruncation = "truncation";
}  // namespace doubt

/// A reason to doubt a recording at rest.
struct RestDoubt {
  std::string_view name;   ///< for the user who overrules it, one of doubt_names()
  std::string sentence;    ///< with the figure that shows it, and what to do
  bool is_certain = true;  ///< results would mean nothing
  std::optional<std::size_t> axis = std::nullopt;  ///< the only axis in doubt; otherwise all are
};

/// Names of doubts that a user overrules, as typed: "counts,motion".
class AcceptedDoubts {
 public:
  AcceptedDoubts() = default;
  /// Throws std::invalid_argument for a name that no doubt has.
  explicit AcceptedDoubts(std::string_view names);
  [[nodiscard]] bool has(std::string_view name) const;

 private:
  std::vector<std::string_view> names_;
};

/// "counts, unit, angles ...".
[[nodiscard]] std::string doubt_names();

/// Judges the axes that a user wants. An axis of which a doubt is certain is left out as long as
/// another one remains. Accepted doubts, and those of axes that nobody wants, are none.
/// @param axes  indices; those left out are taken away
/// @return sentences of doubts that leave something to do; each names the option that overrules it
/// Throws recording::DataError with the first doubt that is certain and leaves no axis.
[[nodiscard]] std::vector<std::string> require_rest(const std::vector<RestDoubt>& doubts,
                                                    const AcceptedDoubts& accepted,
                                                    std::vector<std::size_t>& axes);
}  // namespace zerorate::identify
