// Ten minutes of a gyro that lies still, and what the node makes of them.

#include <cstdio>

#include "firmware/app/gyro_node.hpp"

namespace {

using namespace zerorate;

// A model as `zerorate export --cpp` writes it, with one mode of slow noise: a Gauss-Markov
// process of 5 s, of 2e-5 rad/s (4 deg/h), at ticks of half a second.
constexpr app::NodeParams<core::ModelShape{.decaying = 1}> kParams{
    .model = {.modes = {.tick = core::Duration::milliseconds(500),
                        .is_stationary = true,
                        .decaying = {{{.one_minus_phi = 0.0951626F,
                                       .noise_variance = 7.25e-11F,
                                       .initial_variance = 4e-10F}}}},
              .white_variance_rad2_s2 = 2.4e-7F,
              .sample_period = core::Duration::milliseconds(10)}};

}  // namespace

int main() {
  app::GyroNode<core::ModelShape{.decaying = 1}> node{kParams};
  app::RateMessage newest;
  for (int i = 0; i < 60'000; ++i) {
    core::GyroSample sample;
    sample.time = core::Instant{} + kParams.model.sample_period * i;
    sample.rate.fill(core::deg_per_s(0.002F));
    newest = node.step(sample);  // node.pulse(when) for each pulse of the odometer
  }
  std::printf("bias %.4f +- %.4f deg/s\n",
              static_cast<double>(newest.axes[2].bias.in(core::deg_per_s)),
              static_cast<double>(newest.axes[2].sigma.in(core::deg_per_s)));
  return newest.health.calibrated ? 0 : 1;
}
