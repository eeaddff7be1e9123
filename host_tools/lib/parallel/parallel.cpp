#include "host_tools/lib/parallel/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace zerorate::parallel {
namespace {

/// Threads that may still begin: what runs at once never exceeds the processors, however deep the
/// pieces are nested.
class Vacancies {
 public:
  [[nodiscard]] bool take() {
    int left = left_.load();
    while (left > 0 && !left_.compare_exchange_weak(left, left - 1)) {
    }
    return left > 0;
  }
  void give_back() { ++left_; }

 private:
  std::atomic<int> left_{static_cast<int>(std::max(1U, std::thread::hardware_concurrency())) - 1};
};

Vacancies& vacancies() {
  static Vacancies all;
  return all;
}

/// True inside a call with a limited number of threads: nested calls run on one thread.
thread_local bool is_limited = false;

/// The pieces of one call, and the threads that take them one after the other.
class Crew {
 public:
  Crew(std::size_t count, unsigned most_threads, const std::function<void(std::size_t)>& work,
       const Progress& progress)
      : count_(count),
        most_threads_(is_limited ? 1 : most_threads),
        work_(work),
        progress_(progress) {}

  /// Returns, or throws, when all pieces are done. While it waits, the last pieces may have its
  /// processor for pieces of their own.
  void run() {
    take_pieces();
    if (lends_processor()) vacancies().give_back();
    while (std::optional<std::jthread> other = next_to_join()) other->join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void take_pieces() {
    const bool was_limited = std::exchange(is_limited, most_threads_ != kAllThreads);
    try {
      for (std::size_t i = begin_piece(); i < count_; i = begin_piece()) {
        work_(i);
        const std::scoped_lock lock{mutex_};
        ++done_;
        if (progress_) progress_(static_cast<double>(done_) / static_cast<double>(count_));
      }
    } catch (...) {
      const std::scoped_lock lock{mutex_};
      if (!failure_) failure_ = std::current_exception();
    }
    is_limited = was_limited;
  }

  /// The piece to work on. Another thread is hired for those that are left as soon as a processor
  /// is free.
  std::size_t begin_piece() {
    const std::scoped_lock lock{mutex_};
    if (failure_ || next_ == count_) return count_;
    const std::size_t piece = next_++;
    const bool has_room = most_threads_ == kAllThreads || hired_ + 1 < most_threads_;
    if (next_ < count_ && has_room && vacancies().take()) {
      ++hired_;
      others_.emplace_back([this] {
        take_pieces();
        if (!is_replaced_by_caller()) vacancies().give_back();
      });
    }
    return piece;
  }

  /// The caller has nothing to do until those that it hired are done.
  bool lends_processor() {
    const std::scoped_lock lock{mutex_};
    is_lent_ = hired_ > 0;
    return is_lent_;
  }

  /// The last one that the caller waits for leaves its processor to it.
  bool is_replaced_by_caller() {
    const std::scoped_lock lock{mutex_};
    --hired_;
    return is_lent_ && hired_ == 0;
  }

  std::optional<std::jthread> next_to_join() {
    const std::scoped_lock lock{mutex_};
    if (others_.empty()) return std::nullopt;
    std::jthread other = std::move(others_.back());
    others_.pop_back();
    return other;
  }

  const std::size_t count_;
  const unsigned most_threads_;
  const std::function<void(std::size_t)>& work_;
  const Progress& progress_;
  std::mutex mutex_;  ///< guards what follows
  std::size_t next_ = 0;
  std::size_t done_ = 0;
  unsigned hired_ = 0;    ///< threads at work; none ends while another may be hired
  bool is_lent_ = false;  ///< the processor of the caller
  std::vector<std::jthread> others_;
  std::exception_ptr failure_;
};

}  // namespace

void for_each(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work,
              const Progress& progress) {
  Crew(count, threads, work, progress).run();
}

void together(const std::vector<std::function<void()>>& pieces) {
  for_each(pieces.size(), kAllThreads, [&](std::size_t i) { pieces[i](); }, {});
}

}  // namespace zerorate::parallel
