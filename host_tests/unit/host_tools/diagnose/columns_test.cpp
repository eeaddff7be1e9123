#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::diagnose {
namespace {

EvenSeries noise_of(std::size_t size) {
  EvenSeries series{.period_s = 0.1, .rate_rad_s = std::vector<double>(size)};
  random::RandomStream(5).fill_normal(0, series.rate_rad_s);
  series.lost.resize(size);
  return series;
}

/// The greatest distance from the transform of the function itself, over its norm.
double error_of(const FitData& data, const Column& column,
                const std::function<double(double)>& function) {
  const Column exact = fast_column_of(data, function);
  double most = 0.0;
  double squares = 0.0;
  for (std::size_t k = column.first; k < column.end(); ++k) {
    const double value = exact.coefficients[k - 1];
    most = std::max(most, std::abs(column.coefficients[k - column.first] - value));
    squares += value * value;
  }
  return most / std::sqrt(squares);
}

class ColumnsOfARecord : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ColumnsOfARecord, AreTheTransformsOfTheirFunctions) {
  const EvenSeries series = noise_of(GetParam());
  const FitData data(series, 1);
  const double span_s = data.span_s();
  const double tau_s = 0.03 * span_s;
  EXPECT_LT(
      error_of(data, decay_column(data, tau_s), [=](double t) { return std::exp(-t / tau_s); }),
      1e-10);
  const std::size_t jump = data.size() / 3;
  EXPECT_LT(
      error_of(data, step_column(data, jump),
               [=](double t) { return t < (static_cast<double>(jump) - 0.5) * 0.1 ? 0.0 : 1.0; }),
      1e-10);
  for (const double cycles : {0.01237, 0.25, 0.4871}) {
    const double rad_per_s = 2.0 * std::numbers::pi * cycles / 0.1;
    const auto [cosine, sine] = tone_columns(data, cycles);
    EXPECT_LT(error_of(data, cosine, [=](double t) { return std::cos(rad_per_s * t); }), 1e-3);
    EXPECT_LT(error_of(data, sine, [=](double t) { return std::sin(rad_per_s * t); }), 1e-3);
  }
  EXPECT_LT(error_of(data, column_of(data, [](double t) { return t; }), [](double t) { return t; }),
            1e-4);
}

INSTANTIATE_TEST_SUITE_P(ShortAndLong, ColumnsOfARecord, ::testing::Values(2000U, 200'000U),
                         ::testing::PrintToStringParamName());

TEST(ColumnOfValuesOfALongRecord, IsThatOfTheirFunction) {
  const EvenSeries series = noise_of(200'000);
  const FitData data(series, 1);
  ASSERT_GT(data.block(), 1U);
  const auto wave = [&](double t) { return std::sin(20.0 * t / data.span_s()); };
  std::vector<double> values;
  for (std::size_t k = 0; k < data.size(); ++k) values.push_back(wave(data.time_s(k)));
  EXPECT_LT(error_of(data, column_of(data, std::span<const double>(values)), wave), 1e-5);
}

}  // namespace
}  // namespace zerorate::diagnose
