/// @file
/// A small node, its samples, and the comparison of two node states.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "firmware/app/gyro_node.hpp"
#include "host_tests/support/sample_modes.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::app::testing {

inline constexpr core::ModelShape kNodeShape{.decaying = 4};
using Node = GyroNode<kNodeShape>;

inline constexpr core::Duration kSamplePeriod = core::Duration::milliseconds(10);
inline constexpr core::Duration kTick = core::Duration::milliseconds(100);
inline constexpr float kWhiteSigmaRadS = 1e-3F;

[[nodiscard]] inline core::Instant at_ms(std::int64_t ms) {
  return core::Instant::from_ns(ms * 1'000'000);
}

/// Flicker far below the white noise of a sample; 100 Hz into 10 Hz.
[[nodiscard]] inline Node::Params node_params() {
  auto flicker = zerorate::testing::flicker_like<4>(kTick, 0.5);
  for (float& variance : flicker.variance_rad2_s2) variance *= 1e-9F;
  return {.model = {.modes = core::compose(kTick, core::Start::stationary, flicker),
                    .white_variance_rad2_s2 = kWhiteSigmaRadS * kWhiteSigmaRadS,
                    .sample_period = kSamplePeriod}};
}

[[nodiscard]] inline core::GyroSample sample_at(core::Instant time, float rate_rad_s) {
  core::GyroSample sample{.time = time};
  for (std::size_t i = 0; i < 3; ++i) {
    sample.rate[i] = core::rad_per_s(rate_rad_s * static_cast<float>(i + 1));
  }
  return sample;
}

/// White noise around a bias that is 1, 2 and 3 times `bias` on x, y and z.
[[nodiscard]] inline core::GyroSample noisy_sample(core::Instant time, float bias_rad_s,
                                                   std::uint64_t seed = 1) {
  core::GyroSample sample = sample_at(time, bias_rad_s);
  for (std::size_t i = 0; i < 3; ++i) {
    const random::RandomStream noise{seed, i};
    sample.rate[i] = sample.rate[i] +
                     core::rad_per_s(kWhiteSigmaRadS * static_cast<float>(noise.normal(time.ns())));
  }
  return sample;
}

inline constexpr float kBias = 0.01F;

[[nodiscard]] inline float bias_of(const Node& node, Predictor which, std::size_t axis = 0) {
  return node.bias(which, axis).in(core::rad_per_s);
}

/// Noisy samples every 10 ms in [from, to); returns the messages.
inline std::vector<RateMessage> stand(Node& node, std::int64_t from_ms, std::int64_t to_ms,
                                      float bias = kBias) {
  std::vector<RateMessage> messages;
  for (std::int64_t ms = from_ms; ms < to_ms; ms += 10) {
    messages.push_back(node.step(noisy_sample(at_ms(ms), bias)));
  }
  return messages;
}

/// Drives with a turn of `turn` rad/s on top and a pulse with each sample.
inline std::vector<RateMessage> drive(Node& node, std::int64_t from_ms, std::int64_t to_ms,
                                      float turn = 0.3F) {
  std::vector<RateMessage> messages;
  for (std::int64_t ms = from_ms; ms < to_ms; ms += 10) {
    node.pulse(at_ms(ms));
    messages.push_back(node.step(noisy_sample(at_ms(ms), kBias + turn)));
  }
  return messages;
}

/// Every field, bit for bit; not memcmp, because padding has no value.
template <class State>
void expect_same(const State& a, const State& b) {
  EXPECT_TRUE(a == b);  // EXPECT_EQ would print kilobytes
}
inline void expect_same(const Node::State& a, const Node::State& b) {
  EXPECT_TRUE(a.learning == b.learning);
  EXPECT_TRUE(a.ticks.predictors == b.ticks.predictors);
  EXPECT_TRUE(a == b);
}

/// State of a node but for the turn that it has summed.
[[nodiscard]] inline Node::State learnt(Node::State state) {
  state.turn = {};
  return state;
}

}  // namespace zerorate::app::testing
