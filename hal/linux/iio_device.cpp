#include "hal/linux/iio_device.hpp"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>

namespace zerorate::hal::linux_os {
namespace {

constexpr std::string_view kAxisNames = "xyz";
constexpr double kWakeUps_hz = 50.0;
constexpr double kRoom_s = 2.0;

bool is_gyro(const SysfsFolder& folder) {
  return std::ranges::any_of(kAxisNames, [&](char axis) {
    return folder.has(std::string{"in_anglvel_"} + axis + "_raw");
  });
}

std::string listed(const std::vector<IioIdentity>& gyros) {
  std::string list;
  for (const IioIdentity& gyro : gyros) {
    list += (list.empty() ? "" : ", ") + gyro.node + " \"" + gyro.name + "\"";
    if (!gyro.label.empty()) list += " labelled \"" + gyro.label + "\"";
  }
  return list;
}

bool is_called(const IioIdentity& gyro, std::string_view wanted) {
  constexpr std::string_view kFolder = "/dev/";
  if (wanted.starts_with(kFolder)) wanted.remove_prefix(kFolder.size());
  return wanted == gyro.node || "iio:device" + std::string{wanted} == gyro.node ||
         wanted == gyro.name || (!gyro.label.empty() && wanted == gyro.label);
}

unsigned number_at(std::string_view& text) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return 0;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

bool take(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

/// The element's place: after the one before, at a multiple of its own size.
std::size_t place(IioElement& element, std::size_t end) {
  element.offset = (end + element.bytes - 1) / element.bytes * element.bytes;
  return element.offset + element.bytes;
}

FileCalls& real_calls() {
  static FileCalls calls;
  return calls;
}

bool is_near(double a, double b) {
  return std::abs(a - b) <= 0.01 * std::abs(b);
}

}  // namespace

IioElement parse_iio_type(std::string_view type, const std::string& path) {
  std::string_view rest = type;
  IioElement element;
  element.is_big_endian = rest.starts_with("be:");
  bool is_right = take(rest, "be:") || take(rest, "le:");
  element.is_signed = rest.starts_with('s');
  is_right = is_right && (take(rest, "s") || take(rest, "u"));
  element.bits = number_at(rest);
  is_right = is_right && take(rest, "/");
  const unsigned storage = number_at(rest);
  element.bytes = storage / 8;
  if (take(rest, ">>")) element.shift = number_at(rest);
  const bool is_storage = storage == 8 || storage == 16 || storage == 32 || storage == 64;
  if (!is_right || !rest.empty() || !is_storage || element.bits == 0 ||
      element.bits + element.shift > storage) {
    throw KernelFileError(path, "\"" + std::string{type} + "\" is no layout that is understood",
                          "expected is one as \"le:s16/16>>0\"");
  }
  return element;
}

std::int64_t IioElement::decode(std::span<const std::uint8_t> scan) const {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < bytes; ++i) {
    const unsigned significance = is_big_endian ? bytes - 1 - i : i;
    value |= std::uint64_t{scan[offset + i]} << (8 * significance);
  }
  const unsigned unused = 64 - bits;
  value = (value >> shift) << unused;
  if (is_signed) return static_cast<std::int64_t>(value) >> unused;
  return static_cast<std::int64_t>(value >> unused);
}

std::vector<IioIdentity> find_iio_gyros(const IioPlaces& places) {
  std::vector<IioIdentity> gyros;
  for (const std::string& entry : SysfsFolder{places.sysfs}.entries()) {
    const SysfsFolder folder{places.sysfs + "/" + entry};
    if (!entry.starts_with("iio:device") || !is_gyro(folder)) continue;
    gyros.push_back({entry, folder.text_or("name", ""), folder.text_or("label", "")});
  }
  std::ranges::sort(gyros, [](const IioIdentity& a, const IioIdentity& b) {
    return std::pair{a.node.size(), a.node} < std::pair{b.node.size(), b.node};
  });
  return gyros;
}

IioIdentity find_iio_gyro(const IioPlaces& places, std::string_view wanted) {
  const std::vector<IioIdentity> all = find_iio_gyros(places);
  std::vector<IioIdentity> found;
  std::ranges::copy_if(all, std::back_inserter(found),
                       [&](const IioIdentity& gyro) { return is_called(gyro, wanted); });
  if (found.size() == 1) return found.front();
  const std::string quoted = "\"" + std::string{wanted} + "\"";
  if (!found.empty()) {
    throw KernelFileError(places.sysfs, "several gyros are called " + quoted,
                          "give its number or label: " + listed(found));
  }
  throw KernelFileError(places.sysfs, "no gyro is called " + quoted,
                        all.empty() ? "there is none; is the driver's module loaded and bound?"
                                    : "there are " + listed(all));
}

std::optional<std::string> rate_attribute(const SysfsFolder& device) {
  return device.first_of({"sampling_frequency", "in_anglvel_sampling_frequency"});
}

IioDevice::IioDevice(const IioPlaces& places, std::string_view wanted, const IioWishes& wishes)
    : identity_(find_iio_gyro(places, wanted)),
      nodes_(places.nodes),
      devices_(places.sysfs),
      calls_(places.calls != nullptr ? places.calls : &real_calls()),
      folder_(places.sysfs + "/" + identity_.node) {
  find_channels();
  if (has_buffer()) open_node();
  set_scale(wishes.full_scale_rad_s);
  set_rate(wishes.rate_hz);
  read_mounting();
}

/// Settings of a device whose buffer runs cannot be changed. Who has the node has the device.
void IioDevice::open_node() {
  const std::string node = nodes_ + "/" + identity_.node;
  const CallResult opened = calls_->open(node.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC, 0);
  if (!opened) {
    const int error = opened.error();
    throw KernelFileError(node, error,
                          error == EBUSY    ? "another program reads it, e.g. iio-sensor-proxy"
                          : error == EACCES ? "is the udev rule of zerorate installed?"
                                            : "is the driver bound?");
  }
  node_.reset(*opened);
  if (folder_.text("buffer/enable") != "0") folder_.write("buffer/enable", "0");
}

void IioDevice::find_channels() {
  for (const char axis : kAxisNames) {
    std::string channel = std::string{"in_anglvel_"} + axis;
    if (folder_.has(channel + "_raw")) axes_.push_back(std::move(channel));
  }
  if (axes_.size() == 2) throw KernelFileError(folder_.path(), "a gyro of two axes");
  for (const char* const name : {"in_temp", "in_temp0"}) {
    if (folder_.has(std::string{name} + "_raw")) temperature_ = name;
  }
  if (temperature_.empty()) return;
  if (folder_.has(temperature_ + "_scale")) {
    temperature_scale_ = folder_.number(temperature_ + "_scale");
  }
  if (folder_.has(temperature_ + "_offset")) {
    temperature_offset_ = folder_.number(temperature_ + "_offset");
  }
}

void IioDevice::set_scale(double full_scale_rad_s) {
  constexpr double kCounts = 32768.0;
  constexpr double kRounding = 0.99;  // a scale may be given with two digits (bmg160)
  const auto attribute = folder_.first_of({"in_anglvel_scale", axes_[0] + "_scale"});
  if (!attribute) throw KernelFileError(folder_.path_of("in_anglvel_scale"), ENOENT);
  const auto choices = folder_.first_of(
      {"in_anglvel_scale_available", "anglvel_scale_available", axes_[0] + "_scale_available"});
  const auto holds = [&](double scale) { return scale * kCounts >= kRounding * full_scale_rad_s; };
  if (choices) {
    auto scales = parse_numbers(folder_.text(*choices), folder_.path_of(*choices));
    std::ranges::sort(scales);
    const auto smallest = std::ranges::find_if(scales, holds);
    if (smallest == scales.end()) {
      throw KernelFileError(folder_.path_of(*choices), "no range is so large as full_scale_dps");
    }
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), *smallest,
                                   std::chars_format::fixed, 9);
    folder_.write(*attribute, {digits.data(), end.ptr});
  }
  scale_ = folder_.number(*attribute);
  if (!(scale_ > 0.0)) throw KernelFileError(folder_.path_of(*attribute), "not above 0");
  if (!choices && !holds(scale_)) {
    throw KernelFileError(folder_.path_of(*attribute), "the range is smaller than full_scale_dps");
  }
  keep(*attribute);
}

void IioDevice::set_rate(double rate_hz) {
  rate_hz_ = rate_hz;
  const auto attribute = rate_attribute(folder_);
  if (!attribute) return;  // the driver has none; the rate is that of the polling
  const std::string available = folder_.text_or(*attribute + "_available", "");
  std::string written;
  std::size_t begin = 0;
  // The word of the list is written, as the driver printed it. A range "[1 1 100]" has no such
  // word.
  while (available.find('[') == std::string::npos && begin < available.size()) {
    const std::size_t end = std::min(available.find(' ', begin), available.size());
    const std::string word = available.substr(begin, end - begin);
    for (const double value : parse_numbers(word, folder_.path_of(*attribute + "_available"))) {
      if (is_near(value, rate_hz)) written = word;
    }
    begin = end + 1;
  }
  if (written.empty() && (available.empty() || available.find('[') != std::string::npos)) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), rate_hz);
    written.assign(digits.data(), end.ptr);
  }
  if (written.empty()) {
    throw KernelFileError(folder_.path_of(*attribute), "the driver has no rate of rate_hz",
                          "it offers " + available);
  }
  folder_.write(*attribute, written);
  rate_hz_ = folder_.number(*attribute);
  if (!is_near(rate_hz_, rate_hz)) {
    throw KernelFileError(folder_.path_of(*attribute), "reads " + folder_.text(*attribute) +
                                                           " after " + written + " was written");
  }
  keep(*attribute);
}

void IioDevice::read_mounting() {
  const auto attribute =
      folder_.first_of({"in_anglvel_mount_matrix", "in_mount_matrix", "mount_matrix"});
  if (!attribute) return;
  const auto numbers = parse_numbers(folder_.text(*attribute), folder_.path_of(*attribute));
  if (numbers.size() != 9) {
    throw KernelFileError(folder_.path_of(*attribute), "not nine numbers");
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) mounting_.at(i / 3).at(i % 3) = numbers[i];
}

double IioDevice::celsius(std::int64_t raw) const {
  return (static_cast<double>(raw) + temperature_offset_) * temperature_scale_ / 1000.0;
}

bool IioDevice::has_buffer() const {
  return folder_.has("buffer/enable") && folder_.has("scan_elements/in_timestamp_en");
}

void IioDevice::start_buffer() {
  if (folder_.text_or("current_timestamp_clock", "") != "monotonic") {
    folder_.write("current_timestamp_clock", "monotonic");
  }
  keep("current_timestamp_clock");
  lay_out_scan();
  take_trigger();
  const auto samples = [&](double seconds, int least) {
    return std::to_string(std::max(least, static_cast<int>(std::lround(seconds * rate_hz_))));
  };
  folder_.write("buffer/length", samples(kRoom_s, 64));
  if (folder_.has("buffer/watermark")) {
    folder_.write("buffer/watermark", samples(1.0 / kWakeUps_hz, 1));
  }
  folder_.write("buffer/enable", "1");
  keep("buffer/enable");
}

void IioDevice::take_trigger() const {
  constexpr std::string_view kCurrent = "trigger/current_trigger";
  if (!folder_.has(kCurrent) || !folder_.text(kCurrent).empty()) return;
  const std::string number = identity_.node.substr(std::string_view{"iio:device"}.size());
  const std::string own = identity_.name + "-dev" + number;
  for (const std::string& entry : SysfsFolder{devices_}.entries()) {
    if (!entry.starts_with("trigger")) continue;
    const SysfsFolder trigger{devices_ + "/" + entry};
    if (trigger.text_or("name", "") == own) return folder_.write(kCurrent, own);
  }
  throw KernelFileError(folder_.path_of(kCurrent),
                        "no trigger is set, and none is called \"" + own + "\"",
                        "is the chip's interrupt line in the device tree?");
}

void IioDevice::lay_out_scan() {
  const std::string temperature = temperature_.empty() ? "in_temp" : temperature_;
  std::vector<std::pair<int, std::string>> order;
  for (const std::string& entry : SysfsFolder{folder_.path_of("scan_elements")}.entries()) {
    if (!entry.ends_with("_en")) continue;
    const std::string channel = entry.substr(0, entry.size() - 3);
    const bool is_wanted = channel == "in_timestamp" || channel == temperature ||
                           std::ranges::find(axes_, channel) != axes_.end();
    const std::string enable = "scan_elements/" + entry;
    const std::string wanted = is_wanted ? "1" : "0";
    if (folder_.text(enable) != wanted) folder_.write(enable, wanted);
    const auto index = folder_.number("scan_elements/" + channel + "_index");
    if (is_wanted) order.emplace_back(static_cast<int>(index), channel);
  }
  std::ranges::sort(order);
  elements_.assign(axes_.size(), {});
  temperature_element_.reset();
  std::size_t end = 0;
  std::size_t largest = 1;
  for (const auto& [index, channel] : order) {
    const std::string type = "scan_elements/" + channel + "_type";
    IioElement element = parse_iio_type(folder_.text(type), folder_.path_of(type));
    end = place(element, end);
    largest = std::max<std::size_t>(largest, element.bytes);
    const auto axis = std::ranges::find(axes_, channel);
    if (axis != axes_.end()) elements_.at(static_cast<std::size_t>(axis - axes_.begin())) = element;
    if (channel == temperature) temperature_element_ = element;
    if (channel == "in_timestamp") stamp_ = element;
  }
  if (std::ranges::any_of(elements_, [](const IioElement& e) { return e.bytes == 0; })) {
    throw KernelFileError(folder_.path_of("scan_elements"), "an axis is missing");
  }
  scan_bytes_ = (end + largest - 1) / largest * largest;
  constexpr std::size_t kScansAtOnce = 64;
  bytes_.resize(kScansAtOnce * scan_bytes_);
  begin_ = end_ = 0;
}

void IioDevice::keep(const std::string& attribute) {
  settings_.push_back({attribute, folder_.text(attribute)});
}

bool IioDevice::verify_next() {
  const Setting& setting = settings_.at(verified_++ % settings_.size());
  return folder_.text(setting.attribute) == setting.value;
}

/// False: less than a scan waits, or `error` is set.
bool IioDevice::refill(int& error) {
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_),
            bytes_.begin() + static_cast<std::ptrdiff_t>(end_), bytes_.begin());
  end_ -= begin_;
  begin_ = 0;
  const CallResult count = calls_->read(node_.get(), std::span{bytes_}.subspan(end_));
  if (count) {
    end_ += static_cast<std::size_t>(*count);
  } else if (count.error() != EAGAIN && count.error() != EINTR) {
    error = count.error();
  }
  return end_ >= scan_bytes_;
}

core::Result<std::optional<IioScan>, int> IioDevice::next_scan() {
  int error = 0;
  if (end_ - begin_ < scan_bytes_ && !refill(error)) {
    if (error != 0) return core::Unexpected{error};
    return std::optional<IioScan>{};
  }
  const auto bytes = std::span{bytes_}.subspan(begin_, scan_bytes_);
  begin_ += scan_bytes_;
  IioScan scan;
  scan.time = core::Instant{} + core::Duration::nanoseconds(stamp_.decode(bytes));
  for (std::size_t i = 0; i < scan.raw.size(); ++i) {
    scan.raw.at(i) = elements_[std::min(i, elements_.size() - 1)].decode(bytes);
  }
  if (temperature_element_) scan.temperature = temperature_element_->decode(bytes);
  return std::optional{scan};
}

IioScan IioDevice::read_attributes() const {
  IioScan scan;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    scan.raw.at(i) = static_cast<std::int64_t>(folder_.number(axes_[i] + "_raw"));
  }
  if (axes_.size() == 1) scan.raw.fill(scan.raw[0]);
  return scan;
}

std::optional<std::int64_t> IioDevice::read_temperature() const {
  if (temperature_.empty()) return std::nullopt;
  try {
    return static_cast<std::int64_t>(folder_.number(temperature_ + "_raw"));
  } catch (const KernelFileError&) {
    return std::nullopt;  // many drivers refuse it while their buffer runs
  }
}

}  // namespace zerorate::hal::linux_os
