// The node on your board. Copy this folder, fill in board.hpp; nothing here needs a change.

#include <array>
#include <cstdint>

#include "firmware/app/node_loop.hpp"
#include "firmware/app/snapshot.hpp"
#include "firmware/boards/common/console.hpp"
#include "firmware/boards/template/board.hpp"

namespace zerorate::board {
namespace {

using Node = app::GyroNode<exported::kModelShape, kCapacity>;
static_assert(Node::check(exported::kNodeParams).has_value(),
              "the capacity does not suit the model");
using Gyro = Chip::Driver<Wire>;
constexpr app::Snapshot<Node> kSnapshot{exported::kNodeParams, app::sensor_id(Chip::kName)};

/// Keeps what was learnt when a stop ends.
class Keeper {
 public:
  void restore(Node& node) {
    if (const auto size = memory_.load(record_)) {
      // There is no place for a reason of refusal: see health's `calibrated`.
      (void)kSnapshot.restore_filters(node, std::span{record_}.first(*size), {});
    }
  }
  void poll(Node& node) {
    const bool stands = node.motion() == core::Motion::still;
    if (stood_ && !stands && node.is_learning()) return;  // until the stop is learnt
    if (stood_ && !stands && node.predictors().has_learnt()) {
      kSnapshot.write_filters(node, {}, record_);
      (void)memory_.save(record_);
    }
    stood_ = stands;
  }

 private:
  Memory memory_;
  bool stood_ = false;
  std::array<std::uint8_t, app::Snapshot<Node>::kBytesOfFilters> record_{};
};

}  // namespace
}  // namespace zerorate::board

extern "C" [[noreturn]] int main() {
  using namespace zerorate;
  using namespace zerorate::board;
  start();
  static Clock clock;
  static Bus bus;
  static Line line;
  static Gyro gyro{Wire{bus}, kSettings};
  static Node node{exported::kNodeParams};
  static boards::Console console{line};
  static app::NodeLoop<Node, Gyro, decltype(pulses), decltype(data_ready), Clock, decltype(console),
                       2>
      loop{node, gyro, pulses, data_ready, clock, console};
  static Keeper keeper;
  keeper.restore(node);
  for (;;) {
    loop.poll();
    keeper.poll(node);
    sleep();
  }
}
