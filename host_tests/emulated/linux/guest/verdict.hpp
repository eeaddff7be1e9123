/// @file
/// Counts findings and prints them.
#pragma once

#include <cstdio>

namespace zerorate::emulated {

class Verdict {
 public:
  void begin(const char* scenario) const { std::printf("scenario: %s\n", scenario); }
  /// @param value  is printed: what decided
  template <class Number>
  void check(const char* what, bool is_right, Number value) {
    std::printf("  %s: %s (%.6g)\n", is_right ? "ok" : "FAILED", what, static_cast<double>(value));
    std::fflush(stdout);
    (is_right ? passed_ : failed_) += 1;
  }
  int report() const {
    std::printf("WORLD %d passed, %d failed\n", passed_, failed_);
    return failed_ == 0 ? 0 : 1;
  }

 private:
  int passed_ = 0;
  int failed_ = 0;
};

}  // namespace zerorate::emulated
