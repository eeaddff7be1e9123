/// @file
/// Content of the storage that a caller in C gives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/time.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/app/rate_watch.hpp"
#include "firmware/app/sample_watch.hpp"
#include "firmware/app/snapshot.hpp"
#include "firmware/c_api/include/zerorate.h"
#include "firmware/c_api/node_of_model.hpp"
#include "firmware/c_api/rest_word.hpp"

namespace zerorate::c_api {

using Snapshot = app::Snapshot<Node>;

/// A node with what is around it in a program in C, where there is no NodeLoop: the word of the
/// vehicle and the watches of the samples. One thread.
class Instance {
 public:
  Instance(const Node::Params& given, const zerorate_config& config)
      : params_(given),
        node_(params_),
        word_(core::Duration::nanoseconds(config.word_timeout_ns),
              config.standstill == ZERORATE_BY_WORD),
        watch_(given.model.white_variance_rad2_s2, given.model.sample_period),
        sensor_id_(config.sensor_id) {
    watch_.set_step(core::rad_per_s(config.count_rad_s));
  }

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
    word_.pulse(at);
    move(at, 1);
  }
  /// Two pulses for a word of motion: a single one would be read as a slow wheel and lengthen the
  /// silence that is required.
  void hear(core::Instant at, bool stands) {
    word_.hear(at, stands);
    if (!stands) move(at, 2);
  }
  /// At the newest sample where the stamp is of another clock: the stop is over by either.
  void report_odometer_fault(core::Instant at) {
    node_.report_odometer_fault(is_far_back(at) ? node_.newest_sample() : at);
  }

  app::RateMessage take(const core::GyroSample& sample) {
    const bool is_frozen = node_.can_take(sample) && watch(sample) != 0;
    app::RateMessage message =
        is_frozen ? node_.step_without_sample(sample.time) : node_.step(sample);
    message.health.sample_rate_off = sample_rate_.is_off();
    return message;
  }

 private:
  /// Not inlined, as those below: they are called at several places, and a node counts bytes of
  /// program and stack.
  [[gnu::noinline]] void move(core::Instant at, int pulses) {
    if (is_far_back(at)) return report_odometer_fault(at);
    for (int i = 0; i < pulses; ++i) node_.pulse(at);
  }
  /// A sample that no word of rest covers is one of motion.
  [[gnu::noinline]] void follow_word(core::Instant now) {
    if (params_.standstill.source == core::StandstillSource::gyro) return;
    word_.start(now);
    const RestWord::Verdict verdict = word_.at(now);
    if (verdict == RestWord::Verdict::motion) move(now, 2);
    if (verdict == RestWord::Verdict::silence) report_odometer_fault(now);
  }
  /// Looks at a sample before the node takes it.
  /// @return axes that are at fault, one bit each
  [[gnu::noinline]] std::uint8_t watch(const core::GyroSample& sample) {
    follow_word(sample.time);
    sample_rate_.take(sample.time, 1, params_.model.sample_period);
    return app::watch_before(node_, watch_, sample, word_.driven_at(), sample.time);
  }

  const Instance* self_ = this;
  Node::Params params_;
  Node node_;
  RestWord word_;
  app::RateWatch sample_rate_;
  app::SampleWatch<ZERORATE_AXES> watch_;
  std::uint32_t sensor_id_;
};
static_assert(sizeof(Instance) <= sizeof(zerorate_node));
static_assert(sizeof(void*) < 8 || sizeof(zerorate_node) <= sizeof(Instance) + 64, "bytes wasted");
static_assert(alignof(Instance) <=
              alignof(zerorate_node));  // NOLINT(misc-redundant-expression): not everywhere equal
static_assert(std::is_trivially_destructible_v<Instance>);  // zerorate_init() may be called again

}  // namespace zerorate::c_api
