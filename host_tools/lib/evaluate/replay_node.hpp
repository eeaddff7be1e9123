/// @file
/// The node that a recording runs through, with its parameters, its clock and its odometer.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tools/lib/evaluate/odometer.hpp"
#include "host_tools/lib/evaluate/replay.hpp"

namespace zerorate::evaluate {

/// Rows from whose intervals a replay takes the sample period.
inline constexpr std::size_t kRowsAhead = 2000;

/// Filter tick of a replay: that of the options, or half a second, or the sample period where that
/// is longer. Throws std::invalid_argument for a filter rate above the sample rate.
[[nodiscard]] core::Duration filter_tick(const ReplayOptions& options,
                                         core::Duration sample_period);

/// Mean interval and filter tick of the samples that a node gets.
struct SampleTiming {
  core::Duration sample_period;
  core::Duration filter_tick;
};

/// A node as the firmware has it, fed with rows of a recording.
template <core::ModelShape Shape>
class ReplayNode {
 public:
  using Node = app::GyroNode<Shape, app::NodeCapacity{.screens_samples = true}>;
  /// Every replay begins at this time of the node's clock, whatever the recording's.
  static constexpr core::Instant kStart = core::Instant::from_ns(1'000'000'000);

  /// Sample and pulses of a row.
  struct Arrival {
    core::GyroSample sample;
    std::span<const core::Instant> pulses;  ///< valid until the next row
    bool moving;                            ///< state in the recording or the schedule
  };

  /// @param first_time_ns  of the recording: becomes kStart
  /// Throws std::invalid_argument for options that no node can run with.
  ReplayNode(const ReplayOptions& options, const recording::Columns& columns,
             const SampleTiming& timing, std::int64_t first_time_ns)
      : axis_count_(columns.axis_count),
        shift_(kStart - core::Instant::from_ns(first_time_ns)),
        params_(make_params(options, timing)),
        odometer_(make_odometer(columns, options.schedule, kStart, timing.sample_period,
                                options.standstill.source != core::StandstillSource::gyro)),
        node_(params_) {}

  /// Takes the next row up to the node, which does not see it yet.
  Arrival arrive(const recording::Row& row) {
    const core::Instant at = core::Instant::from_ns(row.time_ns) + shift_;
    // A row whose time runs backwards is refused by the node, but what it counted was real: the
    // odometer's time stands still until the recording has caught up.
    latest_ = std::max(latest_, at);
    pulses_.clear();
    const bool moving = odometer_->pulses_until(latest_, row, pulses_);
    return {sample_of(row, at), pulses_, moving};
  }

  [[nodiscard]] Node& node() { return node_; }
  [[nodiscard]] const Node& node() const { return node_; }
  [[nodiscard]] const typename Node::Params& params() const { return params_; }
  [[nodiscard]] core::Instant latest() const { return latest_; }
  /// From the clock of the recording to that of the node.
  [[nodiscard]] core::Duration shift() const { return shift_; }

 private:
  static typename Node::Params make_params(const ReplayOptions& options,
                                           const SampleTiming& timing) {
    typename Node::Params params{.model = model::make_node_model<Shape>(
                                     options.model, timing.sample_period, timing.filter_tick),
                                 .standstill = options.standstill,
                                 .odometer = options.odometer,
                                 .earth = options.earth,
                                 .up = options.up,
                                 .published = options.published,
                                 .learns_white_noise = options.learns_noise};
    if (options.references) {
      const truth::VerticalAxis& vertical = options.references->vertical;
      const core::UpAxis turned{.axis = static_cast<std::uint8_t>(vertical.axis),
                                .points_down = vertical.sign < 0.0};
      if (options.up.value_or(turned) != turned) {
        throw std::invalid_argument(
            fmt::format("--up: the reference turns about {}{}; leave --up away, or mend the axis",
                        turned.points_down ? "-" : "", "xyz"[turned.axis]));
      }
      params.up = turned;
    }
    if (!options.learns_noise) params.model.hypotheses = {};
    if (options.schedule) params.odometer.longest_straight = {};
    if (const auto checked = Node::check(params); !checked) {
      throw std::invalid_argument(std::string(app::reason(checked.error())));
    }
    return params;
  }

  /// A recording of one axis drives all three, so that no axis reads an impossible silence.
  [[nodiscard]] core::GyroSample sample_of(const recording::Row& row, core::Instant at) const {
    core::GyroSample sample{.time = at};
    for (std::size_t i = 0; i < Node::kAxes; ++i) {
      sample.rate[i] = core::rad_per_s(row.rate_rad_s[i < axis_count_ ? i : 0]);
    }
    sample.has_temperature = std::isfinite(row.temperature_degc);
    if (sample.has_temperature) {
      sample.temperature = core::Temperature::from_degc(row.temperature_degc);
    }
    sample.has_acceleration = row.has_acceleration();
    if (sample.has_acceleration) {
      std::ranges::transform(row.acceleration_m_s2, sample.acceleration.begin(), core::m_per_s2);
    }
    return sample;
  }

  std::size_t axis_count_;
  core::Duration shift_;
  typename Node::Params params_;
  std::unique_ptr<Odometer> odometer_;
  Node node_;
  std::vector<core::Instant> pulses_;
  core::Instant latest_ = kStart;  ///< time of the recording so far
};

}  // namespace zerorate::evaluate
