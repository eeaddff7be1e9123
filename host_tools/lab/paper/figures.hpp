/// @file
/// The paper's figures: Allan deviations (1) and example runs (2 and 3).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_tools/lab/paper/measured_sets.hpp"
#include "host_tools/lab/paper/table1.hpp"
#include "host_tools/lib/identify/allan_deviation.hpp"

namespace zerorate::paper {

struct AllanCurve {
  std::string name;
  std::vector<identify::AllanPoint> points;  ///< deg/h
};

/// Figure 1: the paper's temperature-controlled gyro, simulated with the noise that section V-B
/// states (sqrt(r) = 45 deg/h, s_f = 14 deg/h; 1 s between samples is assumed), the same gyro with
/// a rate random walk that lifts its curve beyond 4000 s, 10^6 samples each; and every axis of the
/// recordings.
[[nodiscard]] std::vector<AllanCurve> make_figure1(const std::vector<RestRecording>& recordings,
                                                   std::uint64_t seed);

/// One set and what the predictors made of it.
struct ExampleRun {
  struct Prediction {
    std::string name;
    std::vector<double> bias;   ///< one a sample of the prediction phase
    std::vector<double> sigma;  ///< sigma of a raw sample
    double integrated_error = 0.0;
    double rsse = 0.0;
  };

  std::string source;  ///< origin of the samples
  std::string unit;    ///< unit of the samples; empty for the simulation, like in the paper
  double sample_period_s = 1.0;
  Lengths lengths;
  std::vector<double> samples;
  std::vector<Prediction> predictions;
};

/// Figure 2: simulated as in Table I, with a constant bias. The paper takes 2400 samples.
[[nodiscard]] ExampleRun make_figure2(const SimulationOptions& options);

/// Figure 3: samples of a recording's last axis, from the middle of the recording on, with the
/// noise fitted on the next recording of the list. Throws std::invalid_argument if there are fewer
/// than two recordings, of one rate and long enough, with detectable 1/f noise.
[[nodiscard]] ExampleRun make_figure3(const std::vector<RestRecording>& recordings,
                                      const MeasuredOptions& options);

}  // namespace zerorate::paper
