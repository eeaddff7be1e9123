#include "host_tools/lib/evaluate/corrected_writer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <iterator>
#include <system_error>

namespace zerorate::evaluate {
namespace {

constexpr std::size_t kFlushAt = std::size_t{1} << 16U;

}  // namespace

CorrectedWriter::CorrectedWriter(const std::filesystem::path& path, std::size_t axis_count)
    : path_(path), partial_(path), axis_count_(axis_count) {
  partial_ += fmt::format(".{}.partial", ::getpid());
  file_.reset(std::fopen(partial_.c_str(), "wb"));
  if (!file_) fail("create");
  auto out = std::back_inserter(text_);
  fmt::format_to(out, "t_s");
  for (std::size_t i = 0; i < axis_count_; ++i) {
    const std::string axis = axis_count_ == 1 ? "rate" : fmt::format("g{}", "xyz"[i]);
    fmt::format_to(out, ",{0}_dps,{0}_bias_dps,{0}_sigma_dps", axis);
  }
  fmt::format_to(out, ",motion\n");
}

CorrectedWriter::~CorrectedWriter() {
  if (!file_) return;
  file_.reset();
  std::error_code ignored;  // nothing more can be done about a file that nobody will see
  std::filesystem::remove(partial_, ignored);
}

void CorrectedWriter::write(const ReplayedSample& sample) {
  auto out = std::back_inserter(text_);
  const std::int64_t ns = sample.time_ns;
  fmt::format_to(out, "{}{}.{:09}", ns < 0 ? "-" : "", std::abs(ns / 1'000'000'000),
                 std::abs(ns % 1'000'000'000));
  for (std::size_t i = 0; i < axis_count_; ++i) {
    const app::AxisRate& axis = sample.message.axes[i];
    const bool has_bias = sample.message.health.calibrated;
    const auto cell = [&](bool known, core::AngularRate rate) {
      text_.push_back(',');
      if (known) fmt::format_to(out, "{:.7g}", rate.in(core::deg_per_s));
    };
    cell(sample.message.has_rate(), axis.corrected);
    cell(has_bias, axis.bias);
    cell(has_bias, axis.sigma);
  }
  fmt::format_to(out, ",{}\n", core::name(sample.message.motion));
  if (text_.size() >= kFlushAt) flush();
}

void CorrectedWriter::finish() {
  flush();
  if (std::fclose(file_.release()) != 0) fail("write");
  std::filesystem::rename(partial_, path_);
}

void CorrectedWriter::flush() {
  if (std::fwrite(text_.data(), 1, text_.size(), file_.get()) != text_.size()) fail("write");
  text_.clear();
}

void CorrectedWriter::fail(const char* action) const {
  throw std::system_error(errno, std::generic_category(),
                          fmt::format("cannot {} {}", action, partial_.string()));
}

}  // namespace zerorate::evaluate
