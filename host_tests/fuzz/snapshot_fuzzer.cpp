// Records of what a node has learnt: anything that is not one is refused and touches nothing; one
// that was made by another program, with a header of its own and the right checksum, never leads to
// a variance that is none.

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
using Node = app::GyroNode<core::ModelShape{.decaying = 4}>;
using Snapshot = app::Snapshot<Node>;

constexpr core::Duration kTick = core::Duration::milliseconds(100);
constexpr std::uint32_t kSensor = 7;
constexpr std::size_t kHeaderBytes = 64;

const Node::Params& params() {
  static const Node::Params params{
      .modes = core::compose(kTick, core::Start::stationary,
                             zerorate::testing::flicker_like<4>(kTick, 0.5)),
      .white_variance_rad2_s2 = 1e-6F,
      .turn_on_variance_rad2_s2 = 1e-8F,
      .sample_period = core::Duration::milliseconds(10)};
  return params;
}

/// A node after ten seconds of standstill.
struct Learnt {
  Learnt() {
    for (std::int64_t ms = 0; ms < 10'000; ms += 10) {
      (void)node.step({.time = core::Instant::from_ns(ms * 1'000'000)});
    }
  }
  Node node{params()};
};

template <class Record>
void restore(const Record& record, const app::SnapshotTime& now) {
  Node node{params()};
  const auto resumed = Snapshot{params(), kSensor}.restore(node, record, now);
  const core::Prediction predicted = node.predict(app::Predictor::kalman, 0);
  fuzz::promise(resumed.has_value() == predicted.is_available(),
                "a node knows something after a record that it took up, and only then");
  if (!resumed) return;
  const auto message = node.step({.time = core::Instant::from_ns(0)});
  for (const app::AxisRate& axis : message.axes) {
    const float sigma = axis.sigma.in(core::rad_per_s);
    fuzz::promise(sigma > 0.0F && std::isfinite(sigma), "a deviation is positive and finite");
    fuzz::promise(std::isfinite(axis.bias.in(core::rad_per_s)), "a bias is finite");
  }
}

/// Bytes of the header as the input wants them, in a record whose checksum is right.
template <class Record>
Record forged(Record record, FuzzedDataProvider& input) {
  const auto at = input.ConsumeIntegralInRange<std::size_t>(0, kHeaderBytes - 1);
  for (std::size_t i = at; i < kHeaderBytes && input.remaining_bytes() > 0; ++i) {
    record[i] = input.ConsumeIntegral<std::uint8_t>();
  }
  zerorate::testing::put_checksum(record);
  return record;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input(data, size);
  const app::SnapshotTime saved{.session = {'a'}, .utc_s = input.ConsumeIntegral<std::int64_t>()};
  app::SnapshotTime now{.session = {input.ConsumeBool() ? 'a' : 'b'}, .utc_s = std::nullopt};
  if (input.ConsumeBool()) now.utc_s = input.ConsumeIntegral<std::int64_t>();
  static const Learnt learnt;
  const Snapshot snapshot{params(), kSensor};
  switch (input.ConsumeIntegralInRange<int>(0, 2)) {
    case 0:
      restore(forged(snapshot.of_state(learnt.node.state(), saved), input), now);
      break;
    case 1:
      restore(forged(snapshot.of_filters(learnt.node, saved), input), now);
      break;
    default:
      restore(input.ConsumeRemainingBytes<std::uint8_t>(), now);
      break;
  }
  return 0;
}
