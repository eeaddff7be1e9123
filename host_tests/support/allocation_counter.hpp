/// @file
/// Proves that code does not touch the heap: every allocation of the test program is counted.
///
///     const AllocationCounter allocations;
///     node.step(sample);
///     EXPECT_EQ(allocations.count(), 0U);
///
/// Linking the target zerorate::support_allocation_counter replaces all forms of operator new and
/// wraps malloc, calloc, realloc, aligned_alloc and posix_memalign as called from our own object
/// files (Eigen calls malloc directly). What a shared library allocates for itself by malloc is not
/// seen.
#pragma once

#include <cstddef>

namespace zerorate::support {

/// Counts the allocations of the constructing thread from its construction on.
class AllocationCounter {
 public:
  AllocationCounter() : before_(so_far()) {}
  /// Allocations since construction; memory given back does not lower it.
  [[nodiscard]] std::size_t count() const { return so_far() - before_; }

 private:
  static std::size_t so_far();
  std::size_t before_;
};

}  // namespace zerorate::support
