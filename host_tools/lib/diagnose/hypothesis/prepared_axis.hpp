/// @file
/// An axis, gridded and transformed: the one recipe from a record to the data of its fits.
#pragma once

#include <cstdint>

#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"
#include "host_tools/lib/diagnose/record/even_series.hpp"
#include "host_tools/lib/diagnose/record/record.hpp"

namespace zerorate::diagnose {

/// Even series of a record and its data for fits. As long as the record is, so keep it in a scope.
class PreparedAxis {
 public:
  PreparedAxis(const Record& record, std::uint64_t seed)
      : series_(even_series_of(record)), data_(series_, seed) {}
  PreparedAxis(const PreparedAxis&) = delete;
  PreparedAxis& operator=(const PreparedAxis&) = delete;

  [[nodiscard]] const EvenSeries& series() const { return series_; }
  [[nodiscard]] const FitData& data() const { return data_; }

 private:
  EvenSeries series_;
  FitData data_;
};

}  // namespace zerorate::diagnose
