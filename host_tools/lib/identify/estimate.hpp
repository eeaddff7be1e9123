#pragma once

namespace zerorate::identify {

/// A number with its standard error.
struct Estimate {
  double value;
  double standard_error;
};

}  // namespace zerorate::identify
