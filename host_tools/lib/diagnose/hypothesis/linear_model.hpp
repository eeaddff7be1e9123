/// @file
/// Generalised least squares with columns in the DCT domain, where the noise is independent: one
/// inner product and one policy for columns that say the same.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/part.hpp"

namespace zerorate::diagnose {

/// Inner product x' Sigma^-1 y of two columns.
/// @param density  S_k of the noise, up to the end of the shorter column at least
[[nodiscard]] double inner(const Column& x, const Column& y, std::span<const double> density);
/// Inner product x' Sigma^-1 c of a column with all coefficients of a record.
[[nodiscard]] double inner(const Column& x, std::span<const double> coefficients,
                           std::span<const double> density);

/// Normal equations of columns, factorised column by column (Cholesky). A column of which less than
/// kLeastShare is left beside the columns before it is collinear: it gets no amplitude and gains
/// nothing. So the gain that a search foretells for a column is the gain of the fit with it.
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
  /// Variances of the amplitudes; that of a collinear column is as large as can be told.
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

}  // namespace zerorate::diagnose
