// Records whose checksum is right and of which one field cannot be: each field of the state in
// turn, in nodes with and without hypotheses, inputs and references.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/noise/terms.hpp"
#include "firmware/app/snapshot.hpp"
#include "host_tests/support/checksum.hpp"
#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app {
namespace {

using testing::at_ms;

constexpr core::ModelShape kPlain{.decaying = 4};
constexpr core::ModelShape kLearning{.decaying = 4, .hypotheses = 4};
constexpr core::ModelShape kWithForces{.decaying = 4, .inputs = 2, .has_accelerometer = true};
constexpr std::size_t kHeader = 64;
constexpr std::size_t kStride = 7;  // reaches each of the four bytes of a word in turn
constexpr SnapshotTime kSaved{.session = {'a'}, .utc_s = 1'000'000};
constexpr SnapshotTime kLater{.session = {'b'}, .utc_s = 1'000'060};

template <core::ModelShape Shape>
NodeParams<Shape> params_of() {
  NodeParams<Shape> params{
      .model = {.modes = core::compose(testing::kTick, core::Start::stationary,
                                       zerorate::testing::flicker_like<4>(testing::kTick, 0.5)),
                .white_variance_rad2_s2 = testing::kWhiteSigmaRadS * testing::kWhiteSigmaRadS,
                .turn_on_variance_rad2_s2 = 1e-8F,
                .sample_period = testing::kSamplePeriod}};
  if constexpr (Shape.hypotheses > 1) {
    params.model.hypotheses.count = Shape.hypotheses;
    params.model.hypotheses.kept = 0.999F;
    for (std::size_t m = 0; m < Shape.hypotheses; ++m) {
      auto& one = params.model.hypotheses.all[m];
      one.level = static_cast<float>(m + 1);
      one.strength.fill(one.level);
    }
  }
  return params;
}

/// A node after half a minute of rest, a drive and another stop, and whether it takes up what is
/// made of its records.
template <class Shape>
class ForgedRecord : public ::testing::Test {
 protected:
  using Node = GyroNode<Shape::value>;
  void SetUp() override {
    for (std::int64_t ms = 0; ms < 60'000; ms += 10) {
      if (ms > 30'000 && ms < 40'000) node_.pulse(at_ms(ms));
      (void)node_.step(testing::noisy_sample(at_ms(ms), testing::kBias));
    }
  }
  /// Takes a record up: refuses it and stays as it was, or gives figures that are numbers.
  template <class Record>
  bool is_taken_up(Record record, const SnapshotTime& now) {
    zerorate::testing::put_checksum(record);
    const auto node = std::make_unique<Node>(params_);
    if (!snapshot_.restore(*node, record, now)) {
      EXPECT_FALSE(node->predict(Predictor::kalman, 0).is_available()) << "it was touched";
      return false;
    }
    for (std::size_t axis = 0; axis < Node::kAxes; ++axis) {
      const core::Prediction predicted = node->predict(Predictor::kalman, axis);
      EXPECT_TRUE(!predicted.is_available() || std::isfinite(predicted.bias_rad_s));
      EXPECT_TRUE(!predicted.is_available() || predicted.variance_rad2_s2 >= 0.0F);
    }
    return true;
  }
  /// Puts each of some bytes in the place of each byte behind the header, and figures in the place
  /// of each word.
  template <class Record>
  void forge_all(const Record& good, const SnapshotTime& now) {
    EXPECT_TRUE(is_taken_up(good, now));
    int refused = 0;
    for (std::size_t at = kHeader; at + 4 < good.size(); at += kStride) {
      Record forged = good;
      forged[at] = 0xFF;
      refused += is_taken_up(forged, now) ? 0 : 1;
    }
    for (std::size_t at = kHeader; at + 8 <= good.size(); at += 4) {
      for (const float figure : {NAN, -1.0F}) {
        Record forged = good;
        std::ranges::copy(std::bit_cast<std::array<std::uint8_t, 4>>(figure),
                          forged.begin() + static_cast<std::ptrdiff_t>(at));
        refused += is_taken_up(forged, now) ? 0 : 1;
      }
    }
    EXPECT_GT(refused, 0);
  }

  typename Node::Params params_ = params_of<Shape::value>();
  Node node_{params_};
  Snapshot<Node> snapshot_{params_, 7};
};

template <core::ModelShape Shape>
struct ShapeType {
  static constexpr core::ModelShape value = Shape;
};
using Shapes = ::testing::Types<ShapeType<kPlain>, ShapeType<kLearning>, ShapeType<kWithForces>>;
TYPED_TEST_SUITE(ForgedRecord, Shapes);

/// Verifies SR-SNAP-06.
TYPED_TEST(ForgedRecord, OfAStateIsRefusedOrGivesNumbers) {
  this->forge_all(this->snapshot_.of_state(this->node_.state(), kSaved), kSaved);
}

/// Verifies SR-SNAP-06.
TYPED_TEST(ForgedRecord, OfTheFiltersIsRefusedOrGivesNumbers) {
  this->forge_all(this->snapshot_.of_filters(this->node_, kSaved), kLater);
}

/// Verifies SR-SNAP-05.
TYPED_TEST(ForgedRecord, OfAnotherLayoutIsRefusedAsSuch) {
  constexpr std::size_t kLayoutAt = 4;
  auto record = this->snapshot_.of_filters(this->node_, kSaved);
  for (const int step : {-1, 1}) {
    auto other = record;
    other[kLayoutAt] = static_cast<std::uint8_t>(other[kLayoutAt] + step);
    zerorate::testing::put_checksum(other);
    typename TestFixture::Node node{this->params_};
    EXPECT_EQ(this->snapshot_.restore(node, other, kLater).error(), SnapshotRefusal::other_layout);
    EXPECT_FALSE(node.predict(Predictor::kalman, 0).is_available());
  }
}

}  // namespace
}  // namespace zerorate::app
