// Records of what a node has learnt: anything that is not one is refused and touches nothing; one
// that was made by another program, with contents of its own and the right checksum, is refused or
// leads to figures that are numbers, none of them negative that may not be.

#include <array>
#include <cmath>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/app/snapshot.hpp"
#include "host_tests/fuzz/fuzz.hpp"
#include "host_tests/support/checksum.hpp"
#include "host_tests/support/sample_modes.hpp"

namespace {

using namespace zerorate;
constexpr core::ModelShape kKnown{.decaying = 4};
constexpr core::ModelShape kLearning = core::with_hypotheses(kKnown, 12);

constexpr core::Duration kTick = core::Duration::milliseconds(100);
constexpr std::uint32_t kSensor = 7;

/// Three orders by four strengths of the slow noise.
template <core::ModelShape Shape>
core::HypothesesOf<Shape> hypotheses() {
  core::HypothesesOf<Shape> hypotheses{};
  if constexpr (Shape.hypotheses > 1) {
    hypotheses.count = Shape.hypotheses;
    hypotheses.kept = 0.999F;
    for (std::size_t m = 0; m < Shape.hypotheses; ++m) {
      auto& one = hypotheses.all[m];
      one.level = std::pow(25.0F, static_cast<float>(m % 4U) - 1.5F);
      for (std::size_t i = 0; i < Shape.decaying; ++i) {
        one.strength[i] = one.level * std::pow(1.7F, static_cast<float>(i * (m / 4U)));
      }
    }
  }
  return hypotheses;
}

template <core::ModelShape Shape>
const app::NodeParams<Shape>& params() {
  static const app::NodeParams<Shape> params{
      .model = {.modes = core::compose(kTick, core::Start::stationary,
                                       zerorate::testing::flicker_like<4>(kTick, 0.5)),
                .white_variance_rad2_s2 = 1e-6F,
                .turn_on_variance_rad2_s2 = 1e-8F,
                .sample_period = core::Duration::milliseconds(10),
                .hypotheses = hypotheses<Shape>()}};
  return params;
}

/// A node after ten seconds of standstill.
template <class Node>
struct Learnt {
  explicit Learnt(const typename Node::Params& params) : node(params) {
    for (std::int64_t ms = 0; ms < 10'000; ms += 10) {
      const auto noise = static_cast<float>(ms / 10 * 7 % 13 - 6) * 1e-4F;
      (void)node.step({.time = core::Instant::from_ns(ms * 1'000'000),
                       .rate = {core::rad_per_s(noise), core::rad_per_s(-noise), {}}});
    }
    node.finish_learning();  // a record changes nothing then
  }
  Node node;
};

template <core::ModelShape Shape, class Record>
void restore(const Record& record, const app::SnapshotTime& now) {
  app::GyroNode<Shape> node{params<Shape>()};
  const app::Snapshot<app::GyroNode<Shape>> snapshot{params<Shape>(), kSensor};
  const auto resumed = snapshot.restore(node, record, now);
  const core::Prediction predicted = node.predict(app::Predictor::kalman, 0);
  fuzz::promise(resumed.has_value() || !predicted.is_available(),
                "a node knows something only after a record that it took up");
  if (!predicted.is_available()) return;
  constexpr std::int64_t kSamples = 300;
  for (std::int64_t k = 0; k < kSamples; ++k) {
    const auto message = node.step({.time = core::Instant::from_ns((1'000 + k) * 10'000'000)});
    for (const app::AxisRate& axis : message.axes) {
      const float sigma = axis.sigma.in(core::rad_per_s);
      fuzz::promise(sigma >= 0.0F && std::isfinite(sigma), "a deviation is finite, not negative");
      fuzz::promise(std::isfinite(axis.bias.in(core::rad_per_s)), "a bias is finite");
    }
  }
}

/// Bytes as the input wants them, in a record whose checksum is right.
template <class Record>
Record forged(Record record, FuzzedDataProvider& input) {
  const std::size_t end = record.size() - 4;
  const auto at = input.ConsumeIntegralInRange<std::size_t>(0, end - 1);
  for (std::size_t i = at; i < end && input.remaining_bytes() > 0; ++i) {
    record[i] = input.ConsumeIntegral<std::uint8_t>();
  }
  zerorate::testing::put_checksum(record);
  return record;
}

template <core::ModelShape Shape>
void take_up(FuzzedDataProvider& input) {
  using Node = app::GyroNode<Shape>;
  static Learnt<Node> learnt{params<Shape>()};
  const app::Snapshot<Node> snapshot{params<Shape>(), kSensor};
  const app::SnapshotTime saved{.session = {'a'}, .utc_s = input.ConsumeIntegral<std::int64_t>()};
  app::SnapshotTime now{.session = {input.ConsumeBool() ? 'a' : 'b'}, .utc_s = std::nullopt};
  if (input.ConsumeBool()) now.utc_s = input.ConsumeIntegral<std::int64_t>();
  switch (input.ConsumeIntegralInRange<int>(0, 2)) {
    case 0:
      restore<Shape>(forged(snapshot.of_state(learnt.node.state(), saved), input), now);
      break;
    case 1:
      restore<Shape>(forged(snapshot.of_filters(learnt.node, saved), input), now);
      break;
    default:
      restore<Shape>(input.ConsumeRemainingBytes<std::uint8_t>(), now);
      break;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input(data, size);
  if (input.ConsumeBool()) {
    take_up<kLearning>(input);
  } else {
    take_up<kKnown>(input);
  }
  return 0;
}
