#include "host_tools/lib/parallel/parallel.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace zerorate::parallel {

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
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  {
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < threads; ++i) others.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace zerorate::parallel
