#include "core/base/crc32.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cstddef>
#include <random>
#include <vector>

namespace zerorate::core {
namespace {

TEST(Crc32OfTheCheckString, IsTheCataloguedValue) {
  constexpr std::array<std::uint8_t, 9> kCheck{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  static_assert(crc32(kCheck) == 0xCBF43926U);  // CRC RevEng catalogue, CRC-32/ISO-HDLC
  static_assert(crc32({}) == 0U);
}

TEST(Crc32OfRandomBytes, IsThatOfZlibInOnePieceOrTwo) {
  std::mt19937 random{7};
  for (std::size_t size = 1; size < 300; ++size) {
    std::vector<std::uint8_t> bytes(size);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const auto expected = ::crc32(0, bytes.data(), static_cast<unsigned>(size));
    EXPECT_EQ(crc32(bytes), expected);
    const std::size_t cut = random() % (size + 1);
    const std::span all{bytes};
    EXPECT_EQ(crc32(all.subspan(cut), crc32(all.first(cut))), expected);
  }
}

}  // namespace
}  // namespace zerorate::core
