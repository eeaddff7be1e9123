#include "hal/linux/iio_axes.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>

#include "hal/linux/iio_element.hpp"

namespace zerorate::hal::linux_os {
namespace {

constexpr std::string_view kAxisNames = "xyz";

std::string channel_of(const IioQuantity& quantity, char axis) {
  return "in_" + std::string{quantity.channel} + "_" + axis;
}

}  // namespace

bool has_axes(const SysfsFolder& device, const IioQuantity& quantity) {
  return std::ranges::any_of(
      kAxisNames, [&](char axis) { return device.has(channel_of(quantity, axis) + "_raw"); });
}

std::optional<std::string> rate_attribute(const SysfsFolder& device, const IioQuantity& quantity) {
  return device.first_of(
      {"sampling_frequency", "in_" + std::string{quantity.channel} + "_sampling_frequency"});
}

IioAxes::IioAxes(const SysfsFolder& device, const IioQuantity& quantity)
    : device_(device), quantity_(quantity) {
  for (const char axis : kAxisNames) {
    std::string channel = channel_of(quantity, axis);
    if (device_.has(channel + "_raw")) names_.push_back(std::move(channel));
  }
  const bool is_single = names_.size() == 1 && quantity.may_have_one_axis;
  if (names_.size() != 3 && !is_single) {
    throw KernelFileError(device_.path(), "no three axes of " + std::string{quantity.sensor});
  }
  find_counts();
  read_mounting();
}

std::string IioAxes::attribute(std::string_view name) const {
  return "in_" + std::string{quantity_.channel} + "_" + std::string{name};
}

/// Accelerometers have 10 to 16 bits, adis16475 gives 32 of all it reads. A driver without a buffer
/// shows none; then 16 are taken.
void IioAxes::find_counts() {
  const std::string type = "scan_elements/" + names_[0] + "_type";
  if (!device_.has(type)) return;
  const IioElement element = parse_iio_type(device_.text(type), device_.path_of(type));
  if (element.is_signed && element.bits <= 32) counts_ = std::int64_t{1} << (element.bits - 1);
}

void IioAxes::set_range(double full_scale) {
  constexpr double kRounding = 0.99;  // a scale may be given with two digits (bmg160)
  const auto found = device_.first_of({attribute("scale"), names_[0] + "_scale"});
  if (!found) throw KernelFileError(device_.path_of(attribute("scale")), ENOENT);
  const auto choices = device_.first_of({attribute("scale_available"),
                                         std::string{quantity_.channel} + "_scale_available",
                                         names_[0] + "_scale_available"});
  const auto holds = [&](double scale) {
    return (scale + kIioDigits) * static_cast<double>(counts_) >= kRounding * full_scale;
  };
  if (choices) {
    auto scales = parse_numbers(device_.text(*choices), device_.path_of(*choices));
    std::ranges::sort(scales);
    const auto smallest = std::ranges::find_if(scales, holds);
    if (smallest == scales.end()) {
      throw KernelFileError(device_.path_of(*choices),
                            "no range is so large as " + std::string{quantity_.range_key});
    }
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), *smallest,
                                   std::chars_format::fixed, 9);
    device_.write(*found, {digits.data(), end.ptr});
  }
  scale_ = device_.number(*found);
  if (!(scale_ > 0.0)) throw KernelFileError(device_.path_of(*found), "not above 0");
  if (!choices && !holds(scale_)) {
    throw KernelFileError(device_.path_of(*found),
                          "the range is smaller than " + std::string{quantity_.range_key});
  }
  scale_attribute_ = *found;
}

void IioAxes::read_mounting() {
  const auto found =
      device_.first_of({attribute("mount_matrix"), "in_mount_matrix", "mount_matrix"});
  if (!found) return;
  const auto numbers = parse_numbers(device_.text(*found), device_.path_of(*found));
  if (numbers.size() != 9) {
    throw KernelFileError(device_.path_of(*found), "not nine numbers");
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) mounting_.at(i / 3).at(i % 3) = numbers[i];
}

IioAxes::Raw IioAxes::read() const {
  Raw raw{};
  for (std::size_t i = 0; i < names_.size(); ++i) {
    raw.at(i) = static_cast<std::int64_t>(device_.number(names_[i] + "_raw"));
  }
  if (names_.size() == 1) raw.fill(raw[0]);
  return raw;
}

}  // namespace zerorate::hal::linux_os
