#include "hal/linux/sysfs.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "hal/linux/descriptor.hpp"

namespace zerorate::hal::linux_os {
namespace {

std::string in_words(const std::string& path, std::string_view reason, std::string_view cure) {
  std::string words = path + ": " + std::string{reason};
  if (!cure.empty()) words += " (" + std::string{cure} + ")";
  return words;
}

std::string_view cure_of(int error) {
  if (error == EACCES || error == EPERM) return "is the udev rule of zerorate installed?";
  if (error == EBUSY) return "does another program use the device?";
  if (error == ENODEV || error == ENOENT) return "was the device unplugged or unbound?";
  return {};
}

Descriptor open_attribute(const std::string& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) throw KernelFileError(path, errno, cure_of(errno));
  return Descriptor{descriptor};
}

std::string driver_at(const std::string& device_folder) {
  std::error_code error;
  const auto target = std::filesystem::read_symlink(device_folder + "/driver", error);
  return error ? std::string{} : target.filename().string();
}

/// "/dev/i2c-1" without "/dev/i2c-"; empty where it does not begin so.
std::string_view after(std::string_view device, std::string_view prefix) {
  const std::string_view name = device.substr(device.rfind('/') + 1);
  return name.starts_with(prefix) ? name.substr(prefix.size()) : std::string_view{};
}

}  // namespace

KernelFileError::KernelFileError(const std::string& path, int reason, std::string_view cure)
    : std::runtime_error(in_words(path, std::generic_category().message(reason), cure)),
      error_number_(reason) {}

KernelFileError::KernelFileError(const std::string& path, std::string_view reason,
                                 std::string_view cure)
    : std::runtime_error(in_words(path, reason, cure)) {}

std::string SysfsFolder::path_of(std::string_view attribute) const {
  return path_ + "/" + std::string{attribute};
}

bool SysfsFolder::has(std::string_view attribute) const {
  return ::access(path_of(attribute).c_str(), F_OK) == 0;
}

std::optional<std::string> SysfsFolder::first_of(const std::vector<std::string>& names) const {
  const auto found =
      std::ranges::find_if(names, [&](const std::string& name) { return has(name); });
  if (found == names.end()) return std::nullopt;
  return *found;
}

std::vector<std::string> SysfsFolder::entries() const {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator{path_, error}) {
    names.push_back(entry.path().filename());
  }
  std::ranges::sort(names);
  return names;
}

std::string SysfsFolder::text(std::string_view attribute) const {
  const std::string path = path_of(attribute);
  const Descriptor file = open_attribute(path, O_RDONLY);
  std::array<char, 4096> page{};  // an attribute is at most a page
  const ssize_t count = ::read(file.get(), page.data(), page.size());
  if (count < 0) throw KernelFileError(path, errno, cure_of(errno));
  std::string_view value{page.data(), static_cast<std::size_t>(count)};
  while (!value.empty() && (value.back() == '\n' || value.back() == ' ')) value.remove_suffix(1);
  return std::string{value};
}

std::string SysfsFolder::text_or(std::string_view attribute, std::string_view otherwise) const {
  return has(attribute) ? text(attribute) : std::string{otherwise};
}

double SysfsFolder::number(std::string_view attribute) const {
  const auto numbers = parse_numbers(text(attribute), path_of(attribute));
  if (numbers.size() != 1) throw KernelFileError(path_of(attribute), "not one number");
  return numbers.front();
}

void SysfsFolder::write(std::string_view attribute, std::string_view value) const {
  const std::string path = path_of(attribute);
  const Descriptor file = open_attribute(path, O_WRONLY | O_TRUNC);
  const ssize_t count = ::write(file.get(), value.data(), value.size());
  if (count != static_cast<ssize_t>(value.size())) {
    throw KernelFileError(path + ": \"" + std::string{value} + "\"", errno, cure_of(errno));
  }
}

std::vector<double> parse_numbers(std::string_view list, const std::string& path) {
  constexpr std::string_view kSeparators = " ,;\t\n";
  std::vector<double> numbers;
  while (true) {
    const std::size_t begin = list.find_first_not_of(kSeparators);
    if (begin == std::string_view::npos) return numbers;
    list.remove_prefix(begin);
    const std::string_view word = list.substr(0, list.find_first_of(kSeparators));
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) {
      throw KernelFileError(path, "\"" + std::string{word} + "\" is no number");
    }
    numbers.push_back(value);
    list.remove_prefix(word.size());
  }
}

std::string driver_of_i2c(const std::string& sysfs, std::string_view device, std::uint8_t address) {
  const std::string_view bus = after(device, "i2c-");
  if (bus.empty()) return {};
  std::array<char, 8> digits{};
  (void)std::snprintf(digits.data(), digits.size(), "%04x", unsigned{address});
  return driver_at(sysfs + "/bus/i2c/devices/" + std::string{bus} + "-" + digits.data());
}

std::string driver_of_spi(const std::string& sysfs, std::string_view device) {
  const std::string_view select = after(device, "spidev");
  if (select.empty()) return {};
  std::string driver = driver_at(sysfs + "/bus/spi/devices/spi" + std::string{select});
  return driver == "spidev" ? std::string{} : driver;
}

}  // namespace zerorate::hal::linux_os
