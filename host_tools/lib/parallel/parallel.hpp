/// @file
/// Independent pieces of work on several threads, and values that they share.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace zerorate::parallel {

/// Told, from one thread at a time, what share of the work is done, 0 to 1.
using Progress = std::function<void(double share)>;

/// Number that stands for as many threads as the machine has.
inline constexpr unsigned kAllThreads = 0;

/// Calls work(0) .. work(count - 1), each once, on at most so many threads. Each piece writes its
/// own result, so that nothing depends on the number of threads. The first exception ends the rest
/// and is thrown again here. Pieces may have pieces of their own: all calls together keep the
/// processors busy, with no more threads than there are processors. Inside of a call with a number
/// of threads each piece keeps to its thread.
void for_each(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work,
              const Progress& progress);

/// Runs pieces of work that are not alike, as for_each() does.
void together(const std::vector<std::function<void()>>& pieces);

/// A value that is made when it is first asked for, by one thread for all. Copies share it.
template <class T>
class Lazy {
 public:
  /// @param make  gives the value; the same at each call
  template <class Make>
  [[nodiscard]] const T& get(Make make) const {
    std::call_once(made_->once, [&] { made_->value = make(); });
    return made_->value;
  }

 private:
  struct Made {
    std::once_flag once;
    T value{};
  };
  std::shared_ptr<Made> made_ = std::make_shared<Made>();
};

}  // namespace zerorate::parallel
