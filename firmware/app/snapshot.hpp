/// @file
/// Record of what a node has learnt, which outlives its program and its power.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

#include "core/base/crc32.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "firmware/app/fingerprint.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/app/resumption.hpp"

namespace zerorate::app {

/// One run of the sensor's power and of the monotonic clock: on Linux the kernel's boot id. All
/// zeros where the board cannot tell: then every start counts as another session.
using Session = std::array<char, 36>;

/// A number for a sensor that is told by its name, or by what it is wired to.
[[nodiscard]] constexpr std::uint32_t sensor_id(std::string_view name) {
  std::uint32_t id = 0;
  for (const char letter : name) {
    id = core::crc32(std::array{static_cast<std::uint8_t>(letter)}, id);
  }
  return id;
}

/// When a snapshot is taken, or taken up.
struct SnapshotTime {
  Session session{};
  std::optional<std::int64_t> utc_s;  ///< seconds since 1970, if there is a clock
};

/// Writes and reads the records of one node. A record is
///
///     header | biases | filters and lessons of references, or the node's whole state | CRC-32
///
/// in the byte order and layout that all our processors share; the layout is part of the model's
/// fingerprint. The filters are enough to go on after the power was off. Within one session the
/// whole state goes on bit for bit. The biases are what a node with another model goes on with.
template <class Node>
class Snapshot {
  static_assert(std::endian::native == std::endian::little);

 public:
  using State = typename Node::State;
  using Predictors = typename Node::Predictors;
  using Filter = typename Predictors::Filter;
  using Levels = typename Node::Ticks::Levels;
  using Inputs = typename Node::TickInputs;
  using Params = typename Node::Params;

  static constexpr bool kTakesReferences = Node::Ticks::kTakesReferences;
  /// Lessons of references.
  using Motion = std::conditional_t<kTakesReferences, core::LearntMotion, NoReferences>;
  using FilterBytes = std::span<const std::uint8_t, sizeof(Filter)>;

  static constexpr std::uint16_t kLayout = 11;
  static constexpr std::size_t kBytesOfInputs = std::is_empty_v<Inputs> ? 0 : sizeof(Inputs);
  static constexpr std::size_t kBytesOfMotion = kTakesReferences ? sizeof(Motion) : 0;
  static constexpr std::size_t kBytesOfBiases = 4 * (Node::kAxes + 3);
  static constexpr std::size_t kBytesOfFilters =
      64 + kBytesOfBiases + sizeof(Filter) + sizeof(Levels) + kBytesOfInputs + kBytesOfMotion + 4;
  static constexpr std::size_t kBytesOfState = 64 + kBytesOfBiases + sizeof(State) + 4;

  /// @param sensor identifies the sensor: another number, another sensor
  constexpr Snapshot(const Params& params, std::uint32_t sensor)
      : model_(fingerprint<Node>(params)),
        sensor_(sensor),
        tick_(params.model.modes.tick),
        inputs_(params.model.inputs),
        scale_(params.model.scale),
        turn_on_is_known_(core::is_finite(params.model.turn_on_variance_rad2_s2)) {}

  /// A record for boards that lose their power, of all that is certain (GyroNode::finish_learning).
  [[nodiscard]] std::array<std::uint8_t, kBytesOfFilters> of_filters(
      Node& node, const SnapshotTime& time) const {
    std::array<std::uint8_t, kBytesOfFilters> record{};
    write_filters(node, time, record);
    return record;
  }
  /// Writes that record into the caller's memory.
  void write_filters(Node& node, const SnapshotTime& time,
                     std::span<std::uint8_t, kBytesOfFilters> record) const {
    node.finish_learning();
    const auto& ticks = node.ticks();
    std::span<std::uint8_t> rest = begin(record, Content::filters, node.predictors().has_learnt(),
                                         ticks.ticks_since_measured(), time);
    const Filter& filter = node.predictors().filter();
    const Inputs inputs = ticks.inputs().measured();
    put(rest, biases_of(filter, inputs, ticks.ticks_since_measured()));
    put(rest, filter);
    put(rest, ticks.levels());
    if constexpr (kBytesOfInputs > 0) put(rest, inputs);
    if constexpr (kTakesReferences) put(rest, node.heading_filter().state().learnt());
    finish(record);
  }
  /// A record for programs that are restarted.
  [[nodiscard]] std::array<std::uint8_t, kBytesOfState> of_state(const State& state,
                                                                 const SnapshotTime& time) const {
    std::array<std::uint8_t, kBytesOfState> record{};
    const Filter& filter = state.ticks.predictors.kalman;
    auto rest =
        begin(record, Content::state, filter.is_confirmed(), state.ticks_since_measured(), time);
    const auto inputs = Node::InputTrack::measured(state.ticks.inputs);
    put(rest, biases_of(filter, inputs, state.ticks_since_measured()));
    put(rest, state);
    finish(record);
    return record;
  }

  /// Takes a record up into a node that has seen no sample yet. A refusal leaves it as it was.
  core::Result<Resumption, SnapshotRefusal> restore(Node& node,
                                                    std::span<const std::uint8_t> record,
                                                    const SnapshotTime& now) const {
    const auto header = read_header(record);
    if (!header || header->model != model_ || header->content != Content::state ||
        record.size() != kBytesOfState) {
      return restore_filters(node, record, now);
    }
    const auto state = get<State>(record.subspan(kPayload));
    if (!is_possible_state(node, state)) return core::Unexpected{SnapshotRefusal::impossible};
    if (header->session == now.session && now.session != Session{}) {
      node.restore(state);
      return if_possible(node, *header, Resumption::continued);
    }
    const Filter& filter = state.ticks.predictors.kalman;
    Learnt learnt{
        .filter = FilterBytes{reinterpret_cast<const std::uint8_t*>(&filter), sizeof(filter)},
        .levels = state.ticks.levels(),
        .inputs = Node::InputTrack::measured(state.ticks.inputs),
        .motion = {}};
    if constexpr (kTakesReferences) learnt.motion = state.turn.references.filter.learnt();
    return resume(node, learnt, *header, now);
  }
  /// restore() of records of the filters only: no room for a whole state on the stack.
  core::Result<Resumption, SnapshotRefusal> restore_filters(Node& node,
                                                            std::span<const std::uint8_t> record,
                                                            const SnapshotTime& now) const {
    const auto header = read_header(record);
    if (!header) return core::Unexpected{header.error()};
    if (header->model != model_) {
      return resume(node, scaled(get<Biases>(record.subspan(sizeof(Header)))), *header, now);
    }
    if (header->content != Content::filters || record.size() != kBytesOfFilters) {
      return core::Unexpected{SnapshotRefusal::not_a_snapshot};
    }
    const auto payload = record.subspan(kPayload);
    const auto after_filter = payload.subspan(sizeof(Filter));
    Learnt learnt{.filter = payload.first<sizeof(Filter)>(),
                  .levels = get<Levels>(after_filter),
                  .inputs = {},
                  .motion = {}};
    if constexpr (kBytesOfInputs > 0) {
      learnt.inputs = get<Inputs>(after_filter.subspan(sizeof(Levels)));
      if (!Inputs::is_possible(learnt.inputs)) {
        return core::Unexpected{SnapshotRefusal::impossible};
      }
    }
    if constexpr (kTakesReferences) {
      learnt.motion = get<Motion>(after_filter.subspan(sizeof(Levels) + kBytesOfInputs));
      if (!learnt.motion.is_possible()) return core::Unexpected{SnapshotRefusal::impossible};
    }
    return resume(node, learnt, *header, now);
  }

 private:
  enum class Content : std::uint8_t { filters, state };
  static constexpr std::uint32_t kMark = 0x534E525A;  // "ZRNS"
  static constexpr std::int64_t kNoClock = std::numeric_limits<std::int64_t>::min();
  static constexpr core::Duration kLongestPause = core::Duration::seconds(86'400);

  struct Header {
    std::uint32_t mark = kMark;
    std::uint16_t layout = kLayout;
    Content content = Content::filters;
    std::uint8_t calibrated = 0;  ///< 1: there is something learnt
    std::uint32_t model = 0;
    std::uint32_t sensor = 0;
    std::int64_t utc_s = kNoClock;
    Session session{};
    std::uint32_t ticks_since_measured = 0;
  };
  static_assert(sizeof(Header) == 64 && std::has_unique_object_representations_v<Header>);
  /// Biases on the scale of the chip, which mean the same whatever the model is.
  struct Biases {
    std::array<float, Node::kAxes> bias_rad_s{};
    float variance_rad2_s2 = 0.0F;  ///< variance of the axis with the largest one
    float temperature_degc = 0.0F;  ///< at which they were measured; no number where unknown
    float age_s = 0.0F;             ///< when the record was written

    [[nodiscard]] constexpr bool is_possible() const {
      return std::all_of(bias_rad_s.begin(), bias_rad_s.end(), core::is_finite) &&
             core::is_finite_positive(variance_rad2_s2) && age_s >= 0.0F;
    }
  };
  /// Content of a record for a node with the same model.
  struct Learnt {
    FilterBytes filter;
    Levels levels;
    Inputs inputs;
    [[no_unique_address]] Motion motion;
  };
  static constexpr float kMostTicks = 1e9F;
  static constexpr std::size_t kPayload = sizeof(Header) + sizeof(Biases);
  static_assert(kPayload == 64 + kBytesOfBiases);
  struct Pause {
    std::uint32_t ticks = 0;
    bool is_known = false;  ///< true by the clock; else a day
  };

  template <class Value>
  static void put(std::span<std::uint8_t>& to, const Value& value) {
    const auto bytes = std::as_bytes(std::span{&value, 1});
    std::ranges::transform(bytes, to.begin(), [](std::byte byte) { return std::uint8_t(byte); });
    to = to.subspan(sizeof(Value));
  }
  template <class Value>
  static Value get(std::span<const std::uint8_t> from) {
    Value value{};
    std::ranges::transform(from.first(sizeof(Value)),
                           std::as_writable_bytes(std::span{&value, 1}).begin(),
                           [](std::uint8_t byte) { return std::byte{byte}; });
    return value;
  }

  std::span<std::uint8_t> begin(std::span<std::uint8_t> record, Content content, bool calibrated,
                                std::uint32_t ticks_since_measured,
                                const SnapshotTime& time) const {
    put(record, Header{.content = content,
                       .calibrated = calibrated,
                       .model = model_,
                       .sensor = sensor_,
                       .utc_s = time.utc_s.value_or(kNoClock),
                       .session = time.session,
                       .ticks_since_measured = ticks_since_measured});
    return record;
  }
  static void finish(std::span<std::uint8_t> record) {
    std::span<std::uint8_t> end = record.last(4);
    put(end, core::crc32(record.first(record.size() - 4)));
  }

  core::Result<Header, SnapshotRefusal> read_header(std::span<const std::uint8_t> record) const {
    using core::Unexpected;
    if (record.size() < kPayload + 4) return Unexpected{SnapshotRefusal::not_a_snapshot};
    const auto header = get<Header>(record);
    if (header.mark != kMark) return Unexpected{SnapshotRefusal::not_a_snapshot};
    const std::size_t end = record.size() - 4;
    if (get<std::uint32_t>(record.subspan(end)) != core::crc32(record.first(end))) {
      return Unexpected{SnapshotRefusal::damaged};
    }
    if (header.layout != kLayout) return Unexpected{SnapshotRefusal::other_layout};
    if (header.sensor != sensor_) return Unexpected{SnapshotRefusal::other_sensor};
    return header;
  }

  [[nodiscard]] Biases biases_of(const Filter& filter, const Inputs& inputs,
                                 std::uint32_t ticks_since_measured) const {
    Biases biases{.temperature_degc = core::temperature_degc(inputs_, inputs),
                  .age_s = static_cast<float>(ticks_since_measured) * tick_.in_seconds()};
    const auto newest = filter.newest();
    for (std::size_t i = 0; i < Node::kAxes; ++i) {
      biases.bias_rad_s[i] = newest[i].bias_rad_s / scale_.factor[i];
      biases.variance_rad2_s2 = std::max(biases.variance_rad2_s2, newest[i].variance_rad2_s2);
    }
    return biases;
  }

  /// Not inlined: a board counts its stack.
  [[gnu::noinline]] [[nodiscard]] Biases scaled(const Biases& chip) const {
    Biases biases = chip;
    for (std::size_t i = 0; i < Node::kAxes; ++i) biases.bias_rad_s[i] *= scale_.factor[i];
    return biases;
  }

  core::Result<Resumption, SnapshotRefusal> resume(Node& node, const Learnt& learnt,
                                                   const Header& header,
                                                   const SnapshotTime& now) const {
    const auto pause = pause_since(header, now);
    if (!pause) return core::Unexpected{pause.error()};
    node.resume(learnt.inputs, added(header.ticks_since_measured, pause->ticks),
                learnt.levels.white, learnt.filter, learnt.levels.drive);
    if constexpr (kTakesReferences) {
      node.resume_motion(learnt.motion, static_cast<float>(pause->ticks) * tick_.in_seconds());
    }
    return if_possible(node, header,
                       pause->is_known ? Resumption::aged : Resumption::aged_by_a_day);
  }
  core::Result<Resumption, SnapshotRefusal> resume(Node& node, const Biases& learnt,
                                                   const Header& header,
                                                   const SnapshotTime& now) const {
    const auto pause = pause_since(header, now);
    if (!pause) {
      // The power may have stayed: it is the model that is another.
      const bool is_model = pause.error() == SnapshotRefusal::turn_on_unknown;
      return core::Unexpected{is_model ? SnapshotRefusal::other_model : pause.error()};
    }
    const float age_ticks = learnt.age_s / tick_.in_seconds();
    if (!learnt.is_possible() || !(age_ticks < kMostTicks)) {
      return core::Unexpected{SnapshotRefusal::not_a_snapshot};
    }
    node.resume(core::inputs_at<Node::kShape>(inputs_, learnt.temperature_degc),
                added(static_cast<std::uint32_t>(age_ticks), pause->ticks), 0.0F, learnt.bias_rad_s,
                learnt.variance_rad2_s2);
    return if_possible(node, header, Resumption::bias_alone);
  }
  /// Begins the node anew where a record does not say of itself what it holds, or holds what
  /// predicts no numbers.
  static core::Result<Resumption, SnapshotRefusal> if_possible(Node& node, const Header& header,
                                                               Resumption how) {
    const bool is_calibrated = header.calibrated != 0;
    if (node.predictors().has_learnt() == is_calibrated && predicts_numbers(node)) return how;
    new (&node) Node{node.params()};  // in its place: a stack need not hold a second one
    return core::Unexpected{SnapshotRefusal::impossible};
  }

  [[nodiscard]] core::Result<Pause, SnapshotRefusal> pause_since(const Header& header,
                                                                 const SnapshotTime& now) const {
    using core::Unexpected;
    if (header.calibrated == 0) return Unexpected{SnapshotRefusal::nothing_learnt};
    if (!turn_on_is_known_) return Unexpected{SnapshotRefusal::turn_on_unknown};
    // A clock before 1970, or one that went backwards and so was set meanwhile, is as good as none.
    const bool is_known = header.utc_s >= 0 && now.utc_s && *now.utc_s >= header.utc_s;
    core::Duration pause = kLongestPause;
    if (is_known) {
      constexpr std::int64_t kYear_s = std::int64_t{365} * 86'400;
      pause = core::Duration::seconds(std::min(*now.utc_s - header.utc_s, kYear_s));
    }
    const std::int64_t ticks = std::min(pause / tick_, std::int64_t{kLongestLead});
    return Pause{.ticks = static_cast<std::uint32_t>(ticks), .is_known = is_known};
  }

  /// Longest time over which something is aged, in ticks: 12 days of 1 ms, 17 years of 0.5 s.
  static constexpr std::uint32_t kLongestLead = 1U << 30U;
  [[nodiscard]] static constexpr std::uint32_t added(std::uint32_t ticks, std::uint32_t pause) {
    return ticks < kLongestLead - pause ? ticks + pause : kLongestLead;
  }

  std::uint32_t model_;
  std::uint32_t sensor_;
  core::Duration tick_;
  const core::InputBlock<Node::kShape.inputs>& inputs_;
  core::ScaleCorrection scale_;
  bool turn_on_is_known_;
};

}  // namespace zerorate::app
