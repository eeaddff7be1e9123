/// @file
/// IIO devices in a folder of a test: attributes are files, the node of a buffer is a FIFO.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "core/base/time.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/iio_device.hpp"
#include "host_tests/support/folders.hpp"

namespace zerorate::linux_node {

using Attributes = std::map<std::string, std::string>;

/// Attributes as st_lsm6dsx shows them.
inline Attributes buffered() {
  return {{"name", "lsm6dso_gyro"},
          {"in_anglvel_x_raw", "1"},
          {"in_anglvel_y_raw", "2"},
          {"in_anglvel_z_raw", "3"},
          {"in_anglvel_scale", "0.000076358"},
          {"in_anglvel_scale_available", "0.000076358 0.000152716 0.000305432 0.001221730"},
          {"sampling_frequency", "12.500"},
          {"sampling_frequency_available", "12.500 26.000 52.000 104.000 208.000"},
          {"current_timestamp_clock", "realtime\n"},
          {"scan_elements/in_anglvel_x_en", "0"},
          {"scan_elements/in_anglvel_x_index", "0"},
          {"scan_elements/in_anglvel_x_type", "le:s16/16>>0"},
          {"scan_elements/in_anglvel_y_en", "0"},
          {"scan_elements/in_anglvel_y_index", "1"},
          {"scan_elements/in_anglvel_y_type", "le:s16/16>>0"},
          {"scan_elements/in_anglvel_z_en", "0"},
          {"scan_elements/in_anglvel_z_index", "2"},
          {"scan_elements/in_anglvel_z_type", "le:s16/16>>0"},
          {"scan_elements/in_timestamp_en", "0"},
          {"scan_elements/in_timestamp_index", "3"},
          {"scan_elements/in_timestamp_type", "le:s64/64>>0"},
          {"buffer/enable", "0"},
          {"buffer/length", "2"},
          {"buffer/watermark", "1"}};
}

/// Attributes of the accelerometer in the same chip, as st_lsm6dsx shows them.
inline Attributes accelerometer() {
  return {{"name", "lsm6dso_accel"},
          {"in_accel_x_raw", "1"},
          {"in_accel_y_raw", "2"},
          {"in_accel_z_raw", "8192"},
          {"in_accel_scale", "0.000598205"},
          {"in_accel_scale_available", "0.000598205 0.001196411 0.002392822 0.004785645"},
          {"sampling_frequency", "12.500"},
          {"sampling_frequency_available", "12.500 26.000 52.000 104.000 208.000"},
          {"current_timestamp_clock", "realtime\n"},
          {"scan_elements/in_accel_x_en", "0"},
          {"scan_elements/in_accel_x_index", "0"},
          {"scan_elements/in_accel_x_type", "le:s16/16>>0"},
          {"scan_elements/in_accel_y_en", "0"},
          {"scan_elements/in_accel_y_index", "1"},
          {"scan_elements/in_accel_y_type", "le:s16/16>>0"},
          {"scan_elements/in_accel_z_en", "0"},
          {"scan_elements/in_accel_z_index", "2"},
          {"scan_elements/in_accel_z_type", "le:s16/16>>0"},
          {"scan_elements/in_timestamp_en", "0"},
          {"scan_elements/in_timestamp_index", "3"},
          {"scan_elements/in_timestamp_type", "le:s64/64>>0"},
          {"buffer/enable", "0"},
          {"buffer/length", "2"},
          {"buffer/watermark", "1"}};
}

/// Attributes as adxrs450 shows them: one axis, one range, no rate and no buffer.
inline Attributes polled() {
  return {{"name", "adxrs453"},
          {"in_anglvel_z_raw", "160"},
          {"in_anglvel_z_scale", "0.000218166"},
          {"in_temp0_raw", "125"},
          {"in_temp0_scale", "200.0"}};
}

inline bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

template <class Act>
std::string kernel_error_of(Act act) {
  try {
    (void)act();
  } catch (const hal::linux_os::KernelFileError& error) {
    return error.what();
  }
  return "no error";
}

/// Folders /sys and /dev of made devices.
class MadeIio {
 public:
  void add(const std::string& node, const Attributes& attributes) {
    std::filesystem::create_directories(folder_.path() / "sys" / node / "scan_elements");
    std::filesystem::create_directories(folder_.path() / "sys" / node / "buffer");
    std::filesystem::create_directories(folder_.path() / "sys" / node / "trigger");
    std::filesystem::create_directories(folder_.path() / "dev");
    for (const auto& [name, value] : attributes) set(node, name, value);
    const std::string fifo = folder_.path() / "dev" / node;
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0) << std::strerror(errno);
    writers_[node].reset(open(fifo.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  }
  void set(const std::string& node, const std::string& name, const std::string& value) const {
    folder_.write("sys/" + node + "/" + name, value);
  }
  /// An attribute that only its owner may write, and the owner is somebody else.
  void forbid(const std::string& name) const {
    std::filesystem::permissions(folder_.path() / "sys/iio:device0" / name,
                                 std::filesystem::perms::owner_read);
  }
  [[nodiscard]] std::string get(const std::string& name,
                                const std::string& node = "iio:device0") const {
    return hal::linux_os::SysfsFolder{folder_.path() / "sys" / node}.text(name);
  }
  void send(std::span<const std::uint8_t> bytes, const std::string& node = "iio:device0") const {
    ASSERT_EQ(write(writers_.at(node).get(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  /// A scan of buffered(): three times two bytes, two of padding, the stamp.
  void send(core::Instant time, std::array<std::int16_t, 3> raw,
            const std::string& node = "iio:device0") const {
    std::array<std::uint8_t, 16> scan{};
    const std::int64_t stamp = (time - core::Instant{}).ns();
    std::memcpy(scan.data(), raw.data(), sizeof raw);
    std::memcpy(scan.data() + 8, &stamp, sizeof stamp);
    send(scan, node);
  }
  [[nodiscard]] hal::linux_os::IioPlaces places() const {
    return {folder_.path() / "sys", folder_.path() / "dev"};
  }
  [[nodiscard]] std::filesystem::path path() const { return folder_.path(); }

 private:
  testing::ScratchFolder folder_;
  std::map<std::string, hal::linux_os::Descriptor> writers_;
};

}  // namespace zerorate::linux_node
