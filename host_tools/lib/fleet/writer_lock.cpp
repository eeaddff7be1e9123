#include "host_tools/lib/fleet/writer_lock.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <limits>
#include <stdexcept>
#include <system_error>

namespace zerorate::fleet {

WriterLock::WriterLock(const std::filesystem::path& database)
    : descriptor_(::open(database.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), database.string());
  flock byte{};
  byte.l_type = F_WRLCK;
  byte.l_whence = SEEK_SET;
  byte.l_start = std::numeric_limits<off_t>::max() - 1;
  byte.l_len = 1;
  if (::fcntl(descriptor_, F_OFD_SETLK, &byte) == 0) return;
  const int reason = errno;
  ::close(descriptor_);
  if (reason == EAGAIN || reason == EACCES) {
    throw std::runtime_error(database.string() +
                             ": another process is writing to this database; give each worker one "
                             "of its own and join them with zerorate fleet merge");
  }
  throw std::system_error(reason, std::generic_category(), database.string());
}

WriterLock::~WriterLock() {
  ::close(descriptor_);
}

}  // namespace zerorate::fleet
