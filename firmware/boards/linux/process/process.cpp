#include "firmware/boards/linux/process/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <grp.h>
#include <pwd.h>
#include <sched.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <system_error>

namespace zerorate::linux_node {
namespace {

using hal::linux_os::Descriptor;

[[noreturn]] void fail(int error, const std::string& tried) {
  throw std::system_error(error, std::generic_category(), tried);
}

/// Limits of another user are those that root leaves behind.
void allow(int resource, rlim_t limit) {
  const rlimit both{.rlim_cur = limit, .rlim_max = limit};
  (void)setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

void become(const std::string& user) {
  errno = 0;
  const passwd* const entry = getpwnam(user.c_str());
  if (entry == nullptr) fail(errno != 0 ? errno : ENOENT, "user \"" + user + "\"");
  if (initgroups(user.c_str(), entry->pw_gid) != 0 || setgid(entry->pw_gid) != 0 ||
      setuid(entry->pw_uid) != 0) {
    fail(errno, "becoming user \"" + user + "\"");
  }
}

/// @param flags  of sendto()
void send_to_service_manager(std::string_view message, int flags) {
  const char* const named = std::getenv("NOTIFY_SOCKET");
  if (named == nullptr) return;
  const std::string_view path{named};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) return;
  std::ranges::copy(path, std::begin(address.sun_path));
  if (path.front() == '@') address.sun_path[0] = '\0';  // a name in the abstract namespace
  const hal::linux_os::Descriptor socket{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  (void)!sendto(socket.get(), message.data(), message.size(), MSG_NOSIGNAL | flags,
                reinterpret_cast<const sockaddr*>(&address), size);
}

}  // namespace

void become_user(const std::string& user, const RealTimeSettings& real_time) {
  if (geteuid() != 0 || user.empty()) return;
  allow(RLIMIT_MEMLOCK, RLIM_INFINITY);
  allow(RLIMIT_RTPRIO, static_cast<rlim_t>(real_time.priority));
  become(user);
}

void lock_memory(const RealTimeSettings& real_time, const Log& log) {
  if (real_time.lock_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    log(fmt::format("memory cannot be locked: {}", std::strerror(errno)));
  }
}

Descriptor lock_state(const std::string& file) {
  constexpr mode_t kOwnerOnly = 0600;
  constexpr int kFlags = O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  Descriptor lock{::open((file + ".lock").c_str(), kFlags, kOwnerOnly)};
  if (lock.is_open() && flock(lock.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw std::runtime_error("state \"" + file + "\" is in use by another process");
  }
  return lock;
}

void notify_service_manager(std::string_view message) {
  send_to_service_manager(message, 0);
}

void feed_watchdog() {
  const bool is_watched = std::getenv("WATCHDOG_USEC") != nullptr;
  if (is_watched) send_to_service_manager("WATCHDOG=1", MSG_DONTWAIT);
}

MeasuringThread::MeasuringThread(int priority, std::function<void()> turn,
                                 std::function<void()> wake, const Log& log)
    : turn_(std::move(turn)), wake_(std::move(wake)) {
  constexpr std::size_t kStackBytes = 262'144;
  pthread_attr_t attributes{};
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  if (priority > 0) {
    const sched_param scheduling{.sched_priority = priority};
    pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(&attributes, SCHED_FIFO);
    pthread_attr_setschedparam(&attributes, &scheduling);
  }
  int error = pthread_create(&thread_, &attributes, run, this);
  if (error == EPERM && priority > 0) {
    log("real-time priority is not permitted; measuring as an ordinary thread");
    pthread_attr_setinheritsched(&attributes, PTHREAD_INHERIT_SCHED);
    error = pthread_create(&thread_, &attributes, run, this);
  }
  // The limit of locked memory may hold the program and not its stack too.
  if (error == EAGAIN && munlockall() == 0) {
    log("memory cannot be locked: the limit (ulimit -l) is too small for the measuring thread");
    error = pthread_create(&thread_, &attributes, run, this);
  }
  pthread_attr_destroy(&attributes);
  if (error != 0) fail(error, "starting the measuring thread");
}

MeasuringThread::~MeasuringThread() {
  is_ending_ = true;
  wake_();
  pthread_join(thread_, nullptr);
}

void* MeasuringThread::run(void* self) {
  auto* const thread = static_cast<MeasuringThread*>(self);
  while (!thread->is_ending_) thread->turn_();
  return nullptr;
}

}  // namespace zerorate::linux_node
