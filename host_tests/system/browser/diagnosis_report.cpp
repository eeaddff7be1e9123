/// Writes the report of a diagnosis: a simulated sensor that warms up and has a few wild samples.
///
///     report_diagnosis OUT.html

#include <cstdio>
#include <exception>
#include <vector>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/diagnose/presentation/report.hpp"

namespace zerorate::diagnose {
namespace {

report::Report diagnosis_report() {
  constexpr std::size_t kSamples = 20'000;
  const std::vector<simulate::Effect> effects{
      simulate::WarmUpTransient{.amplitude_rad_s = 2e-3, .time_constant_s = 150.0},
      simulate::Outliers{.sigma_rad_s = 0.03, .probability = 1e-3}};
  const simulate::Signal signal = simulate::simulate(testing::simulate_rest({}, kSamples, 0.1, 1),
                                                     effects, random::RandomStream(1));
  const std::vector diagnoses{diagnose(record_of(testing::rest_samples_of(signal), 0))};
  return make_report(diagnoses, {.title = "Diagnosis of rest.csv.gz",
                                 .recording = "rest.csv.gz",
                                 .provenance = "zerorate, diagnosis report, run 1"});
}

}  // namespace
}  // namespace zerorate::diagnose

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: report_diagnosis OUT.html\n", stderr);
    return 2;
  }
  try {
    zerorate::diagnose::diagnosis_report().write(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "report_diagnosis: %s\n", error.what());
    return 1;
  }
}
