/// @file
/// Generalised least squares with columns in the DCT domain, where the noise is independent: one
/// inner product and one policy for columns that are linearly dependent.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/hypothesis/part.hpp"

namespace zerorate::diagnose {

/// Inner product x' Sigma^-1 y of two columns.
/// @param precision  1 / S_k of the noise, up to the end of the shorter column at least
[[nodiscard]] double inner(const Column& x, const Column& y, std::span<const double> precision);
/// Inner product x' Sigma^-1 c of a column with all coefficients of a record.
[[nodiscard]] double inner(const Column& x, std::span<const double> coefficients,
                           std::span<const double> precision);

/// Normal equations of columns, factorised column by column (Cholesky). A column is collinear if
/// less than kLeastShare of it is left beside the columns before it: it gets no amplitude and gains
/// nothing. So the gain that a search computes for a column is the gain of the fit with it.
class NormalEquations {
 public:
  static constexpr double kLeastShare = 1e-8;

  /// Adds a column.
  /// @param products  inner products with the columns before it
  /// @param own  inner product with itself
  void add(std::span<const double> products, double own);

  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  /// Coordinates of x in the orthonormal basis of the columns.
  /// @param products  inner products of x with the columns; those of the first ones are enough for
  /// their coordinates
  [[nodiscard]] std::vector<double> coordinates(std::span<const double> products) const;
  /// Best amplitudes.
  /// @param products  inner products of the record with the columns
  [[nodiscard]] std::vector<double> amplitudes(std::span<const double> products) const;
  /// Variances of the amplitudes; that of a collinear column is as large as can be determined.
  [[nodiscard]] std::vector<double> variances() const;

 private:
  /// A row of the lower triangular factor; its last element is 0 for a collinear column.
  struct Row {
    std::vector<double> factor;
    double own = 0.0;
  };
  std::vector<Row> rows_;
};

/// Sum of squares, which is twice the gain of log likelihood where x are coordinates of a record.
[[nodiscard]] double sum_of_squares(std::span<const double> x);

/// The DCT of a slow function of time given at each value. Of long records it is taken of the means
/// over blocks, and coefficients beyond half of theirs are left out.
[[nodiscard]] Column column_of(const FitData& data, std::span<const double> values);
/// Column of a function that is smooth over a block.
[[nodiscard]] Column column_of(const FitData& data,
                               const std::function<double(double time_s)>& function);
/// Column of a fast function, with all coefficients.
[[nodiscard]] Column fast_column_of(const FitData& data,
                                    const std::function<double(double time_s)>& function);
/// Column of a step: 0 before value `first` and 1 from it on.
[[nodiscard]] Column step_column(const FitData& data, std::size_t first);
/// Columns of cosine and sine of a tone, `cycles` a value; coefficients far from its frequency are
/// left out.
[[nodiscard]] std::pair<Column, Column> tone_columns(const FitData& data, double cycles);
/// Column of e^(-t / tau).
[[nodiscard]] Column decay_column(const FitData& data, double tau_s);
/// Column of a decay of any pace, with all coefficients: 0 before value `first`, and e^(-t / tau)
/// after it.
[[nodiscard]] Column fast_decay_column(const FitData& data, double tau_s, std::size_t first);

/// Column of values whose means have a column.
/// @param values, means  of one record, from the same value on
[[nodiscard]] Column column_of_values(const FitData& values, const FitData& means,
                                      const Column& column_of_means);

/// DCT coefficients of the mean functions of a hypothesis.
[[nodiscard]] std::vector<double> mean_coefficients(const Hypothesis& hypothesis);

}  // namespace zerorate::diagnose
