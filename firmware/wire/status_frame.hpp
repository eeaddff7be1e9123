/// @file
/// Counters of the node as bytes; see docs/reference/rate-frame.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/crc32.hpp"
#include "core/base/result.hpp"
#include "firmware/app/node_loop.hpp"
#include "firmware/wire/little_endian.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::wire {

inline constexpr std::size_t kStatusFrameBytes = 56;
using StatusFrame = std::array<std::uint8_t, kStatusFrameBytes>;

struct Status {
  app::LoopCounters counters;
  std::uint32_t frames_dropped = 0;  ///< frames without room on the line

  constexpr bool operator==(const Status&) const = default;
};

namespace detail {
inline constexpr std::uint16_t kStatusMagic = 0x535A;  // "ZS"

/// The counters in the order of the frame.
[[nodiscard]] constexpr auto counters_of(auto& status) {
  auto& counters = status.counters;
  return std::array{&counters.samples,         &counters.pulses,      &counters.pulses_lost,
                    &counters.odometer_errors, &counters.starts,      &counters.start_errors,
                    &counters.read_errors,     &counters.overruns,    &counters.configurations_lost,
                    &counters.silences,        &status.frames_dropped};
}
}  // namespace detail

[[nodiscard]] constexpr StatusFrame encode_status_frame(const Status& status) {
  StatusFrame frame{};
  LittleEndianWriter out{frame};
  out.put(detail::kStatusMagic);
  out.put(detail::kVersion);
  out.put(std::uint8_t{0});
  for (const std::uint32_t* counter : detail::counters_of(status)) out.put(*counter);
  const drivers::DriverError& last = status.counters.last_error;
  out.put(static_cast<std::uint8_t>(last.code));
  out.put(static_cast<std::uint8_t>(last.bus));
  out.put(last.reg);
  out.put(std::uint8_t{0});
  out.put(core::crc32(std::span{frame}.first<kStatusFrameBytes - detail::kChecksumBytes>()));
  return frame;
}

/// The inverse, for bytes of any origin.
[[nodiscard]] constexpr core::Result<Status, FrameError> decode_status_frame(
    std::span<const std::uint8_t> bytes) {
  using core::Unexpected;
  if (bytes.size() != kStatusFrameBytes) return Unexpected{FrameError::wrong_size};
  LittleEndianReader in{bytes};
  if (in.take<std::uint16_t>() != detail::kStatusMagic) return Unexpected{FrameError::not_a_frame};
  if (in.take<std::uint8_t>() != detail::kVersion) return Unexpected{FrameError::unknown_version};
  (void)in.take<std::uint8_t>();
  constexpr std::size_t kChecked = kStatusFrameBytes - detail::kChecksumBytes;
  LittleEndianReader checksum{bytes.subspan(kChecked)};
  if (checksum.take<std::uint32_t>() != core::crc32(bytes.first(kChecked))) {
    return Unexpected{FrameError::wrong_checksum};
  }
  Status status;
  for (std::uint32_t* counter : detail::counters_of(status)) *counter = in.take<std::uint32_t>();
  const auto code = in.take<std::uint8_t>();
  const auto bus = in.take<std::uint8_t>();
  status.counters.last_error = {.code = static_cast<drivers::DriverErrorCode>(code),
                                .bus = static_cast<hal::BusError>(bus),
                                .reg = in.take<std::uint8_t>()};
  return status;
}

}  // namespace zerorate::wire
