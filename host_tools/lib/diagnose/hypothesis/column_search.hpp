/// @file
/// Search for mean functions: the gain of a further column by generalised least squares in the DCT
/// domain, at the noise of a hypothesis (docs/design/diagnosis.md, section 3).
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"

namespace zerorate::diagnose {

/// Gains of columns beside those of a hypothesis, its noise held.
class ColumnSearch {
 public:
  /// Prepares a search for columns to be added to a hypothesis.
  /// @param hypothesis must outlive the search
  explicit ColumnSearch(const Hypothesis& hypothesis);
  /// Prepares a search for columns in the place of a part's, the noise being that with the part.
  ColumnSearch(const Hypothesis& hypothesis, std::size_t part);

  [[nodiscard]] const FitData& data() const { return hypothesis_->data(); }
  [[nodiscard]] const std::vector<double>& density() const { return hypothesis_->density(); }
  [[nodiscard]] const std::vector<double>& precision() const { return hypothesis_->precision(); }
  [[nodiscard]] const NoiseSpectrum& noise() const { return hypothesis_->noise().spectrum; }
  /// DCT coefficients of the residual to be explained.
  [[nodiscard]] const std::vector<double>& residual() const {
    return is_changed_ ? residual_ : hypothesis_->residual();
  }
  /// Gain of log likelihood by the best amplitudes of these columns.
  [[nodiscard]] double gain(std::span<const Column> columns) const;
  [[nodiscard]] double gain(const Column& column) const { return gain(std::span(&column, 1)); }
  /// x' Sigma^-1 x of the share of a column that those of the hypothesis do not describe.
  [[nodiscard]] double information(const Column& column) const;

  /// Sigma^-1 (y - mean), value by value.
  [[nodiscard]] const std::vector<double>& precision_weighted_residual() const;
  /// Gain of a step before each value; 0 at the first and the last few places.
  [[nodiscard]] std::vector<double> step_gains() const;
  /// How often the gain of steps crosses a level G upwards by chance, over e^(-G).
  [[nodiscard]] double step_crossings() const;

 private:
  friend class ColumnPursuit;

  [[nodiscard]] std::vector<double> products_with_others(const Column& column) const;
  [[nodiscard]] const std::vector<double>& step_information() const;

  const Hypothesis* hypothesis_;
  std::vector<const Column*> others_;
  NormalEquations equations_;            ///< equations of the other columns
  std::vector<double> others_products_;  ///< with the residual
  bool is_changed_ = false;              ///< the residual is not that of the hypothesis
  std::vector<double> residual_;         ///< then
  mutable std::vector<double> precision_weighted_residual_;
  mutable std::vector<double> step_information_;
};

/// Columns that are chosen one after the other, each for its gain beside those before it
/// (orthogonal least squares, Chen et al. 1989). One inner product a candidate and choice.
class ColumnPursuit {
 public:
  /// @param search must outlive the pursuit
  ColumnPursuit(const ColumnSearch& search, std::vector<Column> candidates);

  struct Best {
    std::size_t candidate = 0;  ///< its number
    double gain = 0.0;          ///< gain of log likelihood, beside the columns that were chosen
  };
  /// The candidate of the greatest gain; a gain of 0 if none is left.
  [[nodiscard]] Best best() const;
  /// Adds a candidate to the columns.
  void choose(std::size_t candidate);

 private:
  struct Candidate {
    Column column;
    std::vector<double> products;  ///< with the columns of the hypothesis, and those chosen
    double own;                    ///< product with itself
    double with_residual;
    bool is_chosen = false;
  };

  [[nodiscard]] double gain(const Candidate& candidate) const;

  const ColumnSearch* search_;
  NormalEquations equations_;
  std::vector<double> with_residual_;  ///< products of the columns of the equations
  std::vector<Candidate> candidates_;
};

/// A search that names the best part at the given noise.
using MeanSearch = std::function<std::optional<Part>(const ColumnSearch&)>;

/// A part that was found, and the hypothesis that it makes.
struct MeanFit {
  Part part;
  double gain_nats = 0.0;
  Hypothesis with;  ///< the part, which is the last one
};

/// Searches, fits the noise again and searches once more at the new noise; the better of the two
/// parts. Nothing where the search finds nothing. Two fits.
[[nodiscard]] std::optional<MeanFit> fit_mean(const Hypothesis& without, const MeanSearch& search);

}  // namespace zerorate::diagnose
