/// @file
/// Driver of the gyro, and on demand of the accelerometer, in Analog Devices' inertial units
/// ADIS16470 and ADIS16475, over their SPI of 16-bit words.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/adis16475/codec.hpp"
#include "drivers/adis16475/registers.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/word_bus.hpp"

namespace zerorate::drivers {

namespace adis16475 {

/// Chosen once, for the life of the driver; a type for each part.
template <Part kPart>
struct SettingsOf {
  OutputDataRate rate = OutputDataRate::hz_100;
};
using Settings = SettingsOf<Part::adis16470>;

/// Settings of any part.
struct Chosen {
  OutputDataRate rate = OutputDataRate::hz_100;
  const Variant* variant = nullptr;
};
template <Part kPart>
[[nodiscard]] constexpr Chosen chosen(const SettingsOf<kPart>& settings) {
  return {.rate = settings.rate, .variant = &adis16475::variant(kPart)};
}

}  // namespace adis16475

/// A GyroSource. Bus is SpiWords<...>, SPI mode 3, up to 1 MHz, with at least 16 us between two
/// selections.
///
/// Every sample comes in a burst with a checksum, the chip's own faults and a count of its samples.
/// The count shows what is new, what was lost, and that the chip was reset.
///
/// Not thread-safe, not for interrupts. Cortex-M0+: some 0.2 KiB of stack in read(), without the
/// back end's.
/// @tparam kAccelerometer  whether samples carry the acceleration, which each burst has
template <WordBus Bus, Accelerometer kAccelerometer = Accelerometer::off>
class Adis16475 {
  using Chosen = adis16475::Chosen;

 public:
  static constexpr bool kHasAccelerometer = kAccelerometer == Accelerometer::on;
  static constexpr std::size_t kAxes = 3;

  constexpr explicit Adis16475(Bus bus, adis16475::Settings settings = {})
      : Adis16475(adis16475::chosen(settings), bus) {}
  /// A relative, by the type of its settings. One class drives them all. The accelerometer has one
  /// range.
  template <adis16475::Part kPart>
  constexpr Adis16475(Bus bus, const adis16475::SettingsOf<kPart>& settings, Fixed /*range*/ = {})
      : Adis16475(adis16475::chosen(settings), bus) {}

  /// not_ready for 621 ms from the first call: 310 ms after power-on (assumed to be the first
  /// call), as long after a reset, and 1 ms after the configuration. Identity and model are checked
  /// between, the configuration and the chip's faults at the end. After any error a call begins
  /// anew.
  core::Result<void, DriverError> start(core::Instant now) {
    if (stage_ == Stage::off || stage_ == Stage::running) return wait(Stage::powering, now);
    const bool is_configuring = stage_ == Stage::configuring;
    const core::Duration needed = is_configuring ? adis16475::kWriteTime : adis16475::kStartUpTime;
    if (now - stage_began_ < needed) return refuse_for_now();
    const Stage stage = stage_;
    stage_ = Stage::off;
    if (is_configuring) return finish_start(now);
    if (const auto known = check_identity(); !known) return known;
    return stage == Stage::powering ? reset(now) : configure(now);
  }

  /// One transaction. 0 samples where the chip has measured none since the last read. Errors:
  /// not_ready before start() succeeded; corrupt_data; sensor_fault; configuration_lost if the chip
  /// was reset.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) return refused(DriverErrorCode::not_ready, adis16475::kDiagStat);
    if (out.empty()) return std::size_t{0};
    const auto burst = read_burst();
    if (!burst) return core::Unexpected{burst.error()};
    if ((burst->status & adis16475::bits::kDiagStatSpiError) != 0) {
      return refused(DriverErrorCode::corrupt_data, adis16475::kDiagStat);
    }
    const auto steps = static_cast<std::uint16_t>(burst->counter - counter_);
    if (steps == 0) return std::size_t{0};
    if (adis16475::was_reset(steps, now - counted_at_, sample_period())) {
      is_lost_ = true;
      return refused(DriverErrorCode::configuration_lost, adis16475::kDataCntr);
    }
    counter_ = burst->counter;
    counted_at_ = now;
    if (now < settled_at_) return std::size_t{0};
    lost_samples_ += steps - 1U;
    out[0] = make_sample(now, *burst);
    return std::size_t{1};
  }

  /// Two transactions. Does not stop the driver: whether to start again is the application's
  /// choice.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) return refused(DriverErrorCode::not_ready, adis16475::kProdId);
    if (is_lost_) return refused(DriverErrorCode::configuration_lost, adis16475::kDataCntr);
    if (const auto held = verify(entries()[next_]); !held) return held;
    next_ = static_cast<std::uint8_t>((next_ + 1U) % kEntries);
    return {};
  }

  /// Nominal: the chip has no trim register.
  [[nodiscard]] constexpr core::Duration sample_period() const {
    return adis16475::sample_period(chosen_.rate);
  }
  [[nodiscard]] constexpr core::AngularRate lsb() const { return adis16475::lsb(*chosen_.variant); }
  [[nodiscard]] constexpr bool is_batched() const { return false; }
  /// Samples that the chip measured between two reads and that were not read, since the start.
  [[nodiscard]] constexpr std::uint32_t lost_samples() const { return lost_samples_; }

 private:
  constexpr Adis16475(const Chosen& chosen, Bus bus) : bus_(bus), chosen_(chosen) {}

  /// powering: the supply may just have come; configuring: registers take what was written.
  enum class Stage : std::uint8_t { off, powering, resetting, configuring, running };

  /// Bits of a register and what they have to be.
  struct Entry {
    std::uint8_t address;
    std::uint16_t mask;
    std::uint16_t value;
  };
  static constexpr std::size_t kEntries = 3;
  [[nodiscard]] constexpr std::array<Entry, kEntries> entries() const {
    namespace b = adis16475::bits;
    return {{{adis16475::kMscCtrl, b::kMscCtrlAll, b::kMscCtrlUsed},
             {adis16475::kFiltCtrl, b::kFiltCtrlSize, 0},
             {adis16475::kDecRate, b::kDecRateAll, adis16475::encode_dec_rate(chosen_.rate)}}};
  }

  static constexpr core::Unexpected<DriverError> refuse_for_now() {
    return refused(DriverErrorCode::not_ready, adis16475::kProdId);
  }
  core::Result<void, DriverError> wait(Stage stage, core::Instant now) {
    stage_ = stage;
    stage_began_ = now;
    return refuse_for_now();
  }

  core::Result<void, DriverError> check_identity() {
    const auto product = read_register(adis16475::kProdId);
    if (!product) return core::Unexpected{product.error()};
    if (*product != chosen_.variant->product) {
      return refused(DriverErrorCode::wrong_identity, adis16475::kProdId);
    }
    if (chosen_.variant->model == adis16475::kNoModel) return {};
    const auto model = read_register(adis16475::kRangMdl);
    if (!model) return core::Unexpected{model.error()};
    if ((*model & adis16475::bits::kRangMdlModel) == chosen_.variant->model) return {};
    return refused(DriverErrorCode::wrong_identity, adis16475::kRangMdl);
  }

  core::Result<void, DriverError> reset(core::Instant now) {
    const auto done = write_register(adis16475::kGlobCmd, adis16475::bits::kGlobCmdReset);
    if (!done) return done;
    return wait(Stage::resetting, now);
  }

  core::Result<void, DriverError> configure(core::Instant now) {
    for (const Entry& entry : entries()) {
      if (const auto done = write_register(entry.address, entry.value); !done) return done;
    }
    return wait(Stage::configuring, now);
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    for (const Entry& entry : entries()) {
      if (const auto held = verify(entry); !held) return held;
    }
    const auto burst = read_burst();
    if (!burst) return core::Unexpected{burst.error()};
    counter_ = burst->counter;
    counted_at_ = now;
    settled_at_ = now + adis16475::settling_time(sample_period());
    lost_samples_ = 0;
    is_lost_ = false;
    next_ = 0;
    stage_ = Stage::running;
    return {};
  }

  core::Result<void, DriverError> verify(const Entry& entry) {
    const auto value = read_register(entry.address);
    if (!value) return core::Unexpected{value.error()};
    if ((*value & entry.mask) == entry.value) return {};
    return refused(DriverErrorCode::configuration_lost, entry.address);
  }

  /// A burst without the chip's own faults.
  core::Result<adis16475::Burst, DriverError> read_burst() {
    std::array<std::uint8_t, adis16475::kBurstBytes> bytes{};
    if (const auto done = bus_.burst(adis16475::kBurstCommand, bytes); !done) {
      return bus_failed(done.error(), adis16475::kGlobCmd);
    }
    const adis16475::Burst burst = adis16475::decode_burst(bytes);
    if (!burst.is_intact) return refused(DriverErrorCode::corrupt_data, adis16475::kGlobCmd);
    if ((burst.status & adis16475::bits::kDiagStatFaults) != 0) {
      return refused(DriverErrorCode::sensor_fault, adis16475::kDiagStat);
    }
    return burst;
  }

  /// The word is sent twice: the second time only to fetch the reply to the first.
  core::Result<std::uint16_t, DriverError> read_register(std::uint8_t address) {
    const std::uint16_t word = adis16475::encode_read(address);
    if (const auto sent = bus_.exchange(word); !sent) return bus_failed(sent.error(), address);
    const auto reply = bus_.exchange(word);
    if (!reply) return bus_failed(reply.error(), address);
    return *reply;
  }

  /// The low byte and then the high one.
  core::Result<void, DriverError> write_register(std::uint8_t address, std::uint16_t value) {
    const auto low = static_cast<std::uint8_t>(value & 0xFFU);
    const auto high = static_cast<std::uint8_t>(value >> 8U);
    auto sent = bus_.exchange(adis16475::encode_write(address, low));
    const auto above = static_cast<std::uint8_t>(address + 1U);
    if (sent) sent = bus_.exchange(adis16475::encode_write(above, high));
    if (!sent) return bus_failed(sent.error(), address);
    return {};
  }

  [[nodiscard]] GyroSample make_sample(core::Instant time, const adis16475::Burst& burst) const {
    GyroSample sample;
    sample.time = time;
    sample.temperature = adis16475::decode_temperature(burst.temperature);
    sample.has_temperature = true;
    set_rates(sample, burst.rate, lsb(), adis16475::kFullScaleRaw);
    if constexpr (kHasAccelerometer) {
      set_acceleration(sample, burst.force,
                       {.lsb = adis16475::acceleration_lsb(*chosen_.variant),
                        .highest_raw = adis16475::kAccelerationFullScaleRaw,
                        .lowest_raw = -adis16475::kAccelerationFullScaleRaw});
    }
    return sample;
  }

  Bus bus_;
  Chosen chosen_;
  core::Instant stage_began_;
  core::Instant settled_at_;
  core::Instant counted_at_;  ///< time of the read that gave counter_
  std::uint32_t lost_samples_ = 0;
  std::uint16_t counter_ = 0;
  bool is_lost_ = false;
  std::uint8_t next_ = 0;
  Stage stage_ = Stage::off;
};

}  // namespace zerorate::drivers
