#include "host_tools/lib/evaluate/corrected_writer.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <iterator>

namespace zerorate::evaluate {
namespace {

constexpr std::size_t kFlushAt = std::size_t{1} << 16U;

}  // namespace

CorrectedWriter::CorrectedWriter(const std::filesystem::path& path, std::size_t axis_count)
    : file_(path), axis_count_(axis_count) {
  auto out = std::back_inserter(text_);
  fmt::format_to(out, "t_s");
  for (std::size_t i = 0; i < axis_count_; ++i) {
    const std::string axis = axis_count_ == 1 ? "rate" : fmt::format("g{}", "xyz"[i]);
    fmt::format_to(out, ",{0}_dps,{0}_bias_dps,{0}_sigma_dps", axis);
  }
  fmt::format_to(out, ",motion\n");
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
  file_.finish();
}

void CorrectedWriter::flush() {
  file_.write(text_);
  text_.clear();
}

}  // namespace zerorate::evaluate
