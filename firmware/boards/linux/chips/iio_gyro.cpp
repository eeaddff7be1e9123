#include "firmware/boards/linux/chips/iio_gyro.hpp"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include "hal/linux/clock.hpp"

namespace zerorate::linux_node {
namespace {

using drivers::DriverErrorCode;
using hal::linux_os::IioScan;
using hal::linux_os::KernelFileError;

constexpr double kRadPerDeg = 0.017453292519943295;
/// Gyros need so long after their power-up, the L3G4200D perhaps 250 ms; not every driver waits.
constexpr core::Duration kSettling = core::Duration::milliseconds(300);
constexpr core::Duration kLongestSilence = core::Duration::seconds(1);
constexpr core::Duration kTemperatureInterval = core::Duration::seconds(1);

/// Scale of the chip's data sheet, where the driver's is that of one of its ranges, rounded: bmg160
/// tells three digits of 0.000133158 rad/s, adis16475 one of 0.000000001665 of 32 bits. Else the
/// driver's; 0 where that has too few digits to be one.
double exact_scale(double told, std::int64_t counts, const ChipDescription* known) {
  constexpr double kRounding = 0.01;
  const std::span<const double> ranges =
      known != nullptr ? known->full_scales_dps : std::span<const double>{};
  for (const double full_scale_dps : ranges) {
    const double of_16_bits = full_scale_dps * kRadPerDeg / known->counts;
    const double scale = of_16_bits * 32768.0 / static_cast<double>(counts);
    if (std::abs(told - scale) <= std::max(kRounding * scale, hal::linux_os::kIioDigits)) {
      return scale;
    }
  }
  return hal::linux_os::kIioDigits <= kRounding * told ? told : 0.0;
}

core::Duration period_of(double rate_hz) {
  return core::Duration::nanoseconds(std::llround(1e9 / rate_hz));
}

}  // namespace

std::string_view chip_of_iio(std::string_view device) {
  std::string_view longest;  // "lsm6dsox_gyro" begins with "lsm6dso", too
  for (const ChipDescription& chip : chips()) {
    if (device.starts_with(chip.name) && chip.name.size() > longest.size()) longest = chip.name;
  }
  return longest;
}

IioGyro::IioGyro(const GyroSettings& settings, hal::linux_os::IioPlaces places)
    : settings_(settings), places_(std::move(places)), period_(period_of(settings.rate_hz)) {}

core::Result<void, drivers::DriverError> IioGyro::start(core::Instant now) {
  device_.reset();  // closes its node, which a second opening would find in use
  accelerometer_.reset();
  waiting_.reset();
  has_newest_ = false;
  try {
    open(now);
  } catch (const KernelFileError& error) {
    return failed(error);
  }
  error_number_ = 0;
  return {};
}

void IioGyro::open(core::Instant now) {
  hal::linux_os::IioWishes wishes{.rate_hz = settings_.rate_hz,
                                  .full_scale = settings_.full_scale_dps * kRadPerDeg};
  const bool reads_another = settings_.acceleration_range_g && !has_own_accelerometer();
  if (settings_.acceleration_range_g && !reads_another) {
    wishes.acceleration_range_m_s2 = acceleration_range_m_s2(settings_);
  }
  device_.emplace(places_, hal::linux_os::kIioRate, settings_.device, wishes);
  if (reads_another) accelerometer_.emplace(settings_, places_, now);
  period_ = period_of(device_->rate_hz());
  const ChipDescription* const known = find_chip(settings_.chip);
  has_thermometer_ = known == nullptr || known->has_thermometer;  // bmg160 shows one of the BMI088
  const auto& axes = device_->axes();
  rad_s_per_count_ = exact_scale(axes.si_per_count(), axes.counts(), known);
  if (rad_s_per_count_ == 0.0) {
    throw KernelFileError(
        places_.sysfs + "/" + device_->identity().node + "/" + axes.scale_attribute(),
        "too few digits", "is chip the name of the chip?");
  }
  is_buffered_ = device_->has_buffer();
  temperature_ = device_->read_temperature();
  temperature_at_ = now;
  started_ = newest_ = next_ = now;
  if (is_buffered_) return device_->start_buffer();
  const std::string node = places_.sysfs + "/" + device_->identity().node;
  if (settings_.rate_hz > kHighestPolledRate_hz) {
    throw KernelFileError(node,
                          "no buffer: each axis is read by itself, at most 100 times a second",
                          "wire the chip's interrupt line, or lower rate_hz");
  }
  // Some drivers wake the chip up and put it to sleep for each reading.
  const core::Instant before = hal::linux_os::KernelClock::now();
  (void)device_->read_attributes();
  const core::Duration taken = hal::linux_os::KernelClock::now() - before;
  if (taken > period_) {
    throw KernelFileError(
        node,
        "no buffer, and reading all axes takes " + std::to_string(taken.ns() / 1'000'000) + " ms",
        "wire the chip's interrupt line, or lower rate_hz");
  }
}

/// Whether the accelerometer is in the gyro's device.
bool IioGyro::has_own_accelerometer() const {
  using namespace hal::linux_os;
  return find_iio_device(places_, kIioAcceleration, settings_.accelerometer_device).node ==
         find_iio_device(places_, kIioRate, settings_.device).node;
}

core::Result<std::size_t, drivers::DriverError> IioGyro::read(core::Instant now,
                                                              std::span<drivers::GyroSample> out) {
  if (!device_) return failed(hal::BusError::not_present, told_);
  try {
    if (now - temperature_at_ >= kTemperatureInterval) {
      temperature_ = device_->read_temperature();
      temperature_at_ = now;
    }
    return is_buffered_ ? read_buffer(now, out) : read_attributes(now, out);
  } catch (const KernelFileError& error) {
    return failed(error);
  }
}

bool IioGyro::is_after_gap(core::Instant time) const {
  return has_newest_ && time - newest_ > period_ + period_ / 2;
}

IioGyro::Count IioGyro::read_buffer(core::Instant now, std::span<drivers::GyroSample> out) {
  const std::string node = places_.nodes + "/" + device_->identity().node;
  std::size_t count = 0;
  while (count < out.size()) {
    std::optional<IioScan> scan = std::exchange(waiting_, std::nullopt);
    const bool is_told = scan.has_value() && is_gap_told_;
    if (!scan) {
      auto next = device_->next_scan();
      if (!next) return failed(KernelFileError{node, next.error(), "was the device unplugged?"});
      scan = *next;
    }
    if (!scan) break;
    if (scan->time <= newest_ && has_newest_) {
      return failed(hal::BusError::io,
                    node + ": time stamps run backwards (is another clock set?)");
    }
    if (!is_told && is_after_gap(scan->time)) {
      waiting_ = scan;
      is_gap_told_ = count == 0;  // samples from before the gap leave first
      if (count > 0) return count;
      return drivers::refused(DriverErrorCode::fifo_overrun, 0);
    }
    newest_ = scan->time;
    has_newest_ = true;
    if (scan->time - started_ >= kSettling) out[count++] = sample_of(*scan, now);
  }
  if (count == 0 && now - std::max(newest_, started_) > kLongestSilence) {
    return failed(hal::BusError::timeout,
                  node +
                      ": no sample for a second (is the chip's interrupt line wired as the device "
                      "tree gives?)");
  }
  return count;
}

IioGyro::Count IioGyro::read_attributes(core::Instant now, std::span<drivers::GyroSample> out) {
  if (out.empty() || now < next_) return std::size_t{0};
  next_ = next_ + period_;
  if (next_ <= now) next_ = now + period_;
  IioScan scan = device_->read_attributes();
  scan.time = now;
  out[0] = sample_of(scan, now);
  return std::size_t{1};
}

drivers::GyroSample IioGyro::sample_of(const IioScan& scan, core::Instant now) {
  const std::int64_t largest = device_->axes().counts() - 1;
  drivers::GyroSample sample{.time = scan.time};
  const double full_scale = settings_.full_scale_dps * kRadPerDeg;
  const auto& mounting = device_->axes().mounting();
  const bool has_one_axis = device_->axes().names().size() == 1;
  for (std::size_t row = 0; row < mounting.size(); ++row) {
    double rate = 0.0;
    bool is_saturated = false;
    for (std::size_t axis = 0; axis < mounting.size(); ++axis) {
      // An only axis stands for all three, and is not turned.
      const double part = has_one_axis ? (row == axis ? 1.0 : 0.0) : mounting.at(row).at(axis);
      const double measured = static_cast<double>(scan.raw.at(axis)) * rad_s_per_count_;
      rate += part * measured;
      const bool is_at_end =
          std::abs(measured) >= full_scale || std::abs(scan.raw.at(axis)) >= largest;
      is_saturated = is_saturated || (part != 0.0 && is_at_end);
    }
    sample.rate.at(row) = core::rad_per_s(static_cast<float>(rate));
    if (is_saturated) sample.saturated_axes |= static_cast<std::uint8_t>(1U << row);
  }
  const auto temperature = scan.temperature ? scan.temperature : temperature_;
  if (temperature && has_thermometer_) {
    sample.temperature =
        core::Temperature::from_degc(static_cast<float>(device_->celsius(*temperature)));
    sample.has_temperature = true;
  }
  if (const auto force = force_at(scan, now)) {
    sample.acceleration = *force;
    sample.has_acceleration = true;
  }
  return sample;
}

std::optional<Force> IioGyro::force_at(const IioScan& scan, core::Instant now) {
  if (accelerometer_) return accelerometer_->take(scan.time, now);
  if (!scan.acceleration) return std::nullopt;
  return force_of(*device_->acceleration(), *scan.acceleration, acceleration_range_m_s2(settings_));
}

core::Result<void, drivers::DriverError> IioGyro::verify_next() {
  // The attributes are the driver's own memory; once a second is often enough.
  const auto interval = static_cast<std::size_t>(std::ceil(settings_.rate_hz));
  if (!device_) {  // start() opens it again
    if (was_removed_) return drivers::refused(DriverErrorCode::configuration_lost, 0);
    return {};
  }
  if (++calls_of_verify_ % interval != 0) return {};
  std::string changed;
  try {
    if (!device_->verify_next()) changed = device_->identity().node;
    if (accelerometer_ && !accelerometer_->verify_next()) changed = accelerometer_->identity().node;
  } catch (const KernelFileError& error) {
    return failed(error);
  }
  if (changed.empty()) return {};
  told_ = places_.sysfs + "/" + changed + ": another program changed the settings of the device";
  return drivers::refused(DriverErrorCode::configuration_lost, 0);
}

GyroReason IioGyro::reason(DriverErrorCode code) {
  const bool has_words =
      code == DriverErrorCode::bus_failed || code == DriverErrorCode::configuration_lost;
  return {.error_number = error_number_, .told = has_words ? told_ : std::string{}};
}

core::Unexpected<drivers::DriverError> IioGyro::failed(const KernelFileError& error) {
  const int number = error.error_number();
  const auto bus =
      number == EIO || number == ETIMEDOUT ? hal::BusError::io : hal::BusError::not_present;
  error_number_ = number;
  return failed(bus, error.what());
}

core::Unexpected<drivers::DriverError> IioGyro::failed(hal::BusError bus, std::string told) {
  told_ = std::move(told);
  device_.reset();
  accelerometer_.reset();
  was_removed_ = bus == hal::BusError::not_present;
  return drivers::bus_failed(bus, 0);
}

}  // namespace zerorate::linux_node
