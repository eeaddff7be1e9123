// Every driver with its chip behind a bus that lies: errors, and bytes that the chip never sent.
// Whatever comes, samples are finite, no more than asked for, and in the order of time.

#include <array>
#include <cmath>

#include "host_tests/fuzz/fuzz.hpp"
#include "host_tests/support/gyro_rig.hpp"
#include "host_tests/support/simulated_accelerometers.hpp"

namespace {

using namespace zerorate;
using hal::testing::Fault;

constexpr std::array kErrors{hal::BusError::nack, hal::BusError::timeout, hal::BusError::io};
constexpr std::size_t kMostCalls = 400;

template <class Rig>
void tell_lies(Rig& rig, FuzzedDataProvider& input) {
  const auto faults = input.ConsumeIntegralInRange<int>(0, 8);
  for (int i = 0; i < faults; ++i) {
    rig.faults.inject({.kind = static_cast<Fault::Kind>(input.ConsumeIntegralInRange(0, 4)),
                       .first = input.ConsumeIntegralInRange<std::size_t>(0, kMostCalls),
                       .calls = input.ConsumeIntegralInRange<std::size_t>(1, 20),
                       .error = input.PickValueInArray(kErrors),
                       .bit = input.ConsumeIntegralInRange<std::size_t>(0, 127)});
  }
}

template <class Rig>
core::Instant take_samples(Rig& rig, core::Instant last) {
  std::array<core::GyroSample, 8> out{};
  const auto count = rig.read(out);
  if (!count) return last;
  fuzz::promise(*count <= out.size(), "no more samples than there is room for");
  for (const core::GyroSample& sample : std::span{out}.first(*count)) {
    fuzz::promise(sample.time > last, "samples come in the order of time");
    fuzz::promise(sample.time <= rig.clock.now(), "no sample is of the future");
    for (const core::AngularRate rate : sample.rate) {
      fuzz::promise(std::isfinite(rate.in(core::rad_per_s)), "every rate is finite");
    }
    for (const core::Acceleration force : sample.acceleration) {
      fuzz::promise(std::isfinite(force.in(core::m_per_s2)), "every acceleration is finite");
    }
    last = sample.time;
  }
  return last;
}

template <class Wiring>
void run(FuzzedDataProvider& input) {
  using Gyro = typename Wiring::Gyro;
  auto settings = Gyro::kDataReady;
  if constexpr (requires { Gyro::kFifo; }) {
    if (input.ConsumeBool()) settings = Gyro::kFifo;
  }
  support::GyroRig<Wiring> rig(settings);
  tell_lies(rig, input);
  auto last = core::Instant::from_ns(-1);
  bool is_started = rig.start().has_value();
  while (input.remaining_bytes() > 0 && rig.faults.calls() < kMostCalls) {
    const auto what = input.ConsumeIntegral<std::uint8_t>();
    if (!is_started) {
      is_started = rig.start().has_value();
    } else if (what < 150) {
      rig.sample({core::deg_per_s(1.0F), core::deg_per_s(-2.0F), core::deg_per_s(3.0F)});
      last = take_samples(rig, last);
    } else if (what < 200) {
      is_started = rig.driver.verify_next().has_value();
    } else if (what < 225) {
      rig.chip.upset(input.ConsumeIntegralInRange<std::uint8_t>(0, 17),
                     input.ConsumeIntegral<std::uint8_t>());
    } else {
      rig.chip.cycle_power();
    }
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace zerorate::support;
  FuzzedDataProvider input(data, size);
  constexpr int kWirings = WiringsWithFifo::kSize + WiringsWithoutFifo::kSize +
                           WiringsWithAcceleration::kSize + WiringsWithAccelerationAlone::kSize;
  int left = input.ConsumeIntegralInRange<int>(0, kWirings - 1);
  const auto run_chosen = [&]<class Wiring> {
    if (left-- == 0) run<Wiring>(input);
  };
  WiringsWithFifo::for_each(run_chosen);
  WiringsWithoutFifo::for_each(run_chosen);
  WiringsWithAcceleration::for_each(run_chosen);
  WiringsWithAccelerationAlone::for_each(run_chosen);
  return 0;
}
