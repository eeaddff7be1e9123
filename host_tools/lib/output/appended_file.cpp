#include "host_tools/lib/output/appended_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace zerorate::output {

AppendedFile::AppendedFile(const std::filesystem::path& path, Begin begin) : path_(path) {
  constexpr mode_t kLessUmask = 0666;
  const int creation = begin == Begin::anew ? O_CREAT | O_EXCL : 0;
  descriptor_ =
      ::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK | creation, kLessUmask);
  if (descriptor_ < 0) fail(errno);
  struct stat status {};
  int reason = 0;
  if (::fstat(descriptor_, &status) != 0) {
    reason = errno;
  } else if (!S_ISREG(status.st_mode)) {
    reason = ESPIPE;
  } else if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    reason = errno == EWOULDBLOCK ? ETXTBSY : errno;
  }
  if (reason != 0) {
    (void)::close(descriptor_);
    fail(reason);
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

AppendedFile::~AppendedFile() {
  (void)::close(descriptor_);
}

void AppendedFile::append(std::string_view part) {
  for (std::size_t written = 0; written < part.size();) {
    const ssize_t count = ::pwrite(descriptor_, part.data() + written, part.size() - written,
                                   static_cast<off_t>(size_ + written));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int reason = errno;
      (void)!::ftruncate(descriptor_, static_cast<off_t>(size_));
      fail(reason);
    }
    written += static_cast<std::size_t>(count);
  }
  if (::fdatasync(descriptor_) != 0 && errno != EINVAL) fail(errno);
  size_ += part.size();
}

void AppendedFile::cut_to(std::uint64_t bytes) {
  if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) fail(errno);
  size_ = bytes;
}

void AppendedFile::fail(int reason) const {
  throw std::system_error(reason, std::generic_category(), path_.string());
}

}  // namespace zerorate::output
