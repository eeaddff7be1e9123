/// @file
/// The CAN frames, read as another tool would read them: by the published DBC file.

#include "firmware/wire/can_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "host_tests/unit/firmware/wire/messages.hpp"

namespace zerorate::wire {
namespace {

struct Signal {
  unsigned start;
  unsigned length;
  bool is_signed;
  double factor;
};
/// Message identifier to signal name to signal; little-endian signals only.
using Dbc = std::map<unsigned, std::map<std::string, Signal>>;

Dbc read_dbc() {
  std::ifstream file{ZERORATE_REPOSITORY "/firmware/wire/zerorate.dbc"};
  static const std::regex message{R"(BO_ (\d+) \w+: 8 \w+)"};
  static const std::regex signal{
      R"( SG_ (\w+) : (\d+)\|(\d+)@1([+-]) \(([0-9.E+-]+),0\) \[[^\]]*\] "[^"]*" \w+)"};
  Dbc dbc;
  unsigned id = 0;
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (std::regex_match(line, match, message)) {
      id = static_cast<unsigned>(std::stoul(match[1]));
    } else if (std::regex_match(line, match, signal)) {
      dbc[id][match[1]] = {.start = static_cast<unsigned>(std::stoul(match[2])),
                           .length = static_cast<unsigned>(std::stoul(match[3])),
                           .is_signed = match[4] == "-",
                           .factor = std::stod(match[5])};
    } else {
      EXPECT_FALSE(line.starts_with(" SG_") || line.starts_with("BO_")) << line;
    }
  }
  return dbc;
}

std::int64_t raw_value(const CanFrame& frame, const Signal& signal) {
  std::uint64_t bits = 0;
  for (unsigned i = 0; i < signal.length; ++i) {
    const unsigned at = signal.start + i;
    const unsigned byte = frame.data.at(at / 8);
    bits |= std::uint64_t{(byte >> at % 8) & 1U} << i;
  }
  const bool is_negative = signal.is_signed && ((bits >> (signal.length - 1)) & 1U) != 0;
  return static_cast<std::int64_t>(bits) -
         (is_negative ? std::int64_t{1} << signal.length : std::int64_t{0});
}

/// A message as the DBC file lets one see it.
class Reading {
 public:
  explicit Reading(const NumberedMessage& message) {
    const auto frames = encode_can_frames(message, kDefaultCanId);
    frames_.assign(frames.begin(), frames.end());
    frames_.push_back(encode_can_inputs(message, kDefaultCanId));
    const auto turns = encode_can_turn(message, kDefaultCanId);
    frames_.insert(frames_.end(), turns.begin(), turns.end());
    if (message.message.up) {
      frames_.push_back(encode_can_vertical(message, kDefaultCanId));
      frames_.push_back(encode_can_up(message, kDefaultCanId));
      frames_.push_back(encode_can_vertical_turn(message, kDefaultCanId));
    }
    frames_.push_back(encode_can_acceleration(message, kDefaultCanId));
    if (message.message.explained) {
      const auto explained = encode_can_explained(message, kDefaultCanId);
      frames_.insert(frames_.end(), explained.begin(), explained.end());
    }
  }

  std::int64_t raw(const std::string& name) const {
    for (const CanFrame& frame : frames_) {
      const auto& signals = dbc_.at(frame.id);
      if (const auto found = signals.find(name); found != signals.end()) {
        return raw_value(frame, found->second);
      }
    }
    ADD_FAILURE() << "no signal " << name;
    return 0;
  }
  double value(const std::string& name) const {
    for (const auto& [id, signals] : dbc_) {
      if (const auto found = signals.find(name); found != signals.end()) {
        return static_cast<double>(raw(name)) * found->second.factor;
      }
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

 private:
  Dbc dbc_ = read_dbc();
  std::vector<CanFrame> frames_;
};

constexpr double kDegPerRad = 57.29577951308232;

TEST(DbcFile, LetsNoTwoSignalsShareABit) {
  const Dbc dbc = read_dbc();
  ASSERT_EQ(dbc.size(), kCanFrames + 1 + kCanTurnFrames + 4 + kCanExplainedFrames);
  for (const auto& [id, signals] : dbc) {
    std::set<unsigned> bits;
    for (const auto& [name, signal] : signals) {
      for (unsigned i = 0; i < signal.length; ++i) {
        EXPECT_LT(signal.start + i, 64U);
        EXPECT_TRUE(bits.insert(signal.start + i).second) << name;
      }
    }
  }
}

TEST(CanFramesOfAnyMessage, HoldItsRatesAsTheDbcFileSays) {
  std::mt19937_64 random{4};
  for (int i = 0; i < 50; ++i) {
    NumberedMessage sent = testing::random_message(random);
    sent.message.health.sample_refused = sent.message.health.time_refused = false;
    sent.message.health.sensor_fault = false;
    const Reading reading{sent};
    const std::array names{"X", "Y", "Z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const app::AxisRate& rate = sent.message.axes[axis];
      const auto dps = [](core::AngularRate r) {
        return double{r.in(core::rad_per_s)} * kDegPerRad;
      };
      // Half an LSB, and the four roundings of single precision on the way.
      const auto tolerance = [](double value, double lsb) {
        return 0.5 * lsb + 4.0 * 6e-8 * std::abs(value);
      };
      const std::string name = names[axis];
      EXPECT_NEAR(reading.value("Rate" + name), dps(rate.corrected),
                  tolerance(dps(rate.corrected), 1e-6));
      if (std::abs(dps(rate.bias)) > 134.2177) {  // 28 bits
        EXPECT_EQ(reading.raw("Bias" + name), -(1LL << 27));
      } else {
        EXPECT_NEAR(reading.value("Bias" + name), dps(rate.bias), tolerance(dps(rate.bias), 1e-6));
      }
      EXPECT_NEAR(reading.value("Sigma" + name), dps(rate.sigma), tolerance(dps(rate.sigma), 1e-5));
    }
  }
}

TEST(CanStatusFrame, HoldsMotionCounterAndEachHealthFlag) {
  std::mt19937_64 random{5};
  for (int i = 0; i < 200; ++i) {
    const NumberedMessage sent = testing::random_message(random);
    const app::Health& health = sent.message.health;
    const Reading reading{sent};
    EXPECT_EQ(reading.raw("Motion"), static_cast<int>(sent.message.motion));
    EXPECT_EQ(reading.raw("Counter"), sent.sequence % 16);
    EXPECT_EQ(reading.raw("Calibrated") == 1, health.calibrated);
    EXPECT_EQ(reading.raw("SampleRefused") == 1, health.sample_refused);
    EXPECT_EQ(reading.raw("TimeRefused") == 1, health.time_refused);
    EXPECT_EQ(reading.raw("Saturated") == 1, health.saturated);
    EXPECT_EQ(reading.raw("ModelInconsistent") == 1, health.model_inconsistent);
    EXPECT_EQ(reading.raw("OdometerFault") == 1, health.odometer_fault);
    EXPECT_EQ(reading.raw("SensorFault") == 1, health.sensor_fault);
    EXPECT_EQ(reading.raw("MeasurementRejected") == 1, health.measurement_rejected);
    EXPECT_EQ(reading.raw("TemperatureMissing") == 1, health.temperature_missing);
    EXPECT_EQ(reading.raw("OdometerDisagreement") == 1, health.odometer_disagreement);
  }
}

/// Verifies SR-IF-14.
TEST(CanFrames, CountEachOfThemModulo16) {
  std::mt19937_64 random{10};
  NumberedMessage sent = testing::random_message(random);
  sent.message.up = core::UpAxis{}.direction();
  sent.message.explained.emplace();
  for (std::uint32_t number = 0; number < 1000; ++number) {
    sent.sequence = number;
    const auto counter_of = [](const CanFrame& frame) { return frame.data[7] >> 4; };
    for (const CanFrame& frame : encode_can_frames(sent, kDefaultCanId)) {
      const bool is_status = frame.id == kDefaultCanId;
      EXPECT_EQ(is_status ? (frame.data[0] >> 2) & 15 : counter_of(frame), number % 16);
    }
    for (const CanFrame& frame : encode_can_turn(sent, kDefaultCanId)) {
      EXPECT_EQ(counter_of(frame), number / 4 % 16);
    }
    for (const CanFrame& frame : encode_can_explained(sent, kDefaultCanId)) {
      EXPECT_EQ(counter_of(frame), number / 16 % 16);
    }
    EXPECT_EQ(counter_of(encode_can_up(sent, kDefaultCanId)), number / 4 % 16);
    EXPECT_EQ(counter_of(encode_can_vertical(sent, kDefaultCanId)), number / 4 % 16);
    EXPECT_EQ(counter_of(encode_can_vertical_turn(sent, kDefaultCanId)), number / 4 % 16);
    EXPECT_EQ(counter_of(encode_can_acceleration(sent, kDefaultCanId)), number / 4 % 16);
    EXPECT_EQ(counter_of(encode_can_inputs(sent, kDefaultCanId)), number / 16 % 16);
  }
}

TEST(CanInputsFrame, HoldsTemperatureOdometerAndCalm) {
  std::mt19937_64 random{6};
  for (int i = 0; i < 200; ++i) {
    const app::RateMessage sent = testing::random_message(random).message;
    const Reading reading{{.sequence = 0, .message = sent}};
    if (sent.temperature) {
      EXPECT_NEAR(reading.value("Temperature"), sent.temperature->degc(), 0.0051);
    } else {
      EXPECT_EQ(reading.raw("Temperature"), -32768);
    }
    EXPECT_EQ(reading.raw("HasOdometer") == 1, sent.odometer_pulses.has_value());
    EXPECT_EQ(reading.raw("OdometerPulses"), sent.odometer_pulses.value_or(0));
    EXPECT_EQ(reading.raw("OdometerDeadBand") == 1, sent.health.odometer_dead_band);
    EXPECT_EQ(reading.raw("SampleRateOff") == 1, sent.health.sample_rate_off);
    EXPECT_EQ(reading.raw("ReferenceDisagreement") == 1, sent.health.reference_disagreement);
    EXPECT_EQ(reading.raw("AccelerationMissing") == 1, sent.health.acceleration_missing);
    EXPECT_EQ(reading.raw("CalmPercent"), sent.calm_percent > 100 ? 127 : sent.calm_percent);
  }
}

TEST(CanVerticalFrame, HoldsRateAndHeading) {
  std::mt19937_64 random{8};
  for (int i = 0; i < 200; ++i) {
    app::RateMessage sent = testing::random_message(random).message;
    sent.health = {};
    sent.up = core::Direction{0.6F, i % 2 == 0 ? 0.48F : -0.48F, 0.64F};
    for (app::AxisRate& axis : sent.axes) axis.corrected = axis.corrected * 0.5F;
    const Reading reading{{.sequence = 0, .message = sent}};
    double rate = 0.0;
    double size = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double share = double{sent.up->at(axis)} *
                           double{sent.axes.at(axis).corrected.in(core::rad_per_s)} * kDegPerRad;
      rate += share;
      size += std::abs(share);
    }
    if (std::abs(rate) > 1342.0) {  // 28 bits of 1e-5 deg/s
      EXPECT_EQ(reading.raw("RateVertical"), -(1LL << 27));
    } else {
      // Half an LSB, and the eight roundings of single precision on the way.
      EXPECT_NEAR(reading.value("RateVertical"), rate, 0.5e-5 + 8.0 * 6e-8 * size);
    }
    EXPECT_NEAR(reading.value("Heading"), kDegPerRad * double{sent.heading.angle.in(core::rad)},
                0.0051);
    EXPECT_NEAR(reading.value("HeadingSigma"),
                kDegPerRad * double{sent.heading.sigma.in(core::rad)}, 0.00051);
  }
}

TEST(CanVerticalFrame, HasNoHeadingBeforeAReference) {
  app::RateMessage message;
  message.up = core::UpAxis{}.direction();
  const Reading reading{{.sequence = 0, .message = message}};
  EXPECT_EQ(reading.raw("Heading"), -32768);
  EXPECT_EQ(reading.raw("HeadingSigma"), 65535);
}

TEST(CanFramesOfAnAccelerometer, HoldForcesVibrationAndShares) {
  std::mt19937_64 random{9};
  for (int i = 0; i < 200; ++i) {
    const app::RateMessage sent = testing::random_message(random).message;
    const Reading reading{{.sequence = 0, .message = sent}};
    const std::array names{"X", "Y", "Z"};
    if (sent.up) {
      EXPECT_NEAR(reading.value("TurnVertical"), sent.vertical_turn.angle.in(core::deg), 0.7e-3);
      EXPECT_NEAR(reading.value("TurnSigmaVertical"), sent.vertical_turn.sigma.in(core::deg),
                  0.501e-3);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name = names[axis];
      if (sent.up) {
        EXPECT_NEAR(reading.value("Up" + name), sent.up->at(axis), 0.501e-4);
      }
      if (sent.acceleration) {
        EXPECT_NEAR(reading.value("Acceleration" + name),
                    sent.acceleration->at(axis).in(core::m_per_s2), 0.501e-2);
      } else {
        EXPECT_EQ(reading.raw("Acceleration" + name), -16384);
      }
      if (!sent.explained) continue;
      const auto expect_share = [&](const std::string& signal, core::AngularRate share) {
        const double dps = double{share.in(core::rad_per_s)} * kDegPerRad;
        EXPECT_NEAR(reading.value(signal + name), dps, 0.501e-4) << signal << name;
      };
      expect_share("ByTemperature", sent.explained->at(axis).temperature);
      expect_share("ByAcceleration", sent.explained->at(axis).acceleration);
      expect_share("ByVibration", sent.explained->at(axis).vibration);
    }
    if (!sent.vibration || sent.vibration->in(core::m_per_s2) > 32.766F) {
      EXPECT_EQ(reading.raw("Vibration"), 32767);
    } else {
      EXPECT_NEAR(reading.value("Vibration"), sent.vibration->in(core::m_per_s2), 0.501e-3);
    }
  }
}

TEST(CanTurnFrames, HoldTheAngleItsErrorAndItsTime) {
  std::mt19937_64 random{7};
  for (int i = 0; i < 200; ++i) {
    NumberedMessage sent = testing::random_message(random);
    for (app::AxisTurn& turn : sent.message.turn) turn.sigma = turn.sigma * 0.01F;
    sent.message.turn_time = core::Duration::milliseconds(std::int64_t{1500} * i);
    const Reading reading{sent};
    const std::array names{"X", "Y", "Z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name = names[axis];
      const app::AxisTurn& turn = sent.message.turn[axis];
      const double angle = double{turn.angle.in(core::rad)} * kDegPerRad;
      EXPECT_NEAR(reading.value("Turn" + name), angle, 0.5e-3 + 4.0 * 6e-8 * std::abs(angle));
      EXPECT_NEAR(reading.value("TurnSigma" + name), double{turn.sigma.in(core::rad)} * kDegPerRad,
                  0.51e-3);
      EXPECT_EQ(reading.raw("TurnTime" + name), i * 3 / 2);
    }
  }
}

/// Verifies SR-IF-13.
TEST(CanTurnWithoutADeparture, IsNotAvailable) {
  EXPECT_EQ(Reading{{}}.raw("TurnSigmaZ"), 65535);
}

TEST(CanTemperatureThatDoesNotFit, IsNotAvailable) {
  NumberedMessage sent;
  sent.message.temperature = core::Temperature::from_degc(400.0F);
  EXPECT_EQ(Reading{sent}.raw("Temperature"), -32768);
}

/// Verifies SR-IF-13.
TEST(CanFramesWithoutARate, SaySo) {
  NumberedMessage sent;
  sent.message.health.sensor_fault = true;
  for (auto& axis : sent.message.axes) {
    axis.sigma = core::rad_per_s(std::numeric_limits<float>::infinity());
  }
  const Reading reading{sent};
  for (const char* axis : {"X", "Y", "Z"}) {
    EXPECT_EQ(reading.raw(std::string("Rate") + axis), -2147483648LL);
    EXPECT_EQ(reading.raw(std::string("Sigma") + axis), 65535);
    EXPECT_EQ(reading.raw(std::string("Bias") + axis), 0);
  }
}

/// Verifies SR-IF-13.
TEST(CanSignalsOfWhatDoesNotFit, AreNotAvailableInsteadOfClamped) {
  NumberedMessage sent;
  sent.message.axes[0].corrected = core::deg_per_s(2200.0F);
  sent.message.axes[1].corrected = core::deg_per_s(-2200.0F);
  sent.message.axes[2].corrected = core::rad_per_s(std::numeric_limits<float>::quiet_NaN());
  sent.message.axes[0].sigma = core::deg_per_s(0.7F);
  const Reading reading{sent};
  EXPECT_EQ(reading.raw("RateX"), -2147483648LL);
  EXPECT_EQ(reading.raw("RateY"), -2147483648LL);
  EXPECT_EQ(reading.raw("RateZ"), -2147483648LL);
  EXPECT_EQ(reading.raw("SigmaX"), 65535);
}

}  // namespace
}  // namespace zerorate::wire
