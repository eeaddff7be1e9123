/// @file
/// The node behind a closed tick: what is learnt from it, and what is predicted for the next ones.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/assert.hpp"
#include "core/base/time.hpp"
#include "core/inputs/input_track.hpp"
#include "core/samples/tick_average.hpp"
#include "core/samples/white_level.hpp"
#include "firmware/app/axis_predictors.hpp"
#include "firmware/app/drive_integral.hpp"
#include "firmware/app/node_params.hpp"
#include "firmware/app/sample_screening.hpp"
#include "firmware/app/tick_work.hpp"

namespace zerorate::app {

/// Screens samples, learns from the means of ticks at standstill, and predicts the bias of the tick
/// being filled. GyroNode adds the stamps, the standstill and the messages. The likelihood of a
/// recording (identify) and the gain of a model (diagnose) feed ticks without these.
///
/// Learning from a tick and predicting one are long with many hypotheses, so both are cut into the
/// steps of TickStage; step() does one of them. Until the last one predicted() is the prediction
/// before. The way of spreading the steps does not change what is computed (docs/adr/0020).
///
/// Fixed memory, no heap; one thread (the caller's). Cost: see TickCosts.
template <ModelShape Shape, NodeCapacity Capacity = NodeCapacity{}>
class TickNode {
 public:
  static constexpr std::size_t kAxes = Capacity.axes;
  static constexpr bool kTakesReferences = Capacity.takes_references;
  static constexpr bool kHasAccelerometer = Shape.has_accelerometer;
  static constexpr bool kMeasuresVertical = kHasAccelerometer && kAxes == 3;
  using Params = NodeParams<Shape>;
  using Rates = std::array<float, kAxes>;
  using Predictors = AxisPredictors<Shape, Capacity>;
  using Predictions = std::array<core::Prediction, kAxes>;
  using Transition = core::FilterTransition<Shape>;
  using InputTrack = core::InputTrack<Shape>;
  using TickInputs = core::TickInputs<Shape>;
  using Screening = SampleScreening<kAxes, Capacity.screens_samples>;
  using WhiteLevel = core::WhiteLevel<kAxes>;
  using Lead = typename Predictors::Lead;
  using Earth = std::conditional_t<kMeasuresVertical, core::MeasuredEarth, core::GivenEarth>;
  static constexpr std::size_t kPieces = core::ModesOf<Shape>::kPieces;
  static constexpr std::size_t kMostItems = std::max({Shape.hypotheses, kAxes, kPieces});

  using Tick = LearntTick<kAxes, TickInputs, typename Screening::Squares>;
  using Stage = TickStage;
  using Costs = TickCosts<Shape, kAxes>;
  using Work = TickWork<Tick, Predictors>;
  /// Levels that a filter's figures are relative to; kept with it while the power is off.
  struct Levels {
    float white = 0.0F;  ///< white level that learnt scales rest on; 0: not seen
    [[no_unique_address]] typename Predictors::DriveScale::Memory drive;

    constexpr bool operator==(const Levels&) const = default;
  };

  /// Everything that is remembered; restored into a node with the same parameters it continues bit
  /// for bit.
  struct State {
    std::uint32_t tick = 0;            ///< tick being filled
    std::uint32_t measured_ticks = 0;  ///< ticks up to and with the newest measurement
    Transition lead;                   ///< from there to the end of that tick; 0 ticks: not made
    Predictions predicted{};
    [[no_unique_address]] typename InputTrack::State inputs;
    [[no_unique_address]] typename Screening::State screening;
    typename WhiteLevel::State white;
    typename Predictors::State predictors;
    Work work;

    constexpr bool operator==(const State&) const = default;
    [[nodiscard]] constexpr Levels levels() const {
      return {.white = white.reference, .drive = predictors.drive_scale.memory};
    }
    [[nodiscard]] constexpr std::uint32_t ticks_since_measured() const {
      return tick + 1 - measured_ticks;
    }
  };
  static_assert(std::is_trivially_copyable_v<State>);

  /// @param params must outlive the node
  constexpr explicit TickNode(const Params& params)
      : params_(params),
        one_tick_{params.model.modes.one_tick()},
        inputs_(params.model.inputs, params.model.modes.tick),
        screening_(params.model.samples),
        white_(params.model.white_variance_rad2_s2, params.model.samples, params.model.modes.tick,
               params.learns_white_noise, params.model.rounding()),
        predictors_(params) {}

  [[nodiscard]] constexpr State state() const {
    return {.tick = tick_,
            .measured_ticks = measured_ticks_,
            .lead = lead_,
            .predicted = predicted_,
            .inputs = inputs_.state(),
            .screening = screening_.state(),
            .white = white_.state(),
            .predictors = predictors_.state(),
            .work = work_};
  }
  constexpr void restore(const State& state) {
    tick_ = state.tick;
    measured_ticks_ = state.measured_ticks;
    lead_ = state.lead;
    predicted_ = state.predicted;
    inputs_.restore(state.inputs);
    screening_.restore(state.screening);
    white_.restore(state.white);
    predictors_.restore(state.predictors);
    work_ = state.work;
  }
  /// Begins with what another run learnt, as aged by the caller, and widens it by what the bias
  /// changes by while the power is off.
  /// @param ticks since its newest measurement
  /// @param learnt arguments of AxisPredictors::resume(): a filter and its drive scale, or biases
  template <class... Learnt>
  void resume(TickInputs inputs, std::uint32_t ticks, float white_level, const Learnt&... learnt) {
    inputs_.resume(inputs);
    white_.set_reference(white_level);
    predictors_.resume(learnt...);
    pass_pause(ticks, true);
  }
  /// Ages what is known by a pause, and predicts anew.
  /// @param ticks ticks of the pause that the stamps of the samples do not contain
  /// @param has_lost_power whether the sensor was without power, which may change its bias
  constexpr void pass_pause(std::uint32_t ticks, bool has_lost_power) {
    finish();
    predictors_.pass_pause(Transition{params_.model.modes.over(ticks)},
                           has_lost_power ? params_.turn_on_variance_or_widest() : -1.0F);
    lead_.ticks = 0;
    work_.is_stale = true;
    finish();
  }

  /// A tick begins, for which something is to be predicted. After a gap the older prediction has no
  /// interval: that would be too narrow.
  constexpr void begin_tick(std::uint32_t tick) {
    if (tick > tick_ + 1) {
      for (core::Prediction& one : predicted_)
        one.variance_rad2_s2 = core::Prediction{}.variance_rad2_s2;
    }
    tick_ = tick;
    work_.is_stale = true;
  }
  /// Question about the integral of the bias over the newest ticks, that of begin_tick() included,
  /// to be asked before the steps of that tick; and its answer.
  [[nodiscard]] constexpr DriveIntegral<kAxes>& drive() { return work_.drive; }
  /// The samples of that tick begin, which are screened by the newest prediction.
  constexpr void begin_samples() {
    screening_.begin_tick(predicted_, white_.model_level() * params_.model.white_variance_rad2_s2,
                          params_.model.measurement_floor_variance_rad2_s2);
  }
  /// A sample at standstill.
  /// @return whether it may be learnt from
  [[nodiscard]] constexpr bool take(const Rates& rate_rad_s) { return screening_.take(rate_rad_s); }
  /// The vehicle moves.
  constexpr void end_stop() { screening_.end_stop(); }
  /// Measurement of the tick that is over, from the mean of its samples.
  [[nodiscard]] constexpr Tick measurement(const core::TickMean<kAxes>& mean) const {
    return {mean, false, false, false, inputs_.measurement(), screening_.squares()};
  }

  /// Begins to learn from a tick. It shows in the prediction of the next tick that begins.
  /// @param sway_variance_rad2_s2 of the error of the mean of a vehicle that sways
  /// @pre !is_learning(), and the tick is later than the measurement before
  constexpr void learn(const Tick& tick, float sway_variance_rad2_s2 = 0.0F) {
    ZERORATE_ASSERT(!is_learning());
    if (work_.stage != Stage::idle) lead_.ticks = 0;  // it may not be complete
    work_.tick = tick;
    work_.sway_variance_rad2_s2 = tick.is_sway ? sway_variance_rad2_s2 : 0.0F;
    work_.go_to(Stage::begin);
  }
  [[nodiscard]] constexpr bool is_learning() const {
    return work_.stage != Stage::idle && work_.stage < Stage::lead;
  }
  /// Whether a measurement or a prediction is not complete.
  [[nodiscard]] constexpr bool is_busy() const {
    return work_.stage != Stage::idle || work_.is_stale;
  }

  /// Cost of the next step.
  [[nodiscard]] constexpr std::uint32_t next_cost() const {
    const bool is_unit_changed = work_.stage == Stage::advance && work_.unit_factor != 1.0F;
    const bool makes_lead = work_.stage == Stage::lead || work_.stage == Stage::approach;
    const Stage stage = work_.stage == Stage::idle ? Stage::lead : work_.stage;
    return Costs::of_step(stage, work_.item == 0, makes_lead ? lead_.ticks : work_.span.ticks) +
           (is_unit_changed ? 1U : 0U);
  }
  /// Does one step, if there is one.
  constexpr void step() {
    switch (work_.stage) {
      case Stage::idle:
        if (!work_.is_stale) return;
        work_.go_to(Stage::lead);
        return step_lead();
      case Stage::begin:
        return step_begin();
      case Stage::span:
        params_.model.modes.make_piece(work_.item, work_.span);
        return work_.next(kPieces, Stage::advance);
      case Stage::advance:
        return step_advance();
      case Stage::compare:
        return work_.go_to(predictors_.compare(work_.measurement, work_.tick, work_.span)
                               ? Stage::learn
                               : Stage::rest);
      case Stage::learn:
        predictors_.learn(work_.item, work_.measurement);
        return work_.next(count(), Stage::conclude);
      case Stage::conclude:
        predictors_.bank().conclude();
        return work_.go_to(predictors_.learns() ? Stage::weigh : Stage::rest);
      case Stage::weigh:
        predictors_.bank().weigh(work_.item);
        return work_.next(kAxes, Stage::rest);
      case Stage::rest:
        return step_rest();
      case Stage::lead:
        return step_lead();
      case Stage::window:
        params_.model.modes.make_piece(work_.item, work_.span);
        return work_.next(kPieces, Stage::predict);
      case Stage::predict:
        return step_predict();
      default:
        return DriveIntegralSteps<TickNode>{params_, predictors_, lead_, work_}.step();
    }
  }
  /// Completes what was begun.
  constexpr void finish() {
    while (is_busy()) step();
  }
  /// Learns from a tick at once.
  /// @return the innovations of the bank
  constexpr const typename Predictors::Innovations& learn_at_once(
      const Tick& tick, float sway_variance_rad2_s2 = 0.0F) {
    learn(tick, sway_variance_rad2_s2);
    while (is_learning()) step();
    return work_.measurement.innovations;
  }

  /// Biases of the axes by the published predictor, as far as the steps have come.
  [[nodiscard]] constexpr const Predictions& predicted() const { return predicted_; }
  [[nodiscard]] constexpr std::uint32_t tick() const { return tick_; }
  /// Ticks up to and with the newest one that has been learnt from.
  [[nodiscard]] constexpr std::uint32_t measured_ticks() const { return measured_ticks_; }
  /// Ticks from the newest measurement to the end of the one being filled.
  [[nodiscard]] constexpr std::uint32_t ticks_since_measured() const {
    return tick_ + 1 - measured_ticks_;
  }
  [[nodiscard]] constexpr const Params& params() const { return params_; }
  [[nodiscard]] constexpr const core::EarthRate& earth() const {
    return earth_.shares(params_.earth);
  }
  constexpr void set_earth(const core::EarthRate& earth) { earth_.measured = earth; }
  [[nodiscard]] constexpr const Predictors& predictors() const { return predictors_; }
  [[nodiscard]] constexpr const Screening& screening() const { return screening_; }
  [[nodiscard]] constexpr const WhiteLevel& white() const { return white_; }
  [[nodiscard]] constexpr WhiteLevel& white() { return white_; }
  /// Temperature and acceleration, to be fed with every sample.
  [[nodiscard]] constexpr InputTrack& inputs() { return inputs_; }
  [[nodiscard]] constexpr const InputTrack& inputs() const { return inputs_; }
  [[nodiscard]] constexpr Levels levels() const {
    return {.white = white_.reference(), .drive = predictors_.drive_memory()};
  }
  /// Span from the newest measurement to the end of the tick being filled; 0 ticks: not made.
  [[nodiscard]] constexpr const Transition& lead() const { return lead_; }
  [[nodiscard]] constexpr const Work& work() const { return work_; }

  /// Variance of the white noise of a sample, as learnt.
  [[nodiscard]] constexpr float white_variance_rad2_s2(std::size_t axis) const {
    const float model = params_.model.white_variance_rad2_s2;
    if (!predictors_.learns()) return white_.level() * model;
    return white_.change() * model *
           predictors_.bank().expected(axis, 1.0F,
                                       [](const auto& /*one*/, float scale) { return scale; });
  }

 private:
  [[nodiscard]] constexpr std::size_t count() const { return predictors_.bank().count(); }
  /// Variances of the white noise of the mean, and the unit that the bank's variances are to have.
  constexpr void prepare_measurement() {
    const core::NodeModel<Shape>& model = params_.model;
    const float averaged = model.white_variance_rad2_s2 / static_cast<float>(work_.tick.samples);
    const float sway = work_.sway_variance_rad2_s2;
    const float floor = model.measurement_floor_variance_rad2_s2 + sway;
    work_.unit_factor = 1.0F;
    work_.begins_to_learn = false;
    if (predictors_.learns() && white_.is_to_rebase()) {
      work_.begins_to_learn = white_.reference() == 0.0F;
      work_.unit_factor = white_.rebase();
      if (work_.begins_to_learn) predictors_.bank().start_learning(white_.reference());
    }
    const float level = white_.level();
    work_.measurement = {
        .rate_rad_s = work_.tick.rate_rad_s,
        .white_of_bank = (predictors_.learns() ? white_.change() : level) * averaged +
                         model.measurement_floor_variance_rad2_s2 + sway / white_.scale_of_learnt(),
        .white = level * averaged + floor,
        .white_of_model = white_.model_level() * averaged + floor,
        .innovations = {}};
  }

  constexpr void step_begin() {
    const std::uint32_t ticks = work_.tick.tick + 1 - measured_ticks_;
    inputs_.measure(work_.tick.inputs, ticks, work_.span);
    white_.advance(ticks);
    if (!work_.tick.is_sway) white_.observe(work_.tick);
    prepare_measurement();
    predictors_.begin(work_.tick);
    work_.span.ticks = ticks;
    work_.go_to(Stage::span);
    if (ticks != 1) return;
    static_cast<core::TransitionOf<Shape>&>(work_.span) = one_tick_;
    work_.go_to(Stage::advance);
  }
  constexpr void step_advance() {
    const std::size_t m = work_.item;
    if (work_.unit_factor != 1.0F) {
      if (work_.begins_to_learn) {
        predictors_.bank().change_unit(m, work_.unit_factor);
      } else {
        predictors_.bank().rescale(m, work_.unit_factor);
      }
    }
    predictors_.bank().advance(m, work_.span);
    work_.next(count(), Stage::compare);
    if (work_.stage == Stage::compare) measured_ticks_ = work_.tick.tick + 1;
  }
  constexpr void step_rest() {
    predictors_.observe_rest(work_.span, work_.measurement);
    if constexpr (Capacity.screens_samples) {
      white_.observe_squares(work_.tick.squares.rad2_s2, static_cast<float>(work_.tick.samples));
    }
    work_.go_to(Stage::idle);
  }
  /// Makes the lead piece by piece, unless it is as long as the one before, as in a stop, or one
  /// tick longer.
  constexpr void step_lead() {
    const auto& modes = params_.model.modes;
    const std::uint32_t ticks = ticks_since_measured();
    if (work_.item == 0) {
      work_.is_stale = false;
      if (lead_.ticks == ticks) return finish_lead();
      if (lead_.ticks > 0 && lead_.ticks + 1 == ticks) {
        modes.lengthen(lead_, one_tick_);
        return finish_lead();
      }
      lead_.ticks = ticks;
    }
    modes.make_piece(work_.item, lead_);
    if (++work_.item == kPieces) finish_lead();
  }
  constexpr void finish_lead() {
    inputs_.lead_over(lead_.ticks, lead_);
    work_.mixtures = {};
    work_.span.ticks = predictors_.window(params_.published, lead_);
    work_.go_to(work_.span.ticks > 0 ? Stage::window : Stage::predict);
  }
  constexpr void step_predict() {
    const Stage then = work_.drive.ticks > 0 ? Stage::drive : Stage::idle;
    if (params_.published != Predictor::kalman) {
      predicted_[work_.item] =
          predictors_.predict(params_.published, work_.item, lead_, work_.span);
      return work_.next(kAxes, then);
    }
    const auto forecast = predictors_.bank().forecast();
    forecast.add(work_.mixtures, work_.item, lead_);
    if (++work_.item < count()) return;
    predicted_ = forecast.of(work_.mixtures);
    for (auto& one : predicted_) one.variance_rad2_s2 *= predictors_.drive_scale();
    work_.go_to(then);
  }

  const Params& params_;
  [[no_unique_address]] Earth earth_{};
  core::TransitionOf<Shape> one_tick_;
  [[no_unique_address]] InputTrack inputs_;
  [[no_unique_address]] Screening screening_;
  WhiteLevel white_;
  Predictors predictors_;
  Predictions predicted_{};  ///< predictions of the published predictor
  Transition lead_{};
  Work work_{};
  std::uint32_t tick_ = 0;
  std::uint32_t measured_ticks_ = 0;
};

}  // namespace zerorate::app
