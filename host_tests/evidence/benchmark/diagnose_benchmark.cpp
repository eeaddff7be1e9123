/// @file
/// How long a diagnosis takes, how that grows with the length, and how much memory it needs. One
/// axis; a recording of three takes three times as long, in the same memory. The argument is the
/// number of samples; those beyond DiagnoseOptions::most_samples are left out by the diagnosis.

#include <benchmark/benchmark.h>
#include <malloc.h>

#include <fstream>
#include <string>
#include <string_view>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"

namespace {

using namespace zerorate;

/// Plain noise, or noise with a line and a random walk: what is found is fitted again.
diagnose::Record record_of_length(std::size_t samples, bool with_effects) {
  auto signal = testing::simulate_rest({}, samples, 0.01, samples);
  if (with_effects) {
    const std::vector<simulate::Effect> effects{
        simulate::PeriodicDisturbance{.amplitude_rad_s = 1e-3, .frequency_hz = 7.3},
        simulate::RateRandomWalk{.rate_random_walk_rad_s_rt_s = 5e-5}};
    signal = simulate::simulate(std::move(signal), effects, random::RandomStream(3));
  }
  return diagnose::record_of(testing::rest_samples_of(signal), 0);
}

/// Gives back what the allocator kept and lets the kernel forget the greatest size of this process
/// so far, so that no length tells of the one before (proc(5), clear_refs). The record counts.
void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

double peak_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024.0;
  }
  return 0.0;
}

void diagnosis(benchmark::State& state, bool with_effects) {
  const auto record = record_of_length(static_cast<std::size_t>(state.range(0)), with_effects);
  forget_peak();
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(diagnose::diagnose(record));
  }
  state.counters["peak_MiB"] = peak_mib();
  state.SetComplexityN(state.range(0));
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  // `--short`, after the options of the library, runs only the short ones: that is the test.
  const bool is_short = argc > 1 && std::string_view(argv[1]) == "--short";
  for (const bool with_effects : {false, true}) {
    auto* family = benchmark::RegisterBenchmark(with_effects ? "with_effects" : "plain", diagnosis,
                                                with_effects);
    family->Unit(benchmark::kMillisecond)->Iterations(1)->Complexity();
    for (const std::int64_t samples : {1'000, 5'000, 20'000, 65'536, 250'000, 1'000'000}) {
      if (!is_short || samples <= 20'000) family->Arg(samples);
    }
    if (!is_short && !with_effects) family->Arg(10'000'000);  // beyond the bound
  }
  benchmark::RunSpecifiedBenchmarks();
}
