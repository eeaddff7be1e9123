#include "host_tools/lib/parallel/parallel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace zerorate::parallel {
namespace {

unsigned processors() {
  return std::max(1U, std::thread::hardware_concurrency());
}

TEST(ForEach, CallsEachPieceOnceAndTellsTheProgress) {
  std::vector<std::atomic<int>> calls(1000);
  double before = 0.0;
  for_each(
      calls.size(), kAllThreads, [&](std::size_t i) { ++calls[i]; },
      [&](double share) {
        EXPECT_GT(share, before);
        before = share;
      });
  EXPECT_TRUE(std::ranges::all_of(calls, [](int count) { return count == 1; }));
  EXPECT_EQ(before, 1.0);
}

TEST(ForEach, WithoutPiecesReturns) {
  for_each(0, kAllThreads, [](std::size_t /*piece*/) { ADD_FAILURE(); }, {});
}

TEST(NestedCalls, KeepToTheProcessorsThatThereAre) {
  std::atomic<int> calls = 0;
  std::atomic<unsigned> now = 0;
  std::atomic<unsigned> most = 0;
  const auto leaf = [&](std::size_t /*piece*/) {
    const unsigned working = ++now;
    for (unsigned seen = most; seen < working && !most.compare_exchange_weak(seen, working);) {
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    --now;
    ++calls;
  };
  for_each(5, kAllThreads, [&](std::size_t /*piece*/) { for_each(20, kAllThreads, leaf, {}); }, {});
  EXPECT_EQ(calls, 100);
  EXPECT_LE(most, processors());
}

// The first piece is long: were its own pieces left to one thread, the others would stand still.
TEST(NestedCalls, HireAThreadThatHasBecomeFree) {
  if (processors() < 2) GTEST_SKIP() << "skipped: one processor";
  std::atomic<bool> is_other_done = false;
  std::atomic<bool> was_helped = false;
  const auto long_piece = [&] {
    const std::thread::id own = std::this_thread::get_id();
    while (!is_other_done) std::this_thread::yield();
    const auto look = [&](std::size_t /*piece*/) {
      if (std::this_thread::get_id() != own) was_helped = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    for (int i = 0; i < 10'000 && !was_helped; ++i) for_each(4, kAllThreads, look, {});
  };
  together({long_piece, [&] { is_other_done = true; }});
  EXPECT_TRUE(was_helped);
}

// The caller has no piece left. Its processor is free for what the last piece is made of.
TEST(NestedCalls, HireAThreadInThePlaceOfACallerThatWaits) {
  if (processors() < 2) GTEST_SKIP() << "skipped: one processor";
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<bool> is_long_begun = false;
  std::atomic<bool> was_helped = false;
  const auto wait_for_long = [&] {
    while (!is_long_begun) std::this_thread::yield();
  };
  const auto long_piece = [&] {
    const std::thread::id own = std::this_thread::get_id();
    EXPECT_NE(own, caller);
    is_long_begun = true;
    const auto look = [&](std::size_t /*piece*/) {
      if (std::this_thread::get_id() != own) was_helped = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    for (int i = 0; i < 10'000 && !was_helped; ++i) for_each(4, kAllThreads, look, {});
  };
  for (int i = 0; i < 3; ++i) {
    is_long_begun = was_helped = false;
    together({wait_for_long, long_piece});
    EXPECT_TRUE(was_helped) << "call " << i;
  }
}

TEST(ACallWithANumberOfThreads, HoldsForTheCallsInside) {
  const std::thread::id own = std::this_thread::get_id();
  for_each(3, 1,
           [&](std::size_t /*piece*/) {
             for_each(20, kAllThreads,
                      [&](std::size_t /*inner*/) { EXPECT_EQ(std::this_thread::get_id(), own); },
                      {});
           },
           {});
}

TEST(AnException, EndsTheRestAndIsThrownAgain) {
  std::atomic<int> calls = 0;
  const auto fail = [&](std::size_t /*piece*/) {
    ++calls;
    throw std::runtime_error("a piece failed");
  };
  EXPECT_THROW(for_each(1000, kAllThreads, fail, {}), std::runtime_error);
  EXPECT_LE(calls, static_cast<int>(processors()));
}

TEST(LazyValue, IsMadeOnceForAllCopies) {
  int made = 0;
  const Lazy<int> value;
  const Lazy<int> copy = value;
  const auto make = [&] { return ++made; };
  EXPECT_EQ(value.get(make), 1);
  EXPECT_EQ(copy.get(make), 1);
}

}  // namespace
}  // namespace zerorate::parallel
