#include "host_tools/lib/output/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <random>
#include <system_error>

namespace zerorate::output {
namespace {

/// Names of the temporary files for the signal handler, which must not allocate or lock. A file
/// that finds no free place is only removed by its destructor.
constexpr std::size_t kMostRegistered = 8;
std::array<std::atomic<const char*>, kMostRegistered> registered_files;
static_assert(std::atomic<const char*>::is_always_lock_free);

std::atomic<const char*>* register_file(const char* name) {
  for (auto& place : registered_files) {
    const char* free = nullptr;
    if (place.compare_exchange_strong(free, name)) return &place;
  }
  return nullptr;
}

void remove_registered_files(int signal) {
  for (const auto& place : registered_files) {
    if (const char* const name = place.load()) (void)::unlink(name);
  }
  (void)::raise(signal);  // the action is the default one again: SA_RESETHAND
}

/// The suffix keeps apart the files of processes that share a folder but not their process numbers.
std::string partial_name(const std::filesystem::path& path) {
  return path.string() + '.' + std::to_string(std::random_device{}()) + ".partial";
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : path_(path) {
  struct stat existing {};
  const bool exists = ::stat(path.c_str(), &existing) == 0;
  if (exists && !S_ISREG(existing.st_mode)) {
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
    if (descriptor_ < 0) fail();
    return;
  }
  if (exists) path_ = std::filesystem::canonical(path);
  open_partial();
  constexpr mode_t kPermissions = 07777;
  if (exists) (void)::fchmod(descriptor_, existing.st_mode & kPermissions);
}

OutputFile::~OutputFile() {
  close_descriptor();
  if (partial_.empty()) return;
  (void)::unlink(partial_.c_str());
  forget_partial();
}

void OutputFile::open_partial() {
  partial_ = partial_name(path_);
  registered_ = register_file(partial_.c_str());
  constexpr mode_t kLessUmask = 0666;
  descriptor_ = ::open(partial_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kLessUmask);
  if (descriptor_ >= 0) return;
  const int reason = errno;
  forget_partial();
  errno = reason;
  fail();
}

void OutputFile::write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void OutputFile::finish() {
  const int closed = ::close(descriptor_);  // some file systems report a full disk only here
  descriptor_ = -1;
  if (closed != 0) fail();
  if (partial_.empty()) return;
  replace_file(partial_, path_);
  forget_partial();
}

namespace {

void sync(const std::filesystem::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  const bool is_synced = descriptor >= 0 && (::fsync(descriptor) == 0 || errno == EINVAL);
  const int reason = errno;
  if (descriptor >= 0) (void)::close(descriptor);
  if (is_synced) return;
  throw std::system_error(reason, std::generic_category(), "cannot write " + path.string());
}

}  // namespace

void replace_file(const std::filesystem::path& written, const std::filesystem::path& name) {
  sync(written, O_RDONLY);
  if (std::rename(written.c_str(), name.c_str()) != 0) {
    throw std::system_error(errno, std::generic_category(), "cannot write " + name.string());
  }
  sync(std::filesystem::absolute(name).parent_path(), O_RDONLY | O_DIRECTORY);
}

void OutputFile::close_descriptor() {
  if (descriptor_ >= 0) (void)::close(descriptor_);
  descriptor_ = -1;
}

void OutputFile::forget_partial() {
  if (registered_ != nullptr) registered_->store(nullptr);
  registered_ = nullptr;
  partial_.clear();
}

void OutputFile::fail() const {
  throw std::system_error(errno, std::generic_category(), "cannot write " + path_.string());
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  OutputFile file{path};
  file.write(text);
  file.finish();
}

void remove_partial_files_on_signals() {
  for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = remove_registered_files;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    (void)::sigaction(signal, &action, nullptr);
  }
}

}  // namespace zerorate::output
