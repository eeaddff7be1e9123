/// @file
/// Requests to the kernel (locked memory, priority, user, a lock on the state) and messages to the
/// service manager.
#pragma once

#include <pthread.h>

#include <atomic>
#include <functional>
#include <string>
#include <string_view>

#include "firmware/boards/linux/process/log.hpp"
#include "hal/linux/descriptor.hpp"

namespace zerorate::linux_node {

/// How urgent the measuring is.
struct RealTimeSettings {
  int priority = 0;  ///< SCHED_FIFO priority of the measuring thread; 0: an ordinary thread
  bool lock_memory = true;
};

/// Becomes `user`, with that user's groups and the right to what `real_time` asks for, where the
/// process is root. Throws std::system_error for a user that does not exist, or that one cannot
/// become, so that nothing runs as root by mistake.
/// @param user  empty: stays the user that started the process
void become_user(const std::string& user, const RealTimeSettings& real_time);

/// Locks the memory that the process has and will have, where that is wanted; what is not permitted
/// is logged and left. After all that needs much memory was made: from a limit of locked memory on
/// that holds the process as it is, none could be added.
void lock_memory(const RealTimeSettings& real_time, const Log& log);

/// Keeps a state to this process, as long as the descriptor is open, by a lock on FILE.lock. Throws
/// std::runtime_error where another process has it. Gives a closed descriptor where the lock cannot
/// be made: then nothing can be saved there either, which is reported at the save.
[[nodiscard]] hal::linux_os::Descriptor lock_state(const std::string& file);

/// Sends systemd one message, such as "READY=1", by its notification protocol (sd_notify(3)): a
/// datagram to the socket that $NOTIFY_SOCKET names. Without the variable nothing is sent.
void notify_service_manager(std::string_view message);

/// Sends "WATCHDOG=1" where the watchdog ($WATCHDOG_USEC) is on: due at least once in half of that
/// time. Never waits for a service manager that does not read.
void feed_watchdog();

/// A thread with a fixed, small stack and, where that is permitted, a real-time priority.
class MeasuringThread {
 public:
  /// @param turn  is called again and again until the end
  /// @param wake  ends a turn that sleeps
  MeasuringThread(int priority, std::function<void()> turn, std::function<void()> wake,
                  const Log& log);
  MeasuringThread(const MeasuringThread&) = delete;
  MeasuringThread& operator=(const MeasuringThread&) = delete;
  /// Waits for the end of the present turn.
  ~MeasuringThread();

 private:
  static void* run(void* self);

  std::function<void()> turn_;
  std::function<void()> wake_;
  std::atomic<bool> is_ending_ = false;
  pthread_t thread_{};
};

}  // namespace zerorate::linux_node
