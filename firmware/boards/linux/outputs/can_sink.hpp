/// @file
/// Messages as frames of a CAN bus, through SocketCAN.
#pragma once

#include <cstdint>
#include <memory>

#include "firmware/boards/linux/outputs/sink_settings.hpp"
#include "firmware/boards/linux/outputs/sinks.hpp"

namespace zerorate::linux_node {

/// Whether a CAN controller is bus-off after a frame of the kernel.
/// @param can_id  of the frame; others than error frames change nothing
[[nodiscard]] bool is_bus_off_after(std::uint32_t can_id, bool is_bus_off);

/// The interface may be absent or down, at the start and later. Throws std::invalid_argument where
/// its name is none.
[[nodiscard]] std::unique_ptr<Sink> make_can_sink(const CanSettings& settings);

}  // namespace zerorate::linux_node
