// The node behind its C interface, called with anything in any order: what is published as a rate
// is finite and its deviation no NaN, whatever was fed before.

#include <zerorate.h>

#include <array>
#include <bit>
#include <cmath>

#include "host_tests/fuzz/fuzz.hpp"

namespace {

using namespace zerorate;

zerorate_model good_model(FuzzedDataProvider& input) {
  zerorate_model model{};
  model.sample_period_ns = 10'000'000;
  model.tick_ns = 100'000'000;
  model.starts_stationary = true;
  model.is_stationary = true;
  model.white_variance_rad2_s2 = 1e-6F;
  model.turn_on_variance_rad2_s2 = 1e-8F;
  model.decaying[0] = {
      .one_minus_phi = 0.01F, .noise_variance = 1e-12F, .initial_variance = 5e-11F};
  if (input.ConsumeBool()) {
    model.gate_threshold_sigma = 4.0F;
    model.gate_longest_knock_ticks = 20;
  }
  if (input.ConsumeBool()) {
    model.temperature = {.reference_degc = 25.0F,
                         .slope_sigma_rad_s_per_k = 1e-4F,
                         .curvature_sigma_rad_s_per_k2 = 1e-6F};
  }
  return model;
}

/// Three orders by four strengths of the slow noise.
void add_hypotheses(zerorate_model& model, FuzzedDataProvider& input) {
  model.hypothesis_count = input.ConsumeIntegralInRange<std::uint8_t>(0, ZERORATE_HYPOTHESES);
  model.evidence_kept = 0.999F;
  for (std::size_t m = 0; m < ZERORATE_HYPOTHESES; ++m) {
    zerorate_hypothesis& one = model.hypotheses[m];
    one.level = std::pow(25.0F, static_cast<float>(m % 4U) - 1.5F);
    one.strength[0] = one.level;
    one.order = 0.5F + 0.12F * static_cast<float>(m / 4U);
    one.bias_instability_rad_s = 1e-5F;
    one.angle_random_walk_rad_per_sqrt_s = 1e-4F;
  }
}

/// The good one with figures of any bit pattern: refused, or as good as any other.
zerorate_model some_model(FuzzedDataProvider& input) {
  zerorate_model model = good_model(input);
  if (input.ConsumeBool()) add_hypotheses(model, input);
  const std::array figures{&model.walk_variance_rad2_s2,
                           &model.white_variance_rad2_s2,
                           &model.measurement_floor_variance_rad2_s2,
                           &model.turn_on_variance_rad2_s2,
                           &model.gate_threshold_sigma,
                           &model.decaying[0].one_minus_phi,
                           &model.decaying[0].noise_variance,
                           &model.decaying[0].initial_variance,
                           &model.decaying[0].initial_mean,
                           &model.rotating[0].one_minus_phi.re,
                           &model.rotating[0].one_minus_phi.im,
                           &model.rotating[0].noise_variance,
                           &model.rotating[0].initial_variance,
                           &model.rotating[0].initial_mean,
                           &model.temperature.slope_rad_s_per_k,
                           &model.temperature.slope_sigma_rad_s_per_k,
                           &model.temperature.reference_degc,
                           &model.temperature.curvature_sigma_rad_s_per_k2,
                           &model.temperature.curvature_rad_s_per_k2,
                           &model.temperature.lag_s,
                           &model.evidence_kept,
                           &model.hypotheses[1].strength[0],
                           &model.hypotheses[1].log_prior,
                           &model.hypotheses[1].level,
                           &model.hypotheses[1].order,
                           &model.hypotheses[1].bias_instability_rad_s,
                           &model.hypotheses[1].angle_random_walk_rad_per_sqrt_s};
  for (auto count = input.ConsumeIntegralInRange(0, 3); count > 0; --count) {
    *figures.at(input.ConsumeIntegralInRange<std::size_t>(0, figures.size() - 1)) =
        std::bit_cast<float>(input.ConsumeIntegral<std::uint32_t>());
  }
  if (input.ConsumeIntegralInRange(0, 15) == 0) {
    model.sample_period_ns = input.ConsumeIntegral<std::int64_t>();
    model.tick_ns = input.ConsumeIntegral<std::int64_t>();
  }
  return model;
}

/// Any bit pattern at times, and mostly a rate that a gyro could give.
float some_rate(FuzzedDataProvider& input) {
  if (input.ConsumeIntegralInRange(0, 15) == 0) {
    return std::bit_cast<float>(input.ConsumeIntegral<std::uint32_t>());
  }
  return static_cast<float>(input.ConsumeIntegral<std::int16_t>()) * 1e-4F;
}

zerorate_measurement some_measurement(FuzzedDataProvider& input, std::int64_t time_ns) {
  zerorate_measurement measured{};
  measured.time_ns = time_ns;
  for (float& rate : measured.rate_rad_s) rate = some_rate(input);
  measured.has_temperature = input.ConsumeBool();
  measured.temperature_degc = some_rate(input) * 20.0F;
  measured.saturated_axes = input.ConsumeIntegralInRange<std::uint8_t>(0, 15);
  return measured;
}

void sample(zerorate_node& node, FuzzedDataProvider& input, std::int64_t time_ns) {
  const zerorate_measurement measured = some_measurement(input, time_ns);
  zerorate_rate rate{};
  const bool has_rate = zerorate_sample(&node, &measured, &rate) == ZERORATE_OK;
  for (std::size_t i = 0; i < ZERORATE_AXES; ++i) {
    fuzz::promise(has_rate == std::isfinite(rate.corrected_rad_s[i]), "a rate is finite, or none");
    if (!has_rate) continue;
    fuzz::promise(!std::isnan(rate.sigma_rad_s[i]) && rate.sigma_rad_s[i] >= 0.0F,
                  "a deviation is a number, or infinite");
    fuzz::promise(std::isfinite(rate.bias_rad_s[i]), "a bias is finite");
  }
}

void save_and_restore(zerorate_node& node, const zerorate_model& model,
                      const zerorate_config& config, FuzzedDataProvider& input) {
  std::array<std::uint8_t, ZERORATE_SNAPSHOT_BYTES> record{};
  const auto utc_s = input.ConsumeIntegral<std::int64_t>();
  if (zerorate_save(&node, utc_s, record.data(), record.size()) != ZERORATE_OK) return;
  fuzz::promise(zerorate_init(&node, &model, &config) == ZERORATE_OK, "it can start again");
  fuzz::promise(zerorate_restore(&node, input.ConsumeIntegral<std::int64_t>(), record.data(),
                                 record.size()) == ZERORATE_OK,
                "what a node saved it takes up");
}

void predict(const zerorate_node& node, FuzzedDataProvider& input) {
  zerorate_heading_error error{};
  const auto axis = input.ConsumeIntegralInRange<std::uint8_t>(0, 3);
  const auto samples = input.ConsumeIntegral<std::uint32_t>();
  if (zerorate_predict_heading(&node, axis, samples, &error) != ZERORATE_OK) return;
  fuzz::promise(!std::isnan(error.sigma_rad) && !std::isnan(error.angle_rad),
                "a heading error is a number");
}

std::int64_t some_step_ns(FuzzedDataProvider& input) {
  switch (input.ConsumeIntegralInRange(0, 31)) {
    case 0:
      return input.ConsumeIntegral<std::int32_t>();
    case 1:
      return input.ConsumeIntegral<std::int64_t>();
    case 2:
      return 3'600'000'000'000;
    default:
      return 10'000'000;
  }
}

std::int64_t wrapping_sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input(data, size);
  const zerorate_model model = some_model(input);
  zerorate_config config = zerorate_default_config();
  config.predictor = input.PickValueInArray<std::int32_t>(
      {ZERORATE_KALMAN, ZERORATE_MOVING_AVERAGE, ZERORATE_CALIBRATION_MEAN});
  // Chosen by the length, so that the other bytes of the corpus keep their meaning.
  if (size % 8 == 7) config.standstill = ZERORATE_BY_WORD;
  zerorate_node node{};
  if (zerorate_init(&node, &model, &config) != ZERORATE_OK) return 0;
  std::int64_t now_ns = 0;
  while (input.remaining_bytes() > 0) {
    now_ns = wrapping_sum(now_ns, some_step_ns(input));
    switch (input.ConsumeIntegralInRange(0, 15)) {
      case 0:
        (void)zerorate_pulse(&node, now_ns);
        break;
      case 1:
        (void)zerorate_report_odometer_fault(&node, now_ns);
        break;
      case 2:
        (void)zerorate_zero_velocity(&node, now_ns, input.ConsumeBool());
        break;
      case 3:
        save_and_restore(node, model, config, input);
        break;
      case 4:
        predict(node, input);
        break;
      default:
        sample(node, input, now_ns);
        break;
    }
  }
  return 0;
}
