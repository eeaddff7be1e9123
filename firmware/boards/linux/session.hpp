/// @file
/// When, and in which start of the machine, a snapshot of the node is taken.
#pragma once

#include <cstdint>

#include "firmware/app/snapshot.hpp"
#include "firmware/boards/linux/chips/gyro.hpp"

namespace zerorate::linux_node {

/// The kernel's boot id, as /proc/sys/kernel/random/boot_id gives it: within one boot the monotonic
/// clock goes on, and so, as a rule, does the gyro's power. Throws std::system_error where the
/// kernel does not tell.
[[nodiscard]] app::Session read_boot_id();

/// This session, now by the wall clock.
[[nodiscard]] app::SnapshotTime time_in(const app::Session& session);

/// Tells gyros apart that a configuration may name one after the other.
[[nodiscard]] std::uint32_t sensor_id(const GyroSettings& gyro);

}  // namespace zerorate::linux_node
