/// @file
/// Outcomes of a record of a node that is to be taken up, and their names in logs.
#pragma once

#include <cstdint>
#include <string_view>

namespace zerorate::app {

/// Why a record is not taken up. The node then starts from nothing, as without a record.
enum class SnapshotRefusal : std::uint8_t {
  not_a_snapshot,  ///< another size, or not our mark
  damaged,         ///< the checksum is wrong
  other_layout,    ///< a version whose records mean something else
  other_sensor,
  impossible,       ///< no node remembers such numbers, though the checksum is right
  nothing_learnt,   ///< it was saved before the node was calibrated
  turn_on_unknown,  ///< the power was off, and the model does not say what that changes
  /// Saved with another model: of it the biases alone are taken up, and this model has no turn-on
  /// variance for them.
  other_model,
};

/// For logs.
[[nodiscard]] constexpr std::string_view name(SnapshotRefusal refusal) {
  switch (refusal) {
    case SnapshotRefusal::not_a_snapshot:
      return "not a record of a node";
    case SnapshotRefusal::damaged:
      return "damaged";
    case SnapshotRefusal::other_layout:
      return "saved by another version";
    case SnapshotRefusal::other_sensor:
      return "saved with another gyro";
    case SnapshotRefusal::impossible:
      return "numbers that no node remembers";
    case SnapshotRefusal::nothing_learnt:
      return "saved before anything was learnt";
    case SnapshotRefusal::turn_on_unknown:
      return "saved in another boot, and the model has no [turn_on]";
    case SnapshotRefusal::other_model:
      return "saved with another model, and this one has no [turn_on] to widen its bias by";
  }
  return "unknown";
}

/// Outcome of a record that was taken up.
enum class Resumption : std::uint8_t {
  continued,      ///< bit for bit, as if there had been no pause
  aged,           ///< aged by the time on the clock since then
  aged_by_a_day,  ///< no clock: assume a day, so the interval is never too narrow
  bias_alone,     ///< the model is another: aged likewise, and the noise is learnt anew
};

/// For logs.
[[nodiscard]] constexpr std::string_view name(Resumption resumption) {
  switch (resumption) {
    case Resumption::continued:
      return "nothing lost";
    case Resumption::aged:
      return "aged by the time since it was saved";
    case Resumption::aged_by_a_day:
      return "aged by a day, for the clock does not tell";
    case Resumption::bias_alone:
      return "the bias alone, for the model has changed";
  }
  return "unknown";
}

}  // namespace zerorate::app
