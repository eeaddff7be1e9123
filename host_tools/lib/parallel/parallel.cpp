#include "host_tools/lib/parallel/parallel.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace zerorate::parallel {
namespace {

thread_local bool is_inside_a_piece = false;

/// Marks the thread while it works on pieces.
class Inside {
 public:
  Inside() : was_inside_(is_inside_a_piece) { is_inside_a_piece = true; }
  ~Inside() { is_inside_a_piece = was_inside_; }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

 private:
  bool was_inside_;
};

unsigned threads_for(std::size_t count, unsigned wanted) {
  if (is_inside_a_piece) return 1;
  if (wanted == kAllThreads) wanted = std::max(1U, std::thread::hardware_concurrency());
  return static_cast<unsigned>(std::min<std::size_t>(wanted, count));
}

}  // namespace

void for_each(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work,
              const Progress& progress) {
  std::mutex mutex;  // guards what follows
  std::size_t next = 0;
  std::size_t done = 0;
  std::exception_ptr failure;

  const auto take = [&] {
    const std::scoped_lock lock{mutex};
    return failure ? count : std::min(next++, count);
  };
  const auto run = [&] {
    const Inside inside;
    try {
      for (std::size_t i = take(); i < count; i = take()) {
        work(i);
        const std::scoped_lock lock{mutex};
        ++done;
        if (progress) progress(static_cast<double>(done) / static_cast<double>(count));
      }
    } catch (...) {
      const std::scoped_lock lock{mutex};
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned i = threads_for(count, threads); i > 1; --i) others.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

void together(const std::vector<std::function<void()>>& pieces) {
  for_each(pieces.size(), kAllThreads, [&](std::size_t i) { pieces[i](); }, {});
}

}  // namespace zerorate::parallel
