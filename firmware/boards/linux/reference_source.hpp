/// @file
/// References of the heading, which other programs or the vehicle send as messages.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "core/base/earth_rate.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "firmware/app/reference_track.hpp"
#include "firmware/boards/linux/message_source.hpp"

namespace zerorate::linux_node {

struct ReferenceSettings {
  core::UpAxis up;
  MessageOrigin origin;          ///< origin of headings in degrees
  bool counts_clockwise = true;  ///< sense of a compass and of a GNSS course
  core::Angle sigma;             ///< standard deviation of what states none
  core::Duration latency;        ///< from the vehicle's heading to its message
};

using Reference = std::variant<app::HeadingReference, app::TurnReference>;

/// Reference that a message states; nullopt where it is none.
///
/// A datagram holds `HEADING`, `HEADING SIGMA` or `turn ANGLE SIGMA SECONDS`. Angles are in
/// degrees. The vehicle turned by ANGLE in the newest SECONDS. A signal of a CAN bus is a heading.
[[nodiscard]] std::optional<Reference> decode_reference(const ReferenceSettings& settings,
                                                        const Message& message, core::Instant now);

/// Time that a reference is about, the later end of a turn.
[[nodiscard]] core::Instant time_of(const Reference& reference);

/// The references that come, one after the other, stamped when they are read.
class ReferenceSource {
 public:
  explicit ReferenceSource(const ReferenceSettings& settings)
      : settings_(settings), messages_(settings.origin) {}

  /// The next reference that waits. A message that is none is counted, and passed over.
  [[nodiscard]] std::optional<Reference> next(core::Instant now);
  /// Messages that were no references.
  [[nodiscard]] std::uint32_t not_understood() const { return not_understood_; }
  /// Reason for which no message can come, as the kernel gave it; 0: none.
  [[nodiscard]] int error_number() const {
    return messages_.descriptor() < 0 ? messages_.error_number() : 0;
  }

 private:
  ReferenceSettings settings_;
  MessageSource messages_;
  std::uint32_t not_understood_ = 0;
};

}  // namespace zerorate::linux_node
