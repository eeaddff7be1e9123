#include "firmware/boards/linux/saved_state.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "core/base/crc32.hpp"
#include "firmware/wire/little_endian.hpp"

namespace zerorate::linux_node {
namespace {

/// Adds numbers to a checksum, in one order and without the padding between them.
class Fingerprint {
 public:
  void add(float number) { add(std::bit_cast<std::uint32_t>(number)); }
  void add(core::Duration duration) { add(static_cast<std::uint64_t>(duration.ns())); }
  template <std::unsigned_integral Number>
  void add(Number number) {
    std::array<std::uint8_t, sizeof(Number)> bytes{};
    wire::LittleEndianWriter{bytes}.put(number);
    crc_ = core::crc32(bytes, crc_);
  }
  void add(core::Complex number) {
    add(number.re);
    add(number.im);
  }
  void add(std::string_view text) {
    for (const char letter : text) add(static_cast<std::uint8_t>(letter));
  }
  [[nodiscard]] std::uint32_t value() const { return crc_; }

 private:
  std::uint32_t crc_ = 0;
};

std::uint32_t fingerprint(const Node::Params& params) {
  Fingerprint print;
  print.add(std::string_view{ZERORATE_VERSION});
  print.add(std::uint64_t{sizeof(Node::State)});
  print.add(params.modes.tick);
  print.add(static_cast<std::uint8_t>(params.modes.start));
  print.add(params.modes.walk_variance);
  const auto add_modes = [&](const auto& modes) {
    for (const auto& mode : modes) {
      print.add(mode.forgetting);
      print.add(mode.noise_variance);
      print.add(mode.initial_variance);
      print.add(mode.initial_mean);
    }
  };
  add_modes(params.modes.decaying);
  add_modes(params.modes.rotating);
  print.add(params.white_variance_rad2_s2);
  print.add(params.unaveraged_variance_rad2_s2);
  print.add(params.gate.threshold_sigma);
  print.add(std::uint64_t{params.gate.longest_knock_ticks});
  print.add(params.sample_period);
  print.add(params.standstill.settle);
  print.add(params.standstill.hold_back);
  return print.value();
}

}  // namespace

BootId read_boot_id() {
  constexpr const char* kFile = "/proc/sys/kernel/random/boot_id";
  BootId boot{};
  std::ifstream file{kFile};
  if (!file.read(boot.data(), boot.size())) {
    throw std::system_error(errno, std::generic_category(), kFile);
  }
  return boot;
}

StateRecord::StateRecord(const Node::Params& params, const BootId& boot) {
  wire::LittleEndianWriter{header_}.put(fingerprint(params));
  std::ranges::copy(boot, header_.begin() + 4);
}

StateRecord::Bytes StateRecord::encode(const Node::State& state) const {
  Bytes record{};
  std::ranges::copy(header_, record.begin());
  std::memcpy(&record[kHeaderBytes], &state, sizeof state);
  return record;
}

std::optional<Node::State> StateRecord::decode(std::span<const std::uint8_t> record) const {
  if (record.size() != kBytes || !std::ranges::equal(record.first(kHeaderBytes), header_)) {
    return std::nullopt;
  }
  Node::State state;
  std::memcpy(&state, &record[kHeaderBytes], sizeof state);
  return state;
}

}  // namespace zerorate::linux_node
