/// @file
/// Registers of the LSM6DSO and its relatives as the driver sets them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/lsm6dso/codec.hpp"
#include "drivers/lsm6dso/registers.hpp"

namespace zerorate::drivers::lsm6dso {

enum class Mode : std::uint8_t {
  data_ready,  ///< each read() gives the latest sample; INT1 rises when there is a new one
  fifo,        ///< the chip keeps up to 512 samples; INT1 rises at the watermark
};

/// Settings of any chip.
struct Chosen {
  const Variant* variant = nullptr;
  FullScale full_scale = FullScale::dps_250;
  std::uint8_t rate = 0;  ///< its code
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 0;
};

inline constexpr std::size_t kGyroEntries = 11;
inline constexpr std::size_t kAccelerometerEntries = 2;

inline constexpr std::uint8_t kFifoCtrl2Used = bits::kFifoCtrl2StopOnWtm |
                                               bits::kFifoCtrl2FifoComprRtEn |
                                               bits::kFifoCtrl2OdrChgEn | bits::kFifoCtrl2Wtm8;

/// Table for the gyro alone: the accelerometer is off.
constexpr std::array<ConfigurationEntry, kGyroEntries> configuration_of_gyro(
    const Chosen& settings) {
  namespace b = bits;
  const bool is_fifo = settings.mode == Mode::fifo;
  const bool is_new = settings.variant->has_new_layout;
  // In the chips without tags the same addresses are the FIFO's, which stays off with zeros.
  const bool has_tags = settings.variant->has_tags;
  const auto batch = static_cast<std::uint8_t>(has_tags ? unsigned{settings.rate} << 4U : 0U);
  const std::uint8_t watermark = has_tags ? settings.fifo_watermark : std::uint8_t{0};
  // The whole register is compared: a stuck line changes its ones or its zeros.
  const auto interface = configure(kCtrl3C, 0xFF, b::kCtrl3CBdu | b::kCtrl3CIfInc);
  const auto i3c = configure(kCtrl9Xl, b::kCtrl9XlI3cDisable, b::kCtrl9XlI3cDisable);
  const std::uint8_t fifo_mode = is_fifo ? b::kFifoModeContinuous : std::uint8_t{0};
  return {{
      interface,
      is_new ? configure(kDsvCtrl6, b::kDsvCtrl6All, encode_ctrl6(settings.full_scale))
             : (settings.variant->has_i3c ? i3c : interface),
      is_new ? configure(kDsvCtrl4, b::kDsvCtrl4Drdy, 0)
             : configure(kCtrl4C, b::kCtrl4CSleepG | b::kCtrl4CLpf1SelG, 0),
      // High-performance mode, and no high-pass filter: it would remove the bias we estimate.
      is_new ? configure(kDsvCtrl7, b::kDsvCtrl7Off, 0)
             : configure(kCtrl7G, b::kCtrl7GGHmMode | b::kCtrl7GHpEnG, 0),
      is_new ? configure(kDsvCtrl1, b::kDsvCtrl1OdrXl, 0)
             : configure(kCtrl1Xl, b::kCtrl1XlOdrXl, 0),
      configure(kInt1Ctrl, 0xFF, is_fifo ? b::kInt1FifoTh : b::kInt1DrdyG),
      configure(kFifoCtrl1, 0xFF, watermark),
      configure(kFifoCtrl2, kFifoCtrl2Used, 0),
      configure(kFifoCtrl3, b::kFifoCtrl3BdrGy | b::kFifoCtrl3BdrXl, batch),
      configure(kFifoCtrl4,
                b::kFifoCtrl4DecTsBatch | b::kFifoCtrl4OdrTBatch | b::kFifoCtrl4FifoMode,
                fifo_mode),
      is_new
          ? configure(kDsvCtrl2, b::kDsvCtrl2All, settings.rate)
          : configure(kCtrl2G, b::kCtrl2GAll, encode_ctrl2_g(settings.rate, settings.full_scale)),
  }};
}

/// The table of the gyro alone, with other entries for the accelerometer and the FIFO, and two
/// more behind the first.
constexpr std::array<ConfigurationEntry, kGyroEntries + kAccelerometerEntries>
configuration_with_accelerometer(const Chosen& settings, AccelerationRange range) {
  namespace b = bits;
  const bool is_new = settings.variant->has_new_layout;
  const bool has_tags = settings.variant->has_tags;
  const unsigned watermark = has_tags ? 2U * settings.fifo_watermark : 0U;
  ZERORATE_ASSERT(watermark <= (is_new ? 0xFFU : 0x1FFU));
  auto gyro = configuration_of_gyro(settings);
  const auto replace = [&](const ConfigurationEntry& entry) {
    *std::ranges::find(gyro, entry.address, &ConfigurationEntry::address) = entry;
  };
  replace(is_new ? configure(kDsvCtrl1, b::kDsvCtrl1All, settings.rate)
                 : configure(kCtrl1Xl, b::kCtrl1XlAll, encode_ctrl1_xl(settings.rate, range)));
  replace(configure(kFifoCtrl1, 0xFF, static_cast<std::uint8_t>(watermark & 0xFFU)));
  replace(configure(kFifoCtrl2, kFifoCtrl2Used,
                    watermark > 0xFF ? b::kFifoCtrl2Wtm8 : std::uint8_t{0}));
  replace(configure(kFifoCtrl3, b::kFifoCtrl3BdrGy | b::kFifoCtrl3BdrXl,
                    static_cast<std::uint8_t>(has_tags ? settings.rate * 0x11U : 0U)));
  return joined(gyro, std::array{is_new ? configure(kDsvCtrl8, b::kDsvCtrl8All,
                                                    static_cast<std::uint8_t>(range))
                                        : configure(kCtrl6C, b::kCtrl6CXlHmMode, 0),
                                 is_new ? configure(kDsvCtrl9, b::kDsvCtrl9Off, 0)
                                        : configure(kCtrl8Xl, b::kCtrl8XlOff, 0)});
}

}  // namespace zerorate::drivers::lsm6dso
