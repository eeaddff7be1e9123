/// @file
/// A memory-mapped register as a type, so that a wrong access does not compile.
#pragma once

#include <cstdint>

namespace zerorate::hal::rp2040 {

enum class Access : std::uint8_t { read_only, write_only, read_write };

/// One 32-bit register of the RP2040. An empty type: an access is one load or store, and never a
/// call, which code in RAM could not make while the flash is away.
///
/// The registers of the APB and AHB peripherals have atomic aliases that set or clear the bits
/// written as ones and leave the others alone, which an interrupt cannot tear (RP2040 datasheet,
/// section 2.1.2).
template <std::uint32_t Address, Access Kind = Access::read_write>
class Register {
 public:
  static constexpr bool kHasAliases = Address >= 0x4000'0000 && Address < 0x6000'0000;

  [[gnu::always_inline]] [[nodiscard]] static std::uint32_t read() requires(Kind !=
                                                                            Access::write_only) {
    return at(Address);
  }
  [[gnu::always_inline]] static void write(std::uint32_t value) requires(Kind !=
                                                                         Access::read_only) {
    at(Address) = value;
  }
  static void set(std::uint32_t bits) requires(Kind != Access::read_only && kHasAliases) {
    at(Address + 0x2000) = bits;
  }
  static void clear(std::uint32_t bits) requires(Kind != Access::read_only && kHasAliases) {
    at(Address + 0x3000) = bits;
  }
  /// Some registers act when they are read, whatever the value.
  static void touch() requires(Kind != Access::write_only) {
    [[maybe_unused]] const std::uint32_t ignored = read();
  }
  /// Blocks until all of these bits are ones. Only for what the hardware always does.
  static void await(std::uint32_t bits) requires(Kind != Access::write_only) {
    while ((read() & bits) != bits) {
    }
  }

 private:
  [[gnu::always_inline]] static volatile std::uint32_t& at(std::uint32_t address) {
    // The address is the hardware's.
    // NOLINTNEXTLINE(performance-no-int-to-ptr,cppcoreguidelines-pro-type-reinterpret-cast)
    return *reinterpret_cast<volatile std::uint32_t*>(std::uintptr_t{address});
  }
};

template <std::uint32_t Address>
using ReadOnly = Register<Address, Access::read_only>;
template <std::uint32_t Address>
using WriteOnly = Register<Address, Access::write_only>;

[[nodiscard]] constexpr std::uint32_t bit(unsigned index) {
  return std::uint32_t{1} << index;
}

}  // namespace zerorate::hal::rp2040
