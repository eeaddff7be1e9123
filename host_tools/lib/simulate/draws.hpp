/// @file
/// Random numbers one after another.
#pragma once

#include <cmath>
#include <cstdint>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::simulate {

/// Draws one after another from an addressable stream. Two draws in one expression or call come in
/// an order that the compiler chooses: give each a name.
class Draws {
 public:
  explicit Draws(const random::RandomStream& stream) : stream_(stream) {}

  double uniform(double from, double to) { return from + (to - from) * stream_.uniform(next_++); }
  double exponential(double mean) { return -mean * std::log(stream_.uniform(next_++)); }
  double normal(double sigma) { return sigma * stream_.normal(next_++); }
  bool happens(double share) { return stream_.uniform(next_++) < share; }

 private:
  random::RandomStream stream_;
  std::int64_t next_ = 0;
};

}  // namespace zerorate::simulate
