/// @file
/// A value in a scan of the kernel's Industrial I/O subsystem (IIO).
///
/// Source: Documentation/ABI/testing/sysfs-bus-iio of Linux 6.1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace zerorate::hal::linux_os {

/// Where a value stands in a scan, and how: "le:s16/16>>0".
struct IioElement {
  bool is_big_endian = false;
  bool is_signed = false;
  unsigned bits = 0;
  unsigned bytes = 0;  ///< size in the buffer: 1, 2, 4 or 8
  unsigned shift = 0;  ///< shift to the right before the bits are taken
  std::size_t offset = 0;

  [[nodiscard]] std::int64_t decode(std::span<const std::uint8_t> scan) const;
};
/// Throws KernelFileError, which names `path`. The offset is left at 0.
[[nodiscard]] IioElement parse_iio_type(std::string_view type, const std::string& path);

}  // namespace zerorate::hal::linux_os
