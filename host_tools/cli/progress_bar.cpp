#include "host_tools/cli/progress_bar.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace zerorate::cli {

ProgressBar::ProgressBar(std::string what)
    : what_(std::move(what)), visible_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void ProgressBar::update(std::optional<double> share, const std::string& remark) {
  const auto now = Clock::now();
  if (!visible_ || now - drawn_at_ < std::chrono::milliseconds(100)) return;
  drawn_at_ = now;
  drawn_ = true;
  const double elapsed_s = std::chrono::duration<double>(now - started_).count();
  if (!share) {
    fmt::print(stderr, "\r\033[K{} {:.0f} s", what_, elapsed_s);
  } else {
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(std::clamp(*share, 0.0, 1.0) * kWidth);
    fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} %", what_, "", filled, "",
               kWidth - filled, *share * 100.0);
    if (*share > 0.02) fmt::print(stderr, ", {:.0f} s left", elapsed_s * (1.0 / *share - 1.0));
  }
  if (!remark.empty()) fmt::print(stderr, ", {}", remark);
  std::fflush(stderr);
}

}  // namespace zerorate::cli
