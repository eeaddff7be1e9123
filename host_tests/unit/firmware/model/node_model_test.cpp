#include "firmware/model/node_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <stdexcept>

#include "firmware/model/catalogue.hpp"
#include "firmware/model/model_file.hpp"

namespace zerorate::model {
namespace {

using core::Duration;
constexpr double kPi = std::numbers::pi;
constexpr Duration kSample = Duration::milliseconds(10);
constexpr core::ModelShape kSixDecades{.decaying = 6};
constexpr Duration kTick = Duration::milliseconds(200);
constexpr double kTickS = 0.2;
constexpr double kSampleS = 0.01;

SensorModel white_only(double angle_random_walk) {
  SensorModel model;
  model.name = "test";
  model.white.angle_random_walk_rad_per_sqrt_s = angle_random_walk;
  return model;
}

/// The physical two-sided spectrum (per Hz) that the model file's documentation promises.
double physical_spectrum(const SensorModel& model, double nu_hz) {
  const double w = 2.0 * kPi * nu_hz;
  double s = std::pow(model.white.angle_random_walk_rad_per_sqrt_s, 2);
  if (model.flicker) {
    s += std::pow(model.flicker->bias_instability_rad_s, 2) *
         std::pow(w, -2.0 * model.flicker->order);
  }
  if (model.rate_random_walk) {
    s += std::pow(model.rate_random_walk->coefficient_rad_s_per_sqrt_s / w, 2);
  }
  for (const GaussMarkov& process : model.gauss_markov) {
    const double tau = process.time_constant_s;
    s += 2.0 * std::pow(process.sigma_rad_s, 2) * tau / (1.0 + std::pow(w * tau, 2));
  }
  for (const Harmonic& line : model.harmonic) {
    for (const double sign : {-1.0, 1.0}) {
      const double tau = line.coherence_time_s;
      const double away = (w + sign * 2.0 * kPi * line.frequency_hz) * tau;
      s += std::pow(line.rms_rad_s, 2) * tau / (1.0 + away * away);
    }
  }
  return s;
}

/// Spectrum of the bias in the model of the node's filter, from its coefficients.
template <core::ModelShape Shape>
double believed_spectrum(const NodeModel<Shape>& node, double nu_hz) {
  using Complex = std::complex<double>;
  const double w = 2.0 * kPi * nu_hz * kTickS;
  const auto gain = [](Complex factor, double at) {
    return 1.0 / std::norm(1.0 - factor * std::polar(1.0, -at));
  };
  double per_tick = static_cast<double>(node.white_variance_rad2_s2) * kSampleS / kTickS;
  per_tick += static_cast<double>(node.modes.walk_variance) * gain(1.0, w);
  for (const auto& mode : node.modes.decaying) {
    per_tick += static_cast<double>(mode.noise_variance) *
                gain(1.0 - static_cast<double>(mode.one_minus_phi), w);
  }
  for (const auto& mode : node.modes.rotating) {
    const Complex factor(1.0 - static_cast<double>(mode.one_minus_phi.re),
                         -static_cast<double>(mode.one_minus_phi.im));
    per_tick += static_cast<double>(mode.noise_variance) *
                (gain(factor, w) + gain(std::conj(factor), w)) / 2.0;
  }
  return per_tick * kTickS;
}

void expect_same_spectrum(const SensorModel& model, double lowest_hz, double tolerance) {
  const auto node = make_node_model<kLargestShape>(model, kSample, kTick);
  // Sampling folds and a tick's mean smooths: compare well below the tick's 2.5 Hz.
  for (double nu = lowest_hz; nu < 0.08; nu *= 1.1) {
    EXPECT_NEAR(believed_spectrum(node, nu) / physical_spectrum(model, nu), 1.0, tolerance)
        << nu << " Hz";
  }
}

TEST(NodeModelOfWhiteNoise, HasItsVariancePerSample) {
  const auto node = make_node_model<core::ModelShape{}>(white_only(1e-3), kSample, kTick);
  EXPECT_FLOAT_EQ(node.white_variance_rad2_s2, 1e-6F / 0.01F);
  EXPECT_EQ(node.modes.tick, kTick);
}

TEST(NodeModelOfEachNoise, HasThePhysicalSpectrum) {
  SensorModel flicker = white_only(1e-5);
  flicker.flicker = Flicker{.bias_instability_rad_s = 1e-4, .order = 0.6};
  expect_same_spectrum(flicker, 1e-4, 0.07);  // the flicker fit's ripple

  SensorModel walk = white_only(1e-5);
  walk.rate_random_walk = RateRandomWalk{.coefficient_rad_s_per_sqrt_s = 1e-5};
  expect_same_spectrum(walk, 1e-4, 0.002);

  SensorModel markov = white_only(1e-5);
  markov.gauss_markov = {{.sigma_rad_s = 1e-4, .time_constant_s = 50.0},
                         {.sigma_rad_s = 2e-4, .time_constant_s = 400.0}};
  expect_same_spectrum(markov, 1e-4, 0.002);

  SensorModel line = white_only(1e-5);
  line.harmonic = {{.rms_rad_s = 1e-4, .frequency_hz = 0.03, .coherence_time_s = 100.0},
                   {.rms_rad_s = 1e-4, .frequency_hz = 0.05, .coherence_time_s = 60.0}};
  expect_same_spectrum(line, 1e-3, 0.002);
}

TEST(NodeModelOfAQuantizer, AveragesTheErrorOverTheSteps) {
  constexpr double kStep = 1e-2;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> rate(0.0, 1.0);
  for (const double sigma_in_steps : {0.05, 0.2, 0.3, 1.0}) {
    const double sigma = sigma_in_steps * kStep;
    SensorModel model = white_only(sigma * std::sqrt(kSampleS));
    model.quantization = Quantization{.step_rad_s = kStep};
    const auto node = make_node_model<core::ModelShape{}>(model, kSample, kTick);
    // The mean of 20 quantized samples about its rate, over all rates within a step.
    std::normal_distribution<double> white(0.0, sigma);
    double squares = 0.0;
    constexpr int kTrials = 20'000;
    for (int trial = 0; trial < kTrials; ++trial) {
      const double x = rate(random);
      double sum = 0.0;
      for (int i = 0; i < 20; ++i) sum += kStep * std::round(x + white(random) / kStep) - kStep * x;
      squares += sum * sum / 400.0;
    }
    // A mean of squares of bounded or normal deviations: relative standard error below sqrt(2 / n).
    EXPECT_NEAR(double{node.measurement_variance(20.0F)} / (squares / kTrials), 1.0,
                4.0 * std::sqrt(2.0 / kTrials))
        << sigma_in_steps;
  }
}

TEST(NodeModelOfTransients, StartsApartFromItsStationaryState) {
  SensorModel model = find_model("adis16405");
  EXPECT_TRUE(fits_six_decades(model));
  EXPECT_TRUE((make_node_model<kSixDecades>(model, kSample, kTick)).modes.is_stationary);
  model.warm_up =
      WarmUp{.amplitude_rad_s = 1e-3, .amplitude_sigma_rad_s = 0.0, .time_constant_s = 600.0};
  model.rate_ramp = RateRamp{.slope_rad_s2 = 0.0, .slope_sigma_rad_s2 = 1e-8};
  EXPECT_FALSE(fits_six_decades(model));
  const auto node = make_node_model<core::ModelShape{.decaying = 8}>(model, kSample, kTick);
  EXPECT_FALSE(node.modes.is_stationary);
  EXPECT_FLOAT_EQ(node.modes.decaying[6].initial_mean, 1e-3F);
  EXPECT_NEAR(node.modes.decaying[6].one_minus_phi, 0.2F / 600.0F, 1e-7F);
  EXPECT_GT(node.modes.decaying[7].initial_variance, 0.0F);
}

TEST(NodeModelOfAGate, CountsTheLongestKnockInTicks) {
  SensorModel model = find_model("adis16405");
  model.gate = Gate{.threshold_sigma = 4.5, .longest_knock_s = 3.1};
  const auto node = make_node_model<kSixDecades>(model, kSample, kTick);
  EXPECT_EQ(node.gate.threshold_sigma, 4.5F);
  EXPECT_EQ(node.gate.longest_knock_ticks, 16);
  EXPECT_FALSE(
      (make_node_model<kSixDecades>(find_model("adis16405"), kSample, kTick)).gate.is_on());
}

TEST(NodeModelOfTheCatalogue, FitsANodeOfSixDecades) {
  for (const CatalogueEntry& entry : catalogue()) {
    const SensorModel model = find_model(entry.name);
    const auto node = make_node_model<kSixDecades>(model, kSample, Duration::milliseconds(100));
    EXPECT_GT(node.white_variance_rad2_s2, 0.0F) << entry.name;
    EXPECT_EQ(node.modes.start, model.node.start);
  }
}

TEST(NodeModelThatStartsAtZero, HasNoInitialVariance) {
  SensorModel model = find_model("adis16405");
  const auto stationary = make_node_model<kSixDecades>(model, kSample, kTick);
  model.node.start = core::Start::zero;
  const auto zero = make_node_model<kSixDecades>(model, kSample, kTick);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(zero.modes.decaying[i].initial_variance, 0.0F);
    EXPECT_EQ(zero.modes.decaying[i].noise_variance, stationary.modes.decaying[i].noise_variance);
  }
  EXPECT_GT(stationary.modes.decaying[5].initial_variance, 0.0F);
}

TEST(NodeModelTooLargeForTheNode, IsRefusedWithBothSizes) {
  SensorModel model = find_model("adis16405");
  model.gauss_markov = {{.sigma_rad_s = 1e-4, .time_constant_s = 50.0}};
  EXPECT_NO_THROW((void)(make_node_model<core::ModelShape{.decaying = 7}>(model, kSample, kTick)));
  try {
    (void)make_node_model<kSixDecades>(model, kSample, kTick);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "the model \"Analog Devices ADIS16405\" needs 7 decaying and 0 rotating modes; "
                 "this node has 6 and 0");
  }
}

TEST(NodeModelThatFollowsTheTemperature, NeedsANodeThatDoes) {
  SensorModel model = find_model("adis16405");
  model.temperature = TemperatureDrift{.reference_degc = 30.0, .slope_sigma_rad_s_per_k = 1e-3};
  EXPECT_FALSE(fits_six_decades(model));
  const auto node =
      make_node_model<core::ModelShape{.decaying = 6, .inputs = 2}>(model, kSample, kTick);
  EXPECT_EQ(node.inputs.reference_degc, 30.0F);
  EXPECT_EQ(node.inputs.terms[0].input, core::Input::temperature);
  EXPECT_EQ(node.inputs.terms[0].sigma, 1e-3F);
  EXPECT_THROW((void)(make_node_model<kSixDecades>(model, kSample, kTick)), std::invalid_argument);
}

TEST(InputIgnoredWithoutAccelerometer, CountsWhereOneIsRead) {
  SensorModel model = find_model("lsm6dso");
  model.inputs = {{.quantity = InputQuantity::vibration,
                   .without_accelerometer = WithoutAccelerometer::ignore,
                   .sigma_rad_s_per_unit = 1e-3}};
  constexpr core::ModelShape kBlind{.decaying = 6, .inputs = 1};
  constexpr core::ModelShape kSeeing = with_accelerometer(kBlind);
  EXPECT_EQ(count_inputs(make_node_model<kBlind>(model, kSample, kTick).inputs), 0U);
  EXPECT_EQ(count_inputs(make_node_model<kSeeing>(model, kSample, kTick).inputs), 1U);
  const auto room_for_inputs = [&](bool has_accelerometer) {
    return with_shape_of<kLargestShape>(model, has_accelerometer,
                                        []<core::ModelShape Shape>() { return Shape.inputs; });
  };
  EXPECT_EQ(room_for_inputs(false), 0U);
  EXPECT_EQ(room_for_inputs(true), kWidestShape.inputs);
}

TEST(InputOfTheTemperature, DependsOnNoAccelerometer) {
  SensorModel model = find_model("lsm6dso");
  model.inputs = {{.quantity = InputQuantity::temperature_rate,
                   .without_accelerometer = WithoutAccelerometer::ignore,
                   .sigma_rad_s_per_unit = 1e-3}};
  EXPECT_THROW((void)make_full_node_model(model, kSample, kTick), std::invalid_argument);
}

TEST(NodeModelOfImpossibleInput, IsRefused) {
  const SensorModel model = find_model("adis16405");
  const auto make = [](const SensorModel& m, Duration sample, Duration tick) {
    (void)make_full_node_model(m, sample, tick);
  };
  EXPECT_THROW(make(model, Duration{}, kTick), std::invalid_argument);
  EXPECT_THROW(make(model, kTick, kSample), std::invalid_argument);
  EXPECT_THROW(make(white_only(0.0), kSample, kTick), std::invalid_argument);
  EXPECT_THROW(make(white_only(-1.0), kSample, kTick), std::invalid_argument);
  EXPECT_THROW(make(white_only(1e-30), kSample, kTick), std::invalid_argument);
  EXPECT_THROW(make(white_only(1e30), kSample, kTick), std::invalid_argument);
  SensorModel loud = model;
  loud.gauss_markov = {{.sigma_rad_s = 1e25, .time_constant_s = 1.0}};
  EXPECT_THROW(make(loud, kSample, kTick), std::invalid_argument);
  SensorModel many = model;
  many.gauss_markov.resize(3, {.sigma_rad_s = 1.0, .time_constant_s = 1.0});
  EXPECT_THROW(make(many, kSample, kTick), std::invalid_argument);
}

}  // namespace
}  // namespace zerorate::model
