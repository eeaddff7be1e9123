/// @file
/// The protected frames: profile 11 against examples of others and a polynomial division, and
/// signals where the tables of the documents put them.

#include "firmware/wire/can_protected.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "host_tests/unit/firmware/wire/messages.hpp"

namespace zerorate::wire {
namespace {

constexpr E2eSettings kBoth{.data_id = 0x123, .variant = E2eVariant::both};
constexpr E2eSettings kNibble{.data_id = 0x123, .variant = E2eVariant::nibble};

/// Eight bytes of zeros, protected.
std::array<std::uint8_t, 8> protected_zeros(const E2eSettings& e2e, std::uint8_t counter) {
  std::array<std::uint8_t, 8> frame{};
  e2e_protect(frame, e2e, counter);
  return frame;
}

using EightBytes = std::array<std::uint8_t, 8>;

/// PRS_E2EProtocol, "E2E Profile 11 protocol examples", as the tests of two open implementations
/// have them (the packages autosar-e2e of Python and Rust): data of zeros, identifier 0x123.
TEST(E2eProfile11, GivesThePublishedExamples) {
  EXPECT_EQ(protected_zeros(kBoth, 0), (EightBytes{0xCC, 0x00}));
  EXPECT_EQ(protected_zeros(kBoth, 1), (EightBytes{0x91, 0x01}));
  EXPECT_EQ(protected_zeros(kNibble, 0), (EightBytes{0x2A, 0x10}));
  EXPECT_EQ(protected_zeros(kNibble, 1), (EightBytes{0x77, 0x11}));
}

/// Check value of CRC-8/SAE-J1850: start and final inversion 0xFF over "123456789".
TEST(E2eCrc8, HasThePolynomialOfSaeJ1850) {
  std::uint8_t crc = 0xFF;
  for (const char digit : {'1', '2', '3', '4', '5', '6', '7', '8', '9'}) {
    crc = e2e_crc8(crc, static_cast<std::uint8_t>(digit));
  }
  EXPECT_EQ(crc ^ 0xFF, 0x4B);
}

/// Remainder of the message times x^8, as a long division of polynomials, bit by bit.
unsigned remainder_of(const std::vector<std::uint8_t>& bytes) {
  std::vector<unsigned> bits;
  for (const std::uint8_t byte : bytes) {
    for (int i = 7; i >= 0; --i) bits.push_back((byte >> i) & 1U);
  }
  bits.insert(bits.end(), 8, 0U);
  constexpr std::array divisor{1U, 0U, 0U, 0U, 1U, 1U, 1U, 0U, 1U};  // x^8 + x^4 + x^3 + x^2 + 1
  for (std::size_t i = 0; i + 8 < bits.size(); ++i) {
    if (bits[i] == 0) continue;
    for (std::size_t k = 0; k < divisor.size(); ++k) bits[i + k] ^= divisor.at(k);
  }
  unsigned rest = 0;
  for (std::size_t i = bits.size() - 8; i < bits.size(); ++i) rest = 2 * rest + bits[i];
  return rest;
}

/// Verifies SR-IF-14.
TEST(ProtectedCanFrames, CarryCounterIdentifierAndChecksum) {
  std::mt19937_64 random{21};
  for (std::uint32_t i = 0; i < 300; ++i) {
    NumberedMessage sent = testing::random_message(random);
    sent.sequence = i;
    const bool is_both = random() % 2 == 0;
    const E2eSettings e2e{.data_id = static_cast<std::uint16_t>(random() % 0xEFF),
                          .variant = is_both ? E2eVariant::both : E2eVariant::nibble};
    const auto expect_protected = [&](auto frame) {
      EXPECT_EQ(frame.data[1] & 15, static_cast<int>(i % 15));
      EXPECT_EQ(frame.data[1] >> 4, is_both ? 0 : e2e.data_id >> 8);
      std::vector<std::uint8_t> covered{static_cast<std::uint8_t>(e2e.data_id & 0xFF),
                                        static_cast<std::uint8_t>(is_both ? e2e.data_id >> 8 : 0)};
      covered.insert(covered.end(), frame.data.begin() + 1, frame.data.end());
      EXPECT_EQ(frame.data[0], remainder_of(covered));
    };
    expect_protected(encode_can_yaw(sent, 0x100, e2e));
    expect_protected(encode_can_fd(sent, 0x100, e2e));
  }
}

/// Every error of up to three bits of a frame changes the checksum: a distance of four up to 119
/// bits.
TEST(ProtectedCanFrame, FindsEveryPairOfDamagedBits) {
  std::mt19937_64 random{22};
  const CanFrame frame = encode_can_yaw(testing::random_message(random), 0x100, kNibble);
  for (std::size_t first = 0; first < 64; ++first) {
    for (std::size_t second = first + 1; second < 64; ++second) {
      CanFrame damaged = frame;
      for (const std::size_t bit : {first, second}) {
        damaged.data[bit / 8] = static_cast<std::uint8_t>(damaged.data[bit / 8] ^ 1U << bit % 8);
      }
      EXPECT_NE(e2e_crc_of(damaged.data, kNibble), damaged.data[0]);
    }
  }
}

TEST(SigmaClass, DoublesFromClassToClass) {
  EXPECT_EQ(sigma_class(core::deg_per_s(0.0F)), 0);
  for (int k = 0; k < 15; ++k) {
    const float limit = std::ldexp(1e-4F, k);
    EXPECT_EQ(sigma_class(core::deg_per_s(0.999F * limit)), k);
    EXPECT_EQ(sigma_class(core::deg_per_s(1.001F * limit)), k + 1);
  }
  EXPECT_EQ(sigma_class(core::deg_per_s(std::numeric_limits<float>::infinity())), 15);
  EXPECT_EQ(sigma_class(core::deg_per_s(std::numeric_limits<float>::quiet_NaN())), 15);
}

/// A message whose yaw rate is -12.5 deg/s, with nothing against it.
NumberedMessage good_message() {
  NumberedMessage sent;
  sent.message.up = core::UpAxis{}.direction();
  sent.message.health.calibrated = true;
  for (app::AxisRate& axis : sent.message.axes) axis.sigma = core::deg_per_s(0.001F);
  sent.message.axes[2].corrected = core::deg_per_s(-12.5F);
  return sent;
}

std::int32_t yaw_count(const CanFrame& frame) {
  const auto byte = [&](std::size_t at) { return std::uint32_t{frame.data.at(at)}; };
  const std::uint32_t raw = byte(2) | byte(3) << 8U | byte(4) << 16U;
  return static_cast<std::int32_t>(raw << 8U) >> 8;
}
bool is_valid(const CanFrame& frame) {
  return (frame.data[5] & 1U) != 0;
}

TEST(CanYawFrame, IsValidWithACorrectedRateOnly) {
  const CanFrame good = encode_can_yaw(good_message(), 0x100, kNibble);
  EXPECT_EQ(yaw_count(good), -125'000);
  EXPECT_TRUE(is_valid(good));
  EXPECT_EQ(good.data[5] >> 4, 4);  // 0.0008 < 0.001 <= 0.0016 deg/s

  NumberedMessage uncalibrated = good_message();
  uncalibrated.message.health.calibrated = false;
  EXPECT_EQ(yaw_count(encode_can_yaw(uncalibrated, 0x100, kNibble)), -125'000);
  EXPECT_FALSE(is_valid(encode_can_yaw(uncalibrated, 0x100, kNibble)));
  NumberedMessage saturated = good_message();
  saturated.message.health.saturated = true;
  EXPECT_FALSE(is_valid(encode_can_yaw(saturated, 0x100, kNibble)));
}

/// Verifies SR-IF-13.
TEST(CanYawFrame, SaysThatThereIsNoRate) {
  constexpr std::int32_t kNotAvailable = -(1 << 23);
  NumberedMessage faulty = good_message();
  faulty.message.health.sensor_fault = true;
  NumberedMessage tilted = good_message();
  tilted.message.up.reset();
  NumberedMessage fast = good_message();
  fast.message.axes[2].corrected = core::deg_per_s(839.0F);
  for (const NumberedMessage& message : {faulty, tilted, fast}) {
    EXPECT_EQ(yaw_count(encode_can_yaw(message, 0x100, kNibble)), kNotAvailable);
    EXPECT_FALSE(is_valid(encode_can_yaw(message, 0x100, kNibble)));
  }
  EXPECT_EQ(encode_can_yaw(tilted, 0x100, kNibble).data[5] >> 4, 15);
}

TEST(CanYawFrame, TakesTheDeviationAlongTheVertical) {
  NumberedMessage sent = good_message();
  sent.message.axes[0].sigma = core::deg_per_s(std::numeric_limits<float>::infinity());
  EXPECT_EQ(encode_can_yaw(sent, 0x100, kNibble).data[5] >> 4, 4);  // x lies level
  sent.message.up = core::Direction{0.6F, 0.0F, 0.8F};
  EXPECT_EQ(encode_can_yaw(sent, 0x100, kNibble).data[5] >> 4, 15);
}

}  // namespace
}  // namespace zerorate::wire
