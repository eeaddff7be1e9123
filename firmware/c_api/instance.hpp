/// @file
/// Content of the storage that a caller in C gives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/time.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/app/snapshot.hpp"
#include "firmware/c_api/include/zerorate.h"
#include "firmware/c_api/node_of_model.hpp"
#include "firmware/c_api/rest_word.hpp"

namespace zerorate::c_api {

using Snapshot = app::Snapshot<Node>;

/// A node with what is around it in a program in C: the word of the vehicle. One thread.
class Instance {
 public:
  Instance(const Node::Params& given, const zerorate_config& config)
      : params_(given),
        node_(params_),
        word_(core::Duration::nanoseconds(config.word_timeout_ns)),
        sensor_id_(config.sensor_id) {}

  /// Whether the storage was initialised, and not moved since.
  [[nodiscard]] bool is_here() const { return self_ == this; }
  [[nodiscard]] const Node& node() const { return node_; }
  [[nodiscard]] Node& node() { return node_; }
  [[nodiscard]] Snapshot snapshot() const { return {params_, sensor_id_}; }

  /// Whether a stamp is so far behind the newest sample that its clock wrapped, was set, or is
  /// another one.
  [[nodiscard]] bool is_far_back(core::Instant at) const {
    constexpr core::Duration kLatest = core::Duration::seconds(1);
    return node_.has_sample() &&
           node_.newest_sample() - at > params_.standstill.hold_back + kLatest;
  }

  void pulse(core::Instant at) {
    word_.hear(at, false);
    if (is_far_back(at)) return report_odometer_fault(at);
    node_.pulse(at);
  }
  /// Two pulses for a word of motion: a single one would be read as a slow wheel and lengthen the
  /// silence that is required.
  void hear(core::Instant at, bool stands) {
    word_.hear(at, stands);
    if (stands) return;
    if (is_far_back(at)) return report_odometer_fault(at);
    move(at);
  }
  /// At the newest sample where the stamp is of another clock: the stop is over by either.
  void report_odometer_fault(core::Instant at) {
    node_.report_odometer_fault(is_far_back(at) ? node_.newest_sample() : at);
  }

  app::RateMessage take(const core::GyroSample& sample) {
    if (node_.can_take(sample.time)) follow_word(sample.time);
    return node_.step(sample);
  }

 private:
  void move(core::Instant at) {
    node_.pulse(at);
    node_.pulse(at);
  }
  /// A sample that no word of rest covers is one of motion.
  void follow_word(core::Instant now) {
    if (params_.standstill.source == core::StandstillSource::gyro) return;
    word_.start(now);
    const RestWord::Verdict verdict = word_.at(now);
    if (verdict == RestWord::Verdict::motion) move(now);
    if (verdict == RestWord::Verdict::silence) node_.report_odometer_fault(now);
  }

  const Instance* self_ = this;
  Node::Params params_;
  Node node_;
  RestWord word_;
  std::uint32_t sensor_id_;
};
static_assert(sizeof(Instance) <= sizeof(zerorate_node));
static_assert(sizeof(void*) < 8 || sizeof(zerorate_node) <= sizeof(Instance) + 64, "bytes wasted");
static_assert(alignof(Instance) <=
              alignof(zerorate_node));  // NOLINT(misc-redundant-expression): not everywhere equal
static_assert(std::is_trivially_destructible_v<Instance>);  // zerorate_init() may be called again

}  // namespace zerorate::c_api
