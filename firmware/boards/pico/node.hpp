/// @file
/// The gyro that this image is built for, chosen by pico_image() in CMakeLists.txt: its driver,
/// settings and model; and the node for it. Free of the board: a replay on a PC includes them too.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "core/base/compile_time.hpp"
#include "drivers/chips/chips.hpp"
#include "firmware/app/gyro_node.hpp"

#ifdef ZERORATE_PICO_MODEL
#include ZERORATE_PICO_MODEL
#else
#include "firmware/boards/models/lsm6dso.hpp"
#endif

namespace zerorate::pico {

#ifdef ZERORATE_PICO_CHIP
inline constexpr std::string_view kChip = ZERORATE_PICO_CHIP;
#else
inline constexpr std::string_view kChip = "lsm6dso";
#endif

/// The chip of that name; a list without it has none.
template <class Chips>
struct Named;
template <class First, class... Others>
struct Named<core::TypeList<First, Others...>>
    : std::conditional_t<First::kName == kChip, std::type_identity<First>,
                         Named<core::TypeList<Others...>>> {};
using Chip = Named<drivers::AllChips>::type;

/// A sample raises data-ready and is read within its period: no FIFO is needed.
inline constexpr Chip::Settings kGyroSettings{};
inline constexpr std::uint32_t kSpiHz = std::min<std::uint32_t>(8'000'000, Chip::kHighestSpi_hz);

/// How often the main loop turns even if no edge comes. A chip without a data-ready line is looked
/// at twice a sample.
inline constexpr std::uint32_t kBeat_us = Chip::kHasDataReady ? 10'000 : 2'500;

/// Speed of the serial line. A message takes 830 bits; at most half of the line shall be used.
inline constexpr std::uint32_t kBaud =
    exported::kNodeParams.model.sample_period < core::Duration::milliseconds(8) ? 460'800 : 230'400;

/// At ticks of 0.5 s the hold-back of 0.5 s needs 3 of 8 places, and a moving average would
/// remember thirteen hours of one stop (core::SuffixSums). Only what is published runs beside the
/// Kalman predictor. More does not fit into the memory that pico.ld.in grants; where samples are
/// screened each place is larger and there are fewer.
inline constexpr bool kScreens = exported::kNodeParams.model.samples.is_on();
inline constexpr app::NodeCapacity kNodeCapacity{
    .held_ticks = kScreens ? 4 : 8,
    .average_levels = 12,
    .screens_samples = kScreens,
    .runs_moving_average = exported::kNodeParams.published == app::Predictor::moving_average,
    .runs_calibration_mean = exported::kNodeParams.published == app::Predictor::calibration_mean,
    .takes_references = false};
using Node = app::GyroNode<exported::kModelShape, kNodeCapacity>;

/// Those of the model. Without an odometer the calm of the gyro decides what is rest: a pin that is
/// open would show a vehicle that never moves.
inline constexpr auto kNodeParams = [] {
  auto params = exported::kNodeParams;
#ifdef ZERORATE_PICO_NO_ODOMETER
  params.standstill.source = core::StandstillSource::gyro;
#endif
  return params;
}();
static_assert(Node::check(kNodeParams).has_value());

}  // namespace zerorate::pico
