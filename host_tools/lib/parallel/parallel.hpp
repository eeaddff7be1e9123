/// @file
/// Independent pieces of work on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace zerorate::parallel {

/// Told, from one thread at a time, what share of the work is done, 0 to 1.
using Progress = std::function<void(double share)>;

/// Calls work(0) .. work(count - 1), each once, on `threads` threads (0: as many as the machine
/// has). Each piece writes its own result, so that nothing depends on the number of threads. The
/// first exception ends the rest and is thrown again here.
void for_each(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work,
              const Progress& progress);

}  // namespace zerorate::parallel
