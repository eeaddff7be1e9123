#include "host_tools/lib/recording/increments.hpp"

#include <limits>
#include <utility>

namespace zerorate::recording {

RatesOfIncrements::RatesOfIncrements(std::unique_ptr<RowSource> rows)
    : rows_(std::move(rows)), columns_(rows_.source().columns()) {
  columns_.are_increments = false;
  has_ahead_ = rows_.next(ahead_);
}

bool RatesOfIncrements::next(Row& row) {
  if (!has_ahead_) {
    rows_.rethrow();
    return false;
  }
  row = ahead_.row;
  line_ = ahead_.line;
  has_ahead_ = rows_.next(ahead_);
  const std::int64_t interval_ns = time_before_ns_ ? row.time_ns - *time_before_ns_
                                   : has_ahead_    ? ahead_.row.time_ns - row.time_ns
                                                   : 0;
  time_before_ns_ = row.time_ns;
  if (interval_ns > 0) intervals_.add(interval_ns);
  // Behind a missing row the angle may be of one sample or of two.
  const bool is_known = interval_ns > 0 && 2 * interval_ns < 3 * intervals_.value_ns();
  for (float& rate : row.rate_rad_s) {
    rate = is_known ? static_cast<float>(rate / (static_cast<double>(interval_ns) * 1e-9))
                    : std::numeric_limits<float>::quiet_NaN();
  }
  return true;
}

}  // namespace zerorate::recording
