/// @file
/// FIFO of a simulated chip whose packets are read byte by byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace zerorate::hal::sim {

/// Packets of any size, oldest first.
class PacketFifo {
 public:
  using Packet = std::vector<std::uint8_t>;

  void clear() {
    packets_.clear();
    cursor_ = 0;
  }
  void push(const Packet& packet) { packets_.push_back(packet); }
  void drop_oldest() {
    packets_.pop_front();
    cursor_ = 0;
  }
  /// A packet of which only a part was read begins anew.
  void rewind() { cursor_ = 0; }

  [[nodiscard]] std::size_t packets() const { return packets_.size(); }
  /// Bytes of all packets, those that were read of the oldest included.
  [[nodiscard]] std::size_t bytes() const {
    std::size_t sum = 0;
    for (const Packet& packet : packets_) sum += packet.size();
    return sum;
  }
  /// Bytes of the oldest packet that were read.
  [[nodiscard]] std::size_t cursor() const { return cursor_; }

  /// @return FFh where there is none
  std::uint8_t read_byte() {
    if (packets_.empty()) return 0xFF;
    const std::uint8_t byte = packets_.front().at(cursor_++);
    if (cursor_ == packets_.front().size()) drop_oldest();
    return byte;
  }

  using Axes = std::span<const std::uint8_t, 6>;

  /// Three words, as registers hold them.
  static Axes axes_at(std::span<const std::uint8_t> registers, std::size_t first) {
    return registers.subspan(first).first<6>();
  }
  /// Eight bytes with the rates alone, sixteen with the acceleration in front of them. The last two
  /// of these are a time stamp, which is not modelled.
  static Packet sample(std::uint8_t header, const std::optional<Axes>& acceleration, Axes rates,
                       std::uint8_t temperature) {
    Packet packet{header};
    if (acceleration) packet.insert(packet.end(), acceleration->begin(), acceleration->end());
    packet.insert(packet.end(), rates.begin(), rates.end());
    packet.push_back(temperature);
    packet.resize(acceleration ? 16 : 8);
    return packet;
  }

 private:
  std::deque<Packet> packets_;
  std::size_t cursor_ = 0;
};

}  // namespace zerorate::hal::sim
