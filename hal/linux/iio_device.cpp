#include "hal/linux/iio_device.hpp"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <iterator>

namespace zerorate::hal::linux_os {
namespace {

constexpr double kWakeUps_hz = 50.0;
constexpr double kRoom_s = 2.0;

std::string listed(const std::vector<IioIdentity>& devices) {
  std::string list;
  for (const IioIdentity& device : devices) {
    list += (list.empty() ? "" : ", ") + device.node + " \"" + device.name + "\"";
    if (!device.label.empty()) list += " labelled \"" + device.label + "\"";
  }
  return list;
}

bool is_called(const IioIdentity& device, std::string_view wanted) {
  constexpr std::string_view kFolder = "/dev/";
  if (wanted.starts_with(kFolder)) wanted.remove_prefix(kFolder.size());
  return wanted == device.node || "iio:device" + std::string{wanted} == device.node ||
         wanted == device.name || (!device.label.empty() && wanted == device.label);
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

std::vector<IioIdentity> find_iio_devices(const IioPlaces& places, const IioQuantity& quantity) {
  std::vector<IioIdentity> devices;
  for (const std::string& entry : SysfsFolder{places.sysfs}.entries()) {
    const SysfsFolder folder{places.sysfs + "/" + entry};
    if (!entry.starts_with("iio:device") || !has_axes(folder, quantity)) continue;
    devices.push_back({entry, folder.text_or("name", ""), folder.text_or("label", "")});
  }
  std::ranges::sort(devices, [](const IioIdentity& a, const IioIdentity& b) {
    return std::pair{a.node.size(), a.node} < std::pair{b.node.size(), b.node};
  });
  return devices;
}

IioIdentity find_iio_device(const IioPlaces& places, const IioQuantity& quantity,
                            std::string_view wanted) {
  const std::vector<IioIdentity> all = find_iio_devices(places, quantity);
  const std::string sensor{quantity.sensor};
  std::vector<IioIdentity> found;
  std::ranges::copy_if(all, std::back_inserter(found),
                       [&](const IioIdentity& device) { return is_called(device, wanted); });
  if (found.size() == 1) return found.front();
  const std::string quoted = "\"" + std::string{wanted} + "\"";
  if (!found.empty()) {
    throw KernelFileError(places.sysfs, "several " + sensor + "s are called " + quoted,
                          "give its number or label: " + listed(found));
  }
  throw KernelFileError(places.sysfs, "no " + sensor + " is called " + quoted,
                        all.empty() ? "there is none; is the driver's module loaded and bound?"
                                    : "there are " + listed(all));
}

IioDevice::IioDevice(const IioPlaces& places, const IioQuantity& quantity, std::string_view wanted,
                     const IioWishes& wishes)
    : identity_(find_iio_device(places, quantity, wanted)),
      nodes_(places.nodes),
      devices_(places.sysfs),
      calls_(places.calls != nullptr ? places.calls : &real_calls()),
      folder_(places.sysfs + "/" + identity_.node),
      axes_(folder_, quantity) {
  if (wishes.acceleration_range_m_s2) acceleration_.emplace(folder_, kIioAcceleration);
  find_thermometer();
  if (has_buffer()) open_node();
  set_range(axes_, wishes.full_scale);
  const auto rate = rate_attribute(folder_, quantity);
  rate_hz_ = set_rate(rate, wishes.rate_hz);
  if (!acceleration_) return;
  set_range(*acceleration_, *wishes.acceleration_range_m_s2);
  const auto rate_of_acceleration = rate_attribute(folder_, kIioAcceleration);
  if (rate_of_acceleration != rate) (void)set_rate(rate_of_acceleration, wishes.rate_hz);
}

void IioDevice::set_range(IioAxes& axes, double full_scale) {
  axes.set_range(full_scale);
  keep(axes.scale_attribute());
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

void IioDevice::find_thermometer() {
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

double IioDevice::set_rate(const std::optional<std::string>& attribute, double rate_hz) {
  if (!attribute) return rate_hz;  // the driver has none; the rate is that of the polling
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
  const double told_hz = folder_.number(*attribute);
  if (!is_near(told_hz, rate_hz)) {
    throw KernelFileError(folder_.path_of(*attribute), "reads " + folder_.text(*attribute) +
                                                           " after " + written + " was written");
  }
  keep(*attribute);
  return told_hz;
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

std::vector<std::string> IioDevice::scanned_channels() const {
  std::vector<std::string> channels = axes_.names();
  if (acceleration_) std::ranges::copy(acceleration_->names(), std::back_inserter(channels));
  return channels;
}

void IioDevice::lay_out_scan() {
  const std::vector<std::string> channels = scanned_channels();
  const std::string temperature = temperature_.empty() ? "in_temp" : temperature_;
  std::vector<std::pair<int, std::string>> order;
  for (const std::string& entry : SysfsFolder{folder_.path_of("scan_elements")}.entries()) {
    if (!entry.ends_with("_en")) continue;
    const std::string channel = entry.substr(0, entry.size() - 3);
    const bool is_wanted = channel == "in_timestamp" || channel == temperature ||
                           std::ranges::find(channels, channel) != channels.end();
    const std::string enable = "scan_elements/" + entry;
    const std::string wanted = is_wanted ? "1" : "0";
    if (folder_.text(enable) != wanted) folder_.write(enable, wanted);
    const auto index = folder_.number("scan_elements/" + channel + "_index");
    if (is_wanted) order.emplace_back(static_cast<int>(index), channel);
  }
  std::ranges::sort(order);
  elements_.assign(channels.size(), {});
  temperature_element_.reset();
  std::size_t end = 0;
  std::size_t largest = 1;
  for (const auto& [index, channel] : order) {
    const std::string type = "scan_elements/" + channel + "_type";
    IioElement element = parse_iio_type(folder_.text(type), folder_.path_of(type));
    end = place(element, end);
    largest = std::max<std::size_t>(largest, element.bytes);
    const auto axis = std::ranges::find(channels, channel);
    if (axis != channels.end()) {
      elements_.at(static_cast<std::size_t>(axis - channels.begin())) = element;
    }
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
  const std::size_t axes = axes_.names().size();
  for (std::size_t i = 0; i < scan.raw.size(); ++i) {
    scan.raw.at(i) = elements_[std::min(i, axes - 1)].decode(bytes);
  }
  if (acceleration_) {
    scan.acceleration.emplace();
    for (std::size_t i = 0; i < scan.acceleration->size(); ++i) {
      scan.acceleration->at(i) = elements_.at(axes + i).decode(bytes);
    }
  }
  if (temperature_element_) scan.temperature = temperature_element_->decode(bytes);
  return std::optional{scan};
}

IioScan IioDevice::read_attributes() const {
  IioScan scan{.raw = axes_.read()};
  if (acceleration_) scan.acceleration = acceleration_->read();
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
