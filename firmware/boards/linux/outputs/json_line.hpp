/// @file
/// A rate message as one line of JSON.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "firmware/wire/learnt_frame.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::linux_node {

/// Long enough for every message, whatever its numbers are.
using JsonBuffer = std::array<char, 2560>;

/// The message with its newline, in the buffer: see docs/reference/zerorated.md. Numbers are the
/// shortest decimals that give back the same single-precision bits, in deg/s; the rates are null in
/// a message without a rate, the deviations in one without calibration. No heap.
/// @param node  of whom the message is, the member "node"; empty: the line has none
/// @param learnt  becomes the member "learnt"; nullptr: the line has none
[[nodiscard]] std::string_view format_json_line(const wire::NumberedMessage& message,
                                                JsonBuffer& buffer, std::string_view node = {},
                                                const wire::LearntModel* learnt = nullptr);

}  // namespace zerorate::linux_node
