/// @file
/// Samples of a gyro that another program sends: of a chip without a driver here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "firmware/boards/linux/chips/gyro.hpp"
#include "firmware/boards/linux/message_source.hpp"

namespace zerorate::linux_node {

/// Messages of a DatagramGyro that gave no sample, and samples that never came.
struct SampleCounters {
  std::uint32_t lost = 0;        ///< missing numbers
  std::uint32_t late = 0;        ///< samples older than the one before
  std::uint32_t doubled = 0;     ///< repetitions of the sample before
  std::uint32_t unreadable = 0;  ///< messages without a sample by decode_sample()
  std::uint32_t foreign = 0;     ///< stamps of another clock: in the future, or over a second old

  constexpr bool operator==(const SampleCounters&) const = default;
};

/// One sample as a datagram states it.
struct SampleMessage {
  std::uint32_t sequence = 0;
  std::int64_t time_ns = 0;  ///< time by CLOCK_MONOTONIC of this machine; 0: that of the reading
  std::array<double, 3> rate_rad_s{};
  std::optional<double> temperature_degc;
  std::optional<std::array<double, 3>> acceleration_m_s2;
};

/// Reads "sequence time_ns wx wy wz [temperature [ax ay az]]", numbers with white space between
/// them, in rad/s, deg C and m/s2; a temperature of `-` is none. nullopt for anything else.
[[nodiscard]] std::optional<SampleMessage> decode_sample(std::string_view text);

/// A GyroSource over messages. An axis at the full scale or beyond it is saturated, and an
/// acceleration at its range is none. Samples are in the order of their stamps: late and doubled
/// ones are counted and left out. A sender that begins anew may count from any number.
class DatagramGyro final : public DeviceGyro {
 public:
  DatagramGyro(const GyroSettings& settings, MessageOrigin origin);

  core::Result<void, drivers::DriverError> start(core::Instant now) override;
  core::Result<std::size_t, drivers::DriverError> read(core::Instant now,
                                                       std::span<drivers::GyroSample> out) override;
  core::Result<void, drivers::DriverError> verify_next() override { return {}; }
  [[nodiscard]] core::Duration sample_period() const override { return period_; }
  [[nodiscard]] core::AngularRate lsb() const override;
  [[nodiscard]] bool is_batched() const override { return false; }
  GyroReason reason(drivers::DriverErrorCode code) override;
  [[nodiscard]] int descriptor() const override { return messages_.descriptor(); }
  [[nodiscard]] const SampleCounters& counters() const { return counters_; }

 private:
  /// The sample of a message that is the next one in time.
  [[nodiscard]] std::optional<drivers::GyroSample> take(std::string_view text);
  [[nodiscard]] bool is_next(const SampleMessage& message, core::Instant time);
  [[nodiscard]] drivers::GyroSample sample_of(const SampleMessage& message,
                                              core::Instant time) const;

  GyroSettings settings_;
  MessageSource messages_;
  core::Duration period_;
  SampleCounters counters_;
  std::optional<core::Instant> unreadable_at_;  ///< time of the newest message without a sample
  std::optional<core::Instant> foreign_at_;     ///< time of the newest stamp of another clock
  std::optional<core::Instant> newest_;
  std::uint32_t sequence_ = 0;  ///< number of the newest sample
};

}  // namespace zerorate::linux_node
