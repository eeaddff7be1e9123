/// @file
/// The gyro that this image is built for, chosen by pico_image() in CMakeLists.txt: its driver,
/// settings and model. A sample raises data-ready and is read within its period: no FIFO is needed.
#pragma once

#include <cstdint>

#include "drivers/chips/chips.hpp"

#ifdef ZERORATE_PICO_MODEL
#include ZERORATE_PICO_MODEL
#else
#include "firmware/boards/pico/model.hpp"
#endif

namespace zerorate::pico {

#ifdef ZERORATE_PICO_CHIP
using Chip = drivers::ZERORATE_PICO_CHIP::Chip;
#else
using Chip = drivers::lsm6dso::Chip;
#endif

inline constexpr Chip::Settings kGyroSettings{};
inline constexpr std::uint32_t kSpiHz = 8'000'000;

/// How often the main loop turns even if no edge comes. A chip without a data-ready line is looked
/// at twice a sample.
inline constexpr std::uint32_t kBeat_us = Chip::kHasDataReady ? 10'000 : 2'500;

/// Speed of the serial line. A message takes 830 bits; at most half of the line shall be used.
inline constexpr std::uint32_t kBaud =
    exported::kNodeParams.sample_period < core::Duration::milliseconds(8) ? 460'800 : 230'400;

}  // namespace zerorate::pico
