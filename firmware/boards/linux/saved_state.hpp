/// @file
/// The node's memory as a record for a Storage.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "firmware/boards/linux/configuration.hpp"

namespace zerorate::linux_node {

/// Identifies one start of the kernel, as /proc/sys/kernel/random/boot_id gives it.
using BootId = std::array<char, 36>;

/// Throws std::system_error where the kernel does not tell.
[[nodiscard]] BootId read_boot_id();

/// Converts states of one node to records and back. A record is taken back only by the same
/// version of the program, for a node with the same parameters, and in the same boot: the state
/// holds times of CLOCK_MONOTONIC, and a gyro that was switched off has another bias afterwards.
class StateRecord {
 public:
  static constexpr std::size_t kHeaderBytes = 4 + sizeof(BootId);
  static constexpr std::size_t kBytes = kHeaderBytes + sizeof(Node::State);
  using Bytes = std::array<std::uint8_t, kBytes>;

  StateRecord(const Node::Params& params, const BootId& boot);

  [[nodiscard]] Bytes encode(const Node::State& state) const;
  /// nullopt where the record is another program's, node's or boot's.
  [[nodiscard]] std::optional<Node::State> decode(std::span<const std::uint8_t> record) const;

 private:
  std::array<std::uint8_t, kHeaderBytes> header_{};
};

}  // namespace zerorate::linux_node
