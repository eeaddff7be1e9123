/// @file
/// Folders of /sys: attributes of a device, and the driver that holds it.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace zerorate::hal::linux_os {

/// A file of the kernel that cannot be used. Its text is "path: reason (cure)".
class KernelFileError : public std::runtime_error {
 public:
  /// @param reason  as errno gives it
  KernelFileError(const std::string& path, int reason, std::string_view cure = {});
  /// @param reason  in words, where no call of the kernel failed
  KernelFileError(const std::string& path, std::string_view reason, std::string_view cure = {});
  /// Error number of the kernel; 0: none.
  [[nodiscard]] int error_number() const { return error_number_; }

 private:
  int error_number_ = 0;
};

/// Attributes of one device. An attribute is a small text file; each access is an open, one
/// transfer and a close.
class SysfsFolder {
 public:
  explicit SysfsFolder(std::string path) : path_(std::move(path)) {}

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string path_of(std::string_view attribute) const;
  [[nodiscard]] bool has(std::string_view attribute) const;
  /// First of the names that is there.
  [[nodiscard]] std::optional<std::string> first_of(const std::vector<std::string>& names) const;
  /// Names of the entries, sorted.
  [[nodiscard]] std::vector<std::string> entries() const;

  /// Value without the newline. Throws KernelFileError, as do the others.
  [[nodiscard]] std::string text(std::string_view attribute) const;
  /// Value of an attribute that may be absent.
  [[nodiscard]] std::string text_or(std::string_view attribute, std::string_view otherwise) const;
  [[nodiscard]] double number(std::string_view attribute) const;
  void write(std::string_view attribute, std::string_view value) const;

 private:
  std::string path_;
};

/// Numbers of a list that is separated by blanks, commas or semicolons. Throws KernelFileError,
/// which names `path`, at anything else.
[[nodiscard]] std::vector<double> parse_numbers(std::string_view list, const std::string& path);

/// Driver that is bound to an I2C device; empty: none. Through i2c-dev two programs would talk to
/// the chip at once, because the kernel refuses that only to I2C_SLAVE and not to I2C_RDWR.
/// @param sysfs   "/sys"
/// @param device  "/dev/i2c-1"
[[nodiscard]] std::string driver_of_i2c(const std::string& sysfs, std::string_view device,
                                        std::uint8_t address);
/// Driver that is bound to a chip select; empty: none, or spidev.
/// @param device  "/dev/spidev0.0", which the kernel has only while spidev is bound
[[nodiscard]] std::string driver_of_spi(const std::string& sysfs, std::string_view device);

}  // namespace zerorate::hal::linux_os
