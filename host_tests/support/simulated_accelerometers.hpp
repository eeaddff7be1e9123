/// @file
/// The simulated gyros whose driver reads the accelerometer, too.
#pragma once

#include <array>
#include <cstddef>

#include "drivers/chips/chips.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::support {

/// A chip whose driver reads its accelerometer, too.
template <class Chip, class Line>
struct WithAcceleration : Chip {
  using Plain = Chip;
  static constexpr bool kCanLoseAcceleration = true;
  /// Whether the frames show which sample an acceleration belongs to.
  static constexpr bool kAccelerationIsMarked = true;
  template <class Bus>
  using Driver = typename Line::template DriverWithAcceleration<Bus>;
  /// Range that the driver takes unless another one is asked for.
  static constexpr float kRangeG = static_cast<float>(Line::kUsualAccelerationRange_g);
};

/// Half the FIFO: a sample takes two words.
struct Lsm6dsoWithAcceleration : WithAcceleration<Lsm6dso, drivers::lsm6dso::Chip> {
  static constexpr const char* kName = "Lsm6dsoWithAcceleration";
  static constexpr float kLsbG = 0.122e-3F;
  static constexpr std::size_t kFifoCapacity = 256;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x12, 0xFF}, ConfiguredBits{0x15, 0x10}, ConfiguredBits{0x17, 0x06},
      ConfiguredBits{0x18, 0x02}, ConfiguredBits{0x13, 0x42}, ConfiguredBits{0x16, 0xC0},
      ConfiguredBits{0x10, 0xFE}, ConfiguredBits{0x0D, 0xFF}, ConfiguredBits{0x07, 0xFF},
      ConfiguredBits{0x08, 0xD1}, ConfiguredBits{0x09, 0xFF}, ConfiguredBits{0x0A, 0xF7},
      ConfiguredBits{0x11, 0xFF}};
};
struct Lsm6dsv16xWithAcceleration : WithAcceleration<Lsm6dsv16x, drivers::lsm6dso::Lsm6dsv16x> {
  static constexpr const char* kName = "Lsm6dsv16xWithAcceleration";
  static constexpr float kLsbG = 0.122e-3F;
  static constexpr std::size_t kFifoCapacity = 128;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x12, 0xFF}, ConfiguredBits{0x17, 0x0B}, ConfiguredBits{0x18, 0x18},
      ConfiguredBits{0x15, 0x7F}, ConfiguredBits{0x13, 0x0A}, ConfiguredBits{0x16, 0x81},
      ConfiguredBits{0x10, 0x7F}, ConfiguredBits{0x0D, 0xFF}, ConfiguredBits{0x07, 0xFF},
      ConfiguredBits{0x08, 0xD1}, ConfiguredBits{0x09, 0xFF}, ConfiguredBits{0x0A, 0xF7},
      ConfiguredBits{0x11, 0x7F}};
};

struct Icm42688WithAcceleration : WithAcceleration<Icm42688, drivers::icm42688::Chip> {
  static constexpr const char* kName = "Icm42688WithAcceleration";
  static constexpr float kLsbG = 4.0F / 32768.0F;
  static constexpr std::size_t kFifoCapacity = 128;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x76, 0x07}, ConfiguredBits{0x50, 0xEF}, ConfiguredBits{0x4C, 0xF0},
      ConfiguredBits{0x4D, 0xC0}, ConfiguredBits{0x14, 0x07}, ConfiguredBits{0x64, 0x10},
      ConfiguredBits{0x65, 0x7F}, ConfiguredBits{0x52, 0xFF}, ConfiguredBits{0x5F, 0x7F},
      ConfiguredBits{0x60, 0xFF}, ConfiguredBits{0x61, 0x0F}, ConfiguredBits{0x16, 0xC0},
      ConfiguredBits{0x4F, 0xEF}, ConfiguredBits{0x4E, 0x3F}};
};

struct Icm45686WithAcceleration : WithAcceleration<Icm45686, drivers::icm45686::Chip> {
  static constexpr const char* kName = "Icm45686WithAcceleration";
  static constexpr float kLsbG = 4.0F / 32768.0F;
  static constexpr std::size_t kFifoCapacity = 128;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x32, 0x0E}, ConfiguredBits{0x1B, 0x7F}, ConfiguredBits{0x18, 0x07},
      ConfiguredBits{0x16, 0xFF}, ConfiguredBits{0x20, 0x08}, ConfiguredBits{0x1E, 0xFF},
      ConfiguredBits{0x1F, 0xFF}, ConfiguredBits{0x22, 0x07}, ConfiguredBits{0x1C, 0xFF},
      ConfiguredBits{0x80, 0x02}, ConfiguredBits{0x10, 0x0F}, ConfiguredBits{0x81, 0x07},
      ConfiguredBits{0x82, 0x07}, ConfiguredBits{0x83, 0x09}, ConfiguredBits{0x1D, 0xFF},
      ConfiguredBits{0x21, 0x3F}};
};

/// Rates and accelerations are in one frame: neither can be lost alone.
struct Mpu6500WithAcceleration : WithAcceleration<Mpu6500, drivers::mpu6500::Chip> {
  static constexpr const char* kName = "Mpu6500WithAcceleration";
  static constexpr float kLsbG = 4.0F / 32768.0F;
  static constexpr bool kCanLoseAcceleration = false;
  static constexpr std::size_t kFifoCapacity = 42;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x6B, 0xFF}, ConfiguredBits{0x1C, 0xFF}, ConfiguredBits{0x1D, 0x0F},
      ConfiguredBits{0x6C, 0x3F}, ConfiguredBits{0x1A, 0x7F}, ConfiguredBits{0x19, 0xFF},
      ConfiguredBits{0x1B, 0xFB}, ConfiguredBits{0x37, 0xFE}, ConfiguredBits{0x38, 0x79},
      ConfiguredBits{0x23, 0xFF}, ConfiguredBits{0x6A, 0xF0}};
};
struct Icm20602WithAcceleration : WithAcceleration<Icm20602, drivers::mpu6500::Icm20602> {
  static constexpr const char* kName = "Icm20602WithAcceleration";
  static constexpr float kLsbG = 4.0F / 32768.0F;
  static constexpr bool kCanLoseAcceleration = false;
  static constexpr std::size_t kFifoCapacity = 72;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x6B, 0xFF}, ConfiguredBits{0x1C, 0xFF}, ConfiguredBits{0x1D, 0x0F},
      ConfiguredBits{0x70, 0x40}, ConfiguredBits{0x6C, 0x3F}, ConfiguredBits{0x1A, 0x7F},
      ConfiguredBits{0x19, 0xFF}, ConfiguredBits{0x1B, 0xFB}, ConfiguredBits{0x37, 0xFE},
      ConfiguredBits{0x38, 0x79}, ConfiguredBits{0x23, 0xFF}, ConfiguredBits{0x6A, 0xF0}};
};
struct Mpu6050WithAcceleration : WithAcceleration<Mpu6050, drivers::mpu6500::Chip> {
  static constexpr const char* kName = "Mpu6050WithAcceleration";
  static constexpr float kLsbG = 4.0F / 32768.0F;
  static constexpr bool kCanLoseAcceleration = false;
  static constexpr std::size_t kFifoCapacity = 85;
  static constexpr std::array kConfigured{ConfiguredBits{0x6B, 0xFF}, ConfiguredBits{0x1C, 0xFF},
                                          ConfiguredBits{0x6C, 0x3F}, ConfiguredBits{0x1A, 0x7F},
                                          ConfiguredBits{0x19, 0xFF}, ConfiguredBits{0x1B, 0xFB},
                                          ConfiguredBits{0x37, 0xFE}, ConfiguredBits{0x38, 0x79},
                                          ConfiguredBits{0x23, 0xFF}, ConfiguredBits{0x6A, 0xF0}};
};

struct Bmi160WithAcceleration : WithAcceleration<Bmi160, drivers::bmi160::Chip> {
  static constexpr const char* kName = "Bmi160WithAcceleration";
  static constexpr float kLsbG = 4.0F / 32768.0F;
  static constexpr bool kCanLoseAcceleration = false;
  static constexpr std::size_t kFifoCapacity = 85;
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(100);
  static constexpr std::array kConfigured{
      ConfiguredBits{0x45, 0xFF}, ConfiguredBits{0x40, 0xFF}, ConfiguredBits{0x41, 0x0F},
      ConfiguredBits{0x42, 0x3F}, ConfiguredBits{0x43, 0x07}, ConfiguredBits{0x46, 0xFF},
      ConfiguredBits{0x51, 0x7F}, ConfiguredBits{0x53, 0x0F}, ConfiguredBits{0x54, 0x1F},
      ConfiguredBits{0x56, 0xF0}, ConfiguredBits{0x47, 0xFE}};
};

struct Bmi270WithAcceleration : WithAcceleration<Bmi270, drivers::bmi270::Chip> {
  static constexpr const char* kName = "Bmi270WithAcceleration";
  static constexpr float kLsbG = 4.0F / 32768.0F;
  static constexpr bool kCanLoseAcceleration = false;
  static constexpr std::size_t kFifoCapacity = 170;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x7C, 0x07}, ConfiguredBits{0x40, 0xFF}, ConfiguredBits{0x41, 0x03},
      ConfiguredBits{0x45, 0xFF}, ConfiguredBits{0x42, 0xFF}, ConfiguredBits{0x43, 0x0F},
      ConfiguredBits{0x46, 0xFF}, ConfiguredBits{0x47, 0x1F}, ConfiguredBits{0x48, 0x03},
      ConfiguredBits{0x53, 0x1E}, ConfiguredBits{0x55, 0x01}, ConfiguredBits{0x58, 0x0F},
      ConfiguredBits{0x49, 0xF0}, ConfiguredBits{0x7D, 0x0F}};
};

struct Icm20948WithAcceleration : WithAcceleration<Icm20948, drivers::icm20948::Chip> {
  static constexpr const char* kName = "Icm20948WithAcceleration";
  static constexpr float kLsbG = 4.0F / 32768.0F;
  static constexpr bool kCanLoseAcceleration = false;
  static constexpr std::size_t kFifoCapacity = 42;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x06, 0xFF}, ConfiguredBits{0x89, 0x01}, ConfiguredBits{0x90, 0x0F},
      ConfiguredBits{0x91, 0xFF}, ConfiguredBits{0x94, 0x3F}, ConfiguredBits{0x05, 0x30},
      ConfiguredBits{0x07, 0x3F}, ConfiguredBits{0x80, 0xFF}, ConfiguredBits{0x81, 0x3F},
      ConfiguredBits{0x82, 0x38}, ConfiguredBits{0x0F, 0xFE}, ConfiguredBits{0x10, 0x8F},
      ConfiguredBits{0x11, 0x01}, ConfiguredBits{0x12, 0x1F}, ConfiguredBits{0x13, 0x1F},
      ConfiguredBits{0x66, 0x0F}, ConfiguredBits{0x69, 0x1F}, ConfiguredBits{0x67, 0x1F},
      ConfiguredBits{0x03, 0xF0}};
};

/// Each burst has rates and forces.
template <class Plain, class Line>
struct AdisWithAcceleration : WithAcceleration<Plain, Line> {
  static constexpr bool kCanLoseAcceleration = false;
  static constexpr float kLsbG = static_cast<float>(Line::kUsualAccelerationRange_g) / 32000.0F;
};
struct Adis16470WithAcceleration : AdisWithAcceleration<Adis16470, drivers::adis16475::Chip> {
  static constexpr const char* kName = "Adis16470WithAcceleration";
};
struct Adis16475Part2WithAcceleration
    : AdisWithAcceleration<Adis16475Part2, drivers::adis16475::Adis16475Part2> {
  static constexpr const char* kName = "Adis16475Part2WithAcceleration";
};

/// Two dies on one I2C bus. The gyro's samples come 55 ms later: the accelerometer needs so long.
struct Bmi088WithAcceleration : WithAcceleration<Bmi088, drivers::bmi088::Chip> {
  static constexpr const char* kName = "Bmi088WithAcceleration";
  using Simulated = hal::sim::SimulatedBmi088Module;
  static constexpr hal::I2cAddress kAccelerometerAddress{0x18};
  static constexpr bool kAccelerationIsMarked = false;
  static constexpr float kLsbG = 6.0F / 32768.0F;
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(85);
  static constexpr std::array kConfigured{
      ConfiguredBits{0x1E, 0x88}, ConfiguredBits{0x11, 0xA0}, ConfiguredBits{0x0F, 0x07},
      ConfiguredBits{0x10, 0x0F}, ConfiguredBits{0x16, 0x03}, ConfiguredBits{0x18, 0xA5},
      ConfiguredBits{0x15, 0xC0}, ConfiguredBits{0x3D, 0xFF}, ConfiguredBits{0x3E, 0xC0},
      ConfiguredBits{0x40, 0xFF}, ConfiguredBits{0x41, 0x03}, ConfiguredBits{0x48, 0x01},
      ConfiguredBits{0x49, 0x4C}, ConfiguredBits{0x7C, 0xFF}, ConfiguredBits{0x7D, 0xFF}};
};

/// How the two dies are attached.
template <class G>
struct OverI2cTwice {
  using Gyro = G;
  using Bus = hal::sim::SimulatedBmi088I2c;
  using Registers = drivers::I2cRegisters<hal::testing::FaultInjector<Bus>>;
  using Link = drivers::bmi088::Buses<Registers, Registers>;
  using Driver = typename G::template Driver<Link>;
  static Bus attach(typename G::Simulated& chip) {
    return {chip, G::kAddress, G::kAccelerometerAddress};
  }
  static Link link(hal::testing::FaultInjector<Bus>& bus) {
    return {Registers{bus, G::kAddress}, Registers{bus, G::kAccelerometerAddress}};
  }
};

/// Their wirings, but for those of chips without a FIFO.
using WiringsWithAcceleration =
    core::TypeList<OverSpi<Lsm6dsoWithAcceleration>, OverI2c<Lsm6dsoWithAcceleration>,
                   OverSpi<Lsm6dsv16xWithAcceleration>, OverSpi<Icm42688WithAcceleration>,
                   OverI2c<Icm42688WithAcceleration>, OverSpi<Mpu6500WithAcceleration>,
                   OverI2c<Mpu6050WithAcceleration>, OverSpi<Icm20602WithAcceleration>,
                   OverSpi<Bmi160WithAcceleration>, OverSpi<Icm20948WithAcceleration>,
                   OverSpi<Bmi270WithAcceleration>, OverI2c<Bmi270WithAcceleration>,
                   OverSpi<Icm45686WithAcceleration>, OverI2c<Icm45686WithAcceleration>,
                   OverI2cTwice<Bmi088WithAcceleration>>;
using WiringsWithAccelerationAlone =
    core::TypeList<OverSpi<Adis16470WithAcceleration>, OverSpi<Adis16475Part2WithAcceleration>>;

}  // namespace zerorate::support
