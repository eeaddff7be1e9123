// Cost of one sample for each predictor at full rate, against a textbook dense Kalman filter.
//
// The models hold the same noise: six flicker decades and the level. The dense filter is written as
// a careful user of Eigen would: fixed sizes, no heap, noalias, the plain update of the covariance
// (Joseph's form, twice as dear, is timed beside it).

#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/kalman_predictor.hpp"
#include "core/estimator/moving_average.hpp"
#include "host_tests/support/sample_modes.hpp"

namespace {

using namespace zerorate;

constexpr core::Duration kTick = core::Duration::milliseconds(10);
constexpr float kWhiteVariance = 10.0F;
constexpr float kLevel = 100.0F;

core::Modes<6, 0> six_decades() {
  return core::compose(kTick, core::Start::stationary, testing::flicker_like<6>(kTick, 0.5));
}

/// Level and six decades, dense: x = (level, z), P and F full matrices, h = ones.
class DenseFilter {
 public:
  explicit DenseFilter(const core::Modes<6, 0>& modes) {
    f_.setIdentity();
    q_.setZero();
    p_.setZero();
    x_.setZero();
    p_(0, 0) = 1e6F;
    for (std::size_t i = 0; i < modes.decaying.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i) + 1;
      f_(row, row) = 1.0F - modes.decaying[i].one_minus_phi;
      q_(row, row) = modes.decaying[i].noise_variance;
      p_(row, row) = modes.decaying[i].initial_variance;
    }
  }

  void predict() {
    x_ = f_ * x_;
    fp_.noalias() = f_ * p_;
    p_.noalias() = fp_ * f_.transpose();
    p_ += q_;
  }

  void update(float y, float r) {
    const Vector k = gain(y, r);
    p_.noalias() -= k * ph_.transpose();
  }

  void update_joseph(float y, float r) {
    const Vector k = gain(y, r);
    Matrix a = Matrix::Identity();
    a.noalias() -= k * h_.transpose();
    fp_.noalias() = a * p_;
    p_.noalias() = fp_ * a.transpose();
    p_.noalias() += (r * k) * k.transpose();
  }

  [[nodiscard]] float bias() const { return h_.dot(x_); }

 private:
  using Matrix = Eigen::Matrix<float, 7, 7>;
  using Vector = Eigen::Matrix<float, 7, 1>;

  /// Computes P h, corrects x and gives the gain.
  Vector gain(float y, float r) {
    ph_.noalias() = p_ * h_;
    Vector k = ph_ / (h_.dot(ph_) + r);
    x_ += k * (y - h_.dot(x_));
    return k;
  }

  Matrix f_, q_, p_, fp_;
  Vector x_, ph_;
  Vector h_ = Vector::Ones();
};

/// Measurements drawn before the clock starts, used round and round.
class Measurements {
 public:
  Measurements() {
    std::mt19937 random{1};
    std::normal_distribution<float> normal{kLevel, 3.0F};
    for (float& y : drawn_) y = normal(random);
  }
  float next() { return drawn_[++newest_ % drawn_.size()]; }

 private:
  std::array<float, 4096> drawn_{};
  std::size_t newest_ = 0;
};

/// One sample: the prediction it is corrected by, then what is learnt from it.
template <class Predictor>
void predictor_sample(benchmark::State& state) {
  const auto modes = six_decades();
  const auto tick = modes.one_tick();
  const typename Predictor::Coefficients coefficients{modes};
  Predictor predictor{coefficients};
  Measurements measurements;
  for (auto _ : state) {
    benchmark::DoNotOptimize(predictor.bias_rad_s(tick));
    benchmark::DoNotOptimize(predictor.step(tick, measurements.next(), kWhiteVariance));
    benchmark::DoNotOptimize(predictor);  // its state lies in memory, as in a node
  }
}

template <void (DenseFilter::*update)(float, float)>
void dense_sample(benchmark::State& state) {
  DenseFilter filter{six_decades()};
  Measurements measurements;
  for (auto _ : state) {
    filter.predict();
    benchmark::DoNotOptimize(filter.bias());
    (filter.*update)(measurements.next(), kWhiteVariance);
    benchmark::DoNotOptimize(filter);
  }
}

constexpr const char* kDense = "dense_7_states";
constexpr const char* kDenseJoseph = "dense_7_states_joseph";

BENCHMARK(dense_sample<&DenseFilter::update>)->Name(kDense);
BENCHMARK(dense_sample<&DenseFilter::update_joseph>)->Name(kDenseJoseph);
BENCHMARK(predictor_sample<core::KalmanPredictor<core::ModelShape{.decaying = 6}>>)->Name("kalman");
BENCHMARK(predictor_sample<core::MovingAverage<core::ModelShape{.decaying = 6}>>)
    ->Name("moving_average");
BENCHMARK(predictor_sample<core::CalibrationMean<core::ModelShape{.decaying = 6}>>)
    ->Name("calibration_mean");

/// The usual table; remembers the least time of each benchmark for the ratios.
class RatioReporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      const double ns = run.GetAdjustedCPUTime();
      const auto [least, is_new] = least_ns_.try_emplace(run.run_name.function_name, ns);
      if (!is_new) least->second = std::min(least->second, ns);
    }
    ConsoleReporter::ReportRuns(runs);
  }

  /// How many times faster than the dense filters each benchmark was.
  void print_ratios() const {
    if (!least_ns_.contains(kDense) || !least_ns_.contains(kDenseJoseph)) return;
    std::printf("\n%-30s%16s%16s\n", "times faster than dense", "plain update", "Joseph's form");
    for (const auto& [name, ns] : least_ns_) {
      std::printf("%-30s%16.1f%16.1f\n", name.c_str(), least_ns_.at(kDense) / ns,
                  least_ns_.at(kDenseJoseph) / ns);
    }
  }

 private:
  std::map<std::string, double> least_ns_;
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.print_ratios();
}
