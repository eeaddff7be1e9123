/// @file
/// A record prepared for fits, shared by all hypotheses about it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/part.hpp"
#include "host_tools/lib/diagnose/record/even_series.hpp"
#include "host_tools/lib/diagnose/record/level_lattice.hpp"
#include "host_tools/lib/diagnose/record/record.hpp"
#include "host_tools/lib/parallel/parallel.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::diagnose {

/// Temperature behind a first-order lag, about the mean temperature.
struct LaggedTemperature {
  double lag_s = 0.0;
  std::vector<Column> columns;  ///< temperature [K] and its square [K^2]
};

/// The values of a series about their median, with the transforms that the fits need.
class FitData {
 public:
  /// Uses all but the last few values of the series (spectrum::fast_length_below).
  /// @param series must outlive the data
  FitData(const EvenSeries& series, std::uint64_t seed);

  [[nodiscard]] std::size_t size() const { return rate_.size(); }
  [[nodiscard]] double period_s() const { return series_->period_s; }
  [[nodiscard]] double time_s(std::size_t k) const {
    return series_->period_s * static_cast<double>(k);
  }
  [[nodiscard]] double span_s() const { return time_s(size()); }
  [[nodiscard]] const EvenSeries& series() const { return *series_; }
  /// Marks of the values that are lost.
  [[nodiscard]] const std::shared_ptr<const std::vector<bool>>& lost() const { return lost_; }
  /// Deviation from the median [rad/s].
  [[nodiscard]] const std::vector<double>& rate_rad_s() const { return rate_; }
  [[nodiscard]] double median_rad_s() const { return median_; }
  /// Deviations from the median, without the lost values [rad/s].
  [[nodiscard]] std::vector<double> measured() const;
  /// Levels that the measured values lie on; nothing for means over ticks.
  [[nodiscard]] const std::optional<LevelLattice>& lattice() const { return lattice_; }
  [[nodiscard]] const spectrum::CosineTransform& transform() const { return transform_; }
  /// Length of the blocks whose means describe a slow function well enough: 1 up to some 10^5
  /// values.
  [[nodiscard]] std::size_t block() const { return block_; }
  /// Transform of one value a block.
  [[nodiscard]] const spectrum::CosineTransform& block_transform() const {
    return block_transform_ ? *block_transform_ : transform_;
  }
  /// 2 sin(w/2) of each DCT coefficient.
  [[nodiscard]] const std::vector<double>& sines() const { return sines_; }
  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  /// Columns that all effects of the temperature search among; the first of them makes them.
  [[nodiscard]] const parallel::Lazy<std::vector<LaggedTemperature>>& lagged_temperatures() const {
    return lagged_temperatures_;
  }

 private:
  const EvenSeries* series_;
  std::vector<double> rate_;
  std::shared_ptr<const std::vector<bool>> lost_;
  double median_ = 0.0;
  std::optional<LevelLattice> lattice_;
  spectrum::CosineTransform transform_;
  std::size_t block_ = 1;
  std::optional<spectrum::CosineTransform> block_transform_;
  std::vector<double> sines_;
  std::uint64_t seed_;
  parallel::Lazy<std::vector<LaggedTemperature>> lagged_temperatures_;
};

/// Replaces marked values by the expectation from their neighbours, with noise of the neighbours'
/// size, so that the spectrum of the record does not change. Linear in the number of values.
/// @param values  one a sample [rad/s]
/// @param is_replaced  marks the values to replace
/// @param range  measuring range: a marked value at one of its ends is drawn from beyond that end
/// @param seed  of the noise; equal arguments give equal values
[[nodiscard]] std::vector<double> repair(const std::vector<double>& values,
                                         const std::vector<bool>& is_replaced, const Range& range,
                                         std::uint64_t seed);

/// Even series of a record and its data for fits. As long as the record is, so keep it in a scope.
class PreparedAxis {
 public:
  PreparedAxis(const Record& record, std::uint64_t seed)
      : PreparedAxis(even_series_of(record), seed) {}
  PreparedAxis(EvenSeries series, std::uint64_t seed)
      : series_(std::move(series)), data_(series_, seed) {}
  PreparedAxis(const PreparedAxis&) = delete;
  PreparedAxis& operator=(const PreparedAxis&) = delete;

  [[nodiscard]] const EvenSeries& series() const { return series_; }
  [[nodiscard]] const FitData& data() const { return data_; }

 private:
  EvenSeries series_;
  FitData data_;
};

}  // namespace zerorate::diagnose
