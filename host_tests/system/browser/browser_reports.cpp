// Writes the reports that the browser tests look at.
//
// usage: browser_reports sample|sparse|diagnosis OUT.html

#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/diagnose/presentation/presentation.hpp"
#include "host_tools/lib/report/report.hpp"

namespace zerorate::report {
namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

/// A rate with a wandering bias, as a gyro at rest gives it, with a transmission gap in the middle.
struct Recording {
  std::vector<double> time_s, raw, corrected, bias, estimate, lo, hi;
};

Recording make_recording(std::size_t samples) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  Recording r;
  double bias = 12;
  double estimate = 0;
  double variance = 60;
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = 0.01 * static_cast<double>(i);
    bias += 0.01 * normal(generator);
    const bool lost = i > samples * 2 / 5 && i < samples * 21 / 50;
    const double raw = bias + 9 * normal(generator);
    variance = variance * 0.999 + 0.004;
    estimate += 0.002 * (raw - estimate);
    const double sigma = std::sqrt(variance);
    r.time_s.push_back(t);
    r.raw.push_back(lost ? kGap : raw);
    r.corrected.push_back(lost ? kGap : raw - estimate);
    r.bias.push_back(bias);
    r.estimate.push_back(estimate);
    r.lo.push_back(estimate - 1.96 * sigma);
    r.hi.push_back(estimate + 1.96 * sigma);
  }
  return r;
}

Chart rate_chart(const Recording& r) {
  Chart chart{
      .title = "Raw and corrected rate.",
      .caption = "Every sample of three hours; the envelope is exact, however dense the points.",
      .x = {.label = "Time", .unit = "s"},
      .y = {.label = "Rate", .unit = "deg/h"},
      .series = {{.name = "raw", .x = r.time_s, .y = r.raw, .colour = Colour::grey},
                 {.name = "corrected", .x = r.time_s, .y = r.corrected, .colour = Colour::blue}},
      .shaded_name = "standstill"};
  for (double from = 0; from < r.time_s.back(); from += 1800) {
    chart.shaded.push_back({from, from + 420});
  }
  return chart;
}

Chart bias_chart(const Recording& r) {
  return {
      .title = "Bias and its 95 % interval.",
      .caption =
          "The truth, which only a simulation knows, should leave the band one time in "
          "twenty.",
      .x = {.label = "Time", .unit = "s"},
      .y = {.label = "Bias", .unit = "deg/h"},
      .series = {
          {.name = "predicted, with 95 % interval",
           .x = r.time_s,
           .y = r.estimate,
           .colour = Colour::blue,
           .lo = r.lo,
           .hi = r.hi},
          {.name = "truth", .x = r.time_s, .y = r.bias, .colour = Colour::ink, .dashed = true}}};
}

Chart allan_chart() {
  Chart chart{.title = "Allan deviation.",
              .caption = "Slope −1/2 is angle random walk, the floor bias instability.",
              .x = {.label = "Cluster time", .unit = "s", .scale = Scale::logarithmic},
              .y = {.label = "Allan deviation", .unit = "deg/h", .scale = Scale::logarithmic}};
  Series measured{.name = "measured", .marks = true};
  Series model{.name = "model", .colour = Colour::ink, .dashed = true};
  for (double tau = 0.01; tau < 2e4; tau *= 1.6) {
    const double deviation = std::sqrt(0.8 / tau + 0.04 + 2e-5 * tau);
    const double spread = deviation * 0.3 * std::sqrt(tau / 2e4);
    model.x.push_back(tau);
    model.y.push_back(deviation);
    measured.x.push_back(tau);
    measured.y.push_back(deviation * (1 + 0.25 * std::sin(tau) * std::sqrt(tau / 2e4)));
    measured.lo.push_back(measured.y.back() - spread);
    measured.hi.push_back(measured.y.back() + spread);
  }
  chart.series = {measured, model};
  return chart;
}

Chart drift_chart() {
  std::mt19937 generator(2);
  std::normal_distribution<double> normal;
  Series kalman{.name = "kalman", .style = SeriesStyle::points, .colour = Colour::blue};
  Series mean{
      .name = "calibration mean", .style = SeriesStyle::points, .colour = Colour::vermilion};
  Series limit{.name = "predicted σ", .style = SeriesStyle::steps, .colour = Colour::ink};
  for (int drive = 1; drive <= 90; ++drive) {
    for (Series* series : {&kalman, &mean, &limit}) series->x.push_back(drive);
    kalman.y.push_back(0.02 * normal(generator));
    kalman.lo.push_back(-0.04);
    kalman.hi.push_back(0.04);
    mean.y.push_back(0.031 * normal(generator));
    limit.y.push_back(0.02 + 0.004 * ((drive / 10) % 3));
  }
  return {.title = "Heading drift of every drive.",
          .caption = "",
          .x = {.label = "Drive", .unit = ""},
          .y = {.label = "Heading drift", .unit = "deg"},
          .series = {kalman, mean, limit}};
}

BarChart ratio_chart() {
  return {.title = "Heading drift against the calibration mean.",
          .caption =
              "Below one the predictor is better; error bars are 95 % intervals from 2000 "
              "bootstrap resamples of the drives.",
          .y = {.label = "Ratio of rms heading drift", .unit = ""},
          .categories = {"15 s / 60 s", "30 s / 120 s", "60 s / 300 s", "120 s / 900 s"},
          .groups = {{.name = "kalman",
                      .values = {0.65, 0.69, 0.78, 0.91},
                      .colour = Colour::blue,
                      .lo = {0.61, 0.64, 0.71, 0.8},
                      .hi = {0.69, 0.74, 0.86, 1.03}},
                     {.name = "moving average",
                      .values = {0.72, 0.77, 0.88, 0.99},
                      .colour = Colour::green,
                      .lo = {0.68, 0.72, 0.8, 0.88},
                      .hi = {0.77, 0.83, 0.97, 1.11}}},
          .reference = Reference{.name = "calibration mean", .value = 1}};
}

Table results_table() {
  return {.caption = "Three predictors on the same 90 drives.",
          .columns = {{.heading = "Predictor"},
                      {.heading = "Drives"},
                      {.heading = "Heading drift", .unit = "deg rms", .decimals = 4},
                      {.heading = "Ratio", .decimals = 2},
                      {.heading = "Mean error", .unit = "deg/h", .decimals = 3},
                      {.heading = "Coverage", .unit = "%", .decimals = 1}},
          .rows = {{"kalman", 90, 0.0204, 0.65, -0.0123, 94.4},
                   {"moving_average", 90, 0.0226, 0.72, 0.0311, 93.3},
                   {"calibration_mean", 90, 0.0314, 1.0, -0.142, kGap}}};
}

/// Time stamps since 1970, over an hour.
Chart stamped_chart() {
  Series rate{.name = "rate"};
  for (int minute = 0; minute <= 60; ++minute) {
    rate.x.push_back(1'796'040'000.0 + 60.0 * minute);
    rate.y.push_back(std::sin(0.1 * minute));
  }
  return {.title = "Stamped rate.",
          .x = {.label = "Time", .unit = "s"},
          .y = {.label = "Rate", .unit = "deg/s"},
          .series = {std::move(rate)}};
}

/// Every kind of content once, for the eye and for the browser test.
Report sample_report() {
  Report report("Heading drift of a simulated drive",
                "Over 90 drives the Kalman predictor keeps the heading within 0.020° rms, a third "
                "less than the mean of each standstill; its 95 % interval held 94.4 % of the "
                "drives.");
  const Recording recording = make_recording(1'000'000);
  report.section("Result")
      .key_figures({{"Heading drift, kalman", "0.020°", "rms per drive of 120 s"},
                    {"Against calibration mean", "0.65", "95 % interval 0.61 to 0.69"},
                    {"Coverage of the 95 % interval", "94.4 %", "85 of 90 drives"}})
      .table(results_table())
      .chart(ratio_chart());
  report.section("Rate")
      .paragraph(
          "The node received 1 000 000 samples at 100 Hz. The grey trace is the output of the "
          "sensor, the blue one the rate that the node handed to the vehicle.")
      .chart(rate_chart(recording))
      .chart(stamped_chart());
  report.section("Bias").chart(bias_chart(recording));
  report.section("Drives").chart(drift_chart());
  report.section("Noise").chart(allan_chart());
  report.section("How this was made")
      .paragraph("Texts are shown as they are: </script><b>not bold</b> & \"quoted\".")
      .listing(
          "zerorate replay drive.csv.gz --model lsm6dso.toml \\\n"
          "    --schedule still=30,drive=120,seed=1 --through chip");
  report.provenance("zerorate 0.2.0, sample report, seed 1");
  return report;
}

Chart chart_of(const char* title, Series series, Scale scale = Scale::linear) {
  return {.title = title,
          .x = {.label = "Time", .unit = "s", .scale = scale},
          .y = {.label = "Rate", .unit = "deg/h", .scale = scale},
          .series = {std::move(series)}};
}

/// Charts that have little or nothing to show: what a short or failed run gives.
Report sparse_report() {
  Report report("Charts with little to show", "None of them may fail.");
  report.section("Curves")
      .chart(Chart{.title = "No series."})
      .chart(chart_of("No points.", {.name = "none"}))
      .chart(
          chart_of("Nothing but gaps.", {.name = "gaps", .x = {0, 1, 2}, .y = {kGap, kGap, kGap}}))
      .chart(chart_of("One point.", {.name = "one", .x = {5}, .y = {3}}))
      .chart(chart_of("Constant.", {.name = "constant", .x = {0, 1}, .y = {-2, -2}}))
      .chart(chart_of("All at one x.", {.name = "same", .x = {1, 1, 1}, .y = {1, 3, 2}}))
      .chart(chart_of("A lone point between gaps.",
                      {.name = "lone", .x = {0, 1, 2, 3}, .y = {1, kGap, 2, kGap}}))
      .chart(chart_of("Microscopic.", {.name = "tiny", .x = {0, 1e-7}, .y = {1e-9, 2e-9}}));
  report.section("Curves on logarithmic axes")
      .chart(chart_of("Nothing positive.", {.name = "none", .x = {-1, 0}, .y = {1, 1}},
                      Scale::logarithmic))
      .chart(chart_of("One point.", {.name = "one", .x = {3}, .y = {3}}, Scale::logarithmic))
      .chart(chart_of("Within a decade.", {.name = "short", .x = {3.1, 3.9}, .y = {6.2, 6.8}},
                      Scale::logarithmic))
      .chart(chart_of("Twenty decades.", {.name = "long", .x = {1e-10, 1e10}, .y = {1e-12, 1e8}},
                      Scale::logarithmic));
  report.section("Bars")
      .chart(BarChart{.title = "No bars."})
      .chart(BarChart{.title = "No values.", .categories = {"a"}, .groups = {{"g", {kGap}}}})
      .chart(BarChart{
          .title = "Below zero.", .categories = {"a", "b"}, .groups = {{"g", {-1.5, 0.5}}}});
  return report;
}

/// The report of a diagnosis: a simulated sensor that warms up and has a few wild samples.
Report diagnosis_report() {
  constexpr std::size_t kSamples = 20'000;
  const std::vector<simulate::Effect> effects{
      simulate::WarmUpTransient{.amplitude_rad_s = 2e-3, .time_constant_s = 150.0},
      simulate::Outliers{.sigma_rad_s = 0.03, .probability = 1e-3}};
  const simulate::Signal signal = simulate::simulate(testing::simulate_rest({}, kSamples, 0.1, 1),
                                                     effects, random::RandomStream(1));
  const std::vector diagnoses{
      diagnose::diagnose(diagnose::record_of(testing::rest_samples_of(signal), 0))};
  return diagnose::make_report(diagnoses, {.title = "Diagnosis of rest.csv.gz",
                                           .recording = "rest.csv.gz",
                                           .provenance = "zerorate, diagnosis report, run 1"});
}

Report report_called(std::string_view name) {
  if (name == "sample") return sample_report();
  if (name == "sparse") return sparse_report();
  if (name == "diagnosis") return diagnosis_report();
  throw std::invalid_argument("no report is called " + std::string(name));
}

}  // namespace
}  // namespace zerorate::report

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: browser_reports sample|sparse|diagnosis OUT.html\n", stderr);
    return 2;
  }
  try {
    zerorate::report::report_called(argv[1]).write(argv[2]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "browser_reports: %s\n", error.what());
    return 1;
  }
}
