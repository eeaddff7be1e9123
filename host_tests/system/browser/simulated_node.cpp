// simulated_node PORT
//
// zerorated's service on a simulated gyro that stands, drives and stands again, ten times as fast
// as the clock. Sends its frames to 127.0.0.1:PORT until it is told to end, three minutes at most.

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <random>
#include <thread>

#include "firmware/boards/linux/node_service.hpp"
#include "host_tests/unit/firmware/boards/linux/simulated_hardware.hpp"

namespace {

using namespace zerorate;

volatile std::sig_atomic_t is_ended = 0;

void run(std::uint16_t port) {
  constexpr int kSamplesASecond = 104;
  constexpr int kCycle_s = 45;  // two thirds of it at rest
  linux_node::Configuration configuration =
      linux_node::parse_configuration(linux_node::kMinimalConfiguration, "simulated");
  configuration.sinks.emplace_back(linux_node::UdpSettings{"127.0.0.1", port});
  linux_node::SimulatedHardware hardware;
  linux_node::NodeService service{configuration, hardware, nullptr, app::Session{'s'},
                                  [](std::string_view) {}};
  std::mt19937_64 random{1};
  std::normal_distribution<float> noise_dps{0.0F, 0.03F};
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes{3};
  for (int sample = 1; is_ended == 0 && std::chrono::steady_clock::now() < end; ++sample) {
    hardware.is_moving = sample / kSamplesASecond % kCycle_s >= kCycle_s * 2 / 3;
    hardware.rate = core::deg_per_s(0.35F + noise_dps(random));
    service.measure();
    service.publish_waiting();
    if (sample % kSamplesASecond == 0) (void)service.tick();
    if (sample % 10 == 0) std::this_thread::sleep_for(std::chrono::milliseconds{10});
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  for (const int which : {SIGINT, SIGTERM}) {
    (void)std::signal(which, [](int) { is_ended = 1; });
  }
  run(static_cast<std::uint16_t>(std::atoi(argv[1])));
  return 0;
}
