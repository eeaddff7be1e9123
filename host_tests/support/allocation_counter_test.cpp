#include "host_tests/support/allocation_counter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <vector>

namespace zerorate::support {
namespace {

/// Keeps the compiler from leaving out a new and its delete (it may, C++20 [expr.new]/10).
template <class T>
void use(T* block) {
  asm volatile("" : : "r"(block) : "memory");
}

TEST(AllocationCounterOverFixedMemory, CountsNothing) {
  const AllocationCounter allocations;
  std::array<float, 64> samples{};
  use(samples.data());
  const Eigen::Matrix<float, 3, 3> product =
      Eigen::Matrix<float, 3, 3>::Ones() * Eigen::Matrix<float, 3, 3>::Ones();
  use(product.data());
  EXPECT_EQ(allocations.count(), 0U);
}

TEST(AllocationCounterOverContainers, CountsEachAllocationOnce) {
  const AllocationCounter allocations;
  const std::vector<int> numbers(100);
  use(numbers.data());
  EXPECT_EQ(allocations.count(), 1U);
  const std::string text(100, 'x');
  use(text.data());
  EXPECT_EQ(allocations.count(), 2U);
}

TEST(AllocationCounterOverFormsOfNew, SeesAllOfThem) {
  struct alignas(64) Wide {
    std::array<std::uint8_t, 64> bytes;
  };
  const AllocationCounter allocations;
  const std::unique_ptr<int> one(new int(1));
  use(one.get());
  const std::unique_ptr<int[]> several(new int[3]);
  use(several.get());
  const std::unique_ptr<int> nothrow(new (std::nothrow) int(1));
  use(nothrow.get());
  const std::unique_ptr<int[]> several_nothrow(new (std::nothrow) int[3]);
  use(several_nothrow.get());
  const std::unique_ptr<Wide> wide(new Wide{});
  use(wide.get());
  const std::unique_ptr<Wide[]> several_wide(new Wide[2]);
  use(several_wide.get());
  EXPECT_EQ(allocations.count(), 6U);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(wide.get()) % alignof(Wide), 0U);
}

TEST(AllocationCounterOverTheCLibrary, CountsOurOwnAndEigens) {
  const AllocationCounter allocations;
  void* const block = std::malloc(8);
  use(block);
  std::free(block);
  EXPECT_EQ(allocations.count(), 1U);
  const Eigen::MatrixXf dynamic = Eigen::MatrixXf::Ones(9, 9);
  use(dynamic.data());
  EXPECT_EQ(allocations.count(), 2U);
}

TEST(AllocationCounterBesideAnotherThread, CountsItsOwnThreadOnly) {
  std::size_t counted_there = 0;
  std::thread other([&counted_there] {
    const AllocationCounter allocations;
    use(std::make_unique<int>(1).get());
    counted_there = allocations.count();
  });
  const AllocationCounter allocations;
  other.join();
  EXPECT_EQ(allocations.count(), 0U);
  EXPECT_EQ(counted_there, 1U);
}

}  // namespace
}  // namespace zerorate::support
