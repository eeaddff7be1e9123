/// @file
/// A place that keeps one record while the power is off.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/result.hpp"

namespace zerorate::hal {

/// Reasons why a record could not be kept or given back.
enum class StorageError : std::uint8_t {
  empty,      ///< nothing was ever saved
  corrupt,    ///< something was saved, and none of it is intact
  too_large,  ///< the record does not fit: into the place, or into the caller's buffer
  full,       ///< no space is left on the medium
  io,         ///< anything else that the medium or its operating system reports
};

/// For logs.
[[nodiscard]] constexpr std::string_view name(StorageError error) {
  switch (error) {
    case StorageError::empty:
      return "nothing saved";
    case StorageError::corrupt:
      return "both slots are damaged";
    case StorageError::too_large:
      return "too large";
    case StorageError::full:
      return "no space left";
    case StorageError::io:
      return "input/output error";
  }
  return "unknown";
}

/// `save(record)` keeps the bytes; `load(buffer)` gives back those of the newest save that
/// succeeded, and how many they are.
///
/// For authors of applications:
/// - What a record means, and whether it fits the program that reads it, is yours to check: begin
///   it with a version.
/// - After an error of save() the record before it is still there.
///
/// For authors of back ends:
/// - A power cut at any moment of save() leaves either the record before it or the new one, never a
///   mixture: keep two slots and a checksum, and never write over the newest.
/// - save() may block for as long as the medium takes. Not from an interrupt, nor from the thread
///   that reads the sensor.
template <class Medium>
concept Storage = requires(Medium& medium, std::span<std::uint8_t> buffer,
                           std::span<const std::uint8_t> record) {
  { medium.load(buffer) } -> std::same_as<core::Result<std::size_t, StorageError>>;
  { medium.save(record) } -> std::same_as<core::Result<void, StorageError>>;
};

}  // namespace zerorate::hal
