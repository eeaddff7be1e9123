#include "host_tools/lib/contest/rival.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "host_tools/lib/contest/exponential_means.hpp"
#include "host_tools/lib/contest/script.hpp"
#include "host_tools/lib/recording/column_names.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/number.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::contest {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

bool stands(const evaluate::ReplayedSample& sample) {
  return sample.message.motion == core::Motion::still;
}

/// Exponential mean of the samples that the node's messages call still, held on the way.
class ExponentialMean : public RivalBias {
 public:
  explicit ExponentialMean(double memory_s) : memory_s_(memory_s) {}

 private:
  Biases follow(const evaluate::ReplayedSample& sample, const Biases& before) override {
    const app::RateMessage& message = sample.message;
    const double elapsed_s = has_time_ ? double{(message.time - newest_).in_seconds()} : 0.0;
    newest_ = message.time;
    has_time_ = true;
    if (!stands(sample) || !message.has_rate()) return before;
    const double weight = exponential_weight(elapsed_s, memory_s_, ++samples_);
    Biases after{};
    for (std::size_t i = 0; i < after.size(); ++i) {
      const double rate = double{message.axes[i].measured.in(core::rad_per_s)};
      after[i] = samples_ > 1.0 ? before[i] + weight * (rate - before[i]) : rate;
    }
    return after;
  }

  double memory_s_;
  core::Instant newest_;
  bool has_time_ = false;
  double samples_ = 0.0;
};

/// The log once more, row by row beside the replay.
class RowsBeside {
 public:
  explicit RowsBeside(const recording::Input& input) : reader_(input) {}

  /// The row of a sample; samples come in their order.
  const recording::Row& at(const evaluate::ReplayedSample& sample) {
    while (rows_ <= sample.row && reader_.next(row_)) ++rows_;
    return row_;
  }
  [[nodiscard]] const recording::Columns& columns() const { return reader_.columns(); }

 private:
  recording::Reader reader_;
  recording::Row row_;
  std::uint64_t rows_ = 0;
};

/// Bias estimates in columns of the log.
class ColumnBias : public RivalBias {
 public:
  /// @param axes  axes of the columns
  ColumnBias(const recording::Input& columns, std::vector<std::size_t> axes)
      : rows_(columns), axes_(std::move(axes)) {}

 private:
  Biases follow(const evaluate::ReplayedSample& sample, const Biases& before) override {
    const recording::Row& row = rows_.at(sample);
    Biases after = before;
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      const double bias = double{row.rate_rad_s[k]};
      if (std::isfinite(bias)) after[axes_[k]] = bias;
    }
    return after;
  }

  RowsBeside rows_;
  std::vector<std::size_t> axes_;
};

/// Unit that the name of a column gives: "mine_dph", "mine [deg/h]".
std::optional<recording::Unit> unit_of(std::string_view name) {
  using recording::Dimension;
  if (const auto unit = recording::unit_in_name(Dimension::rate, name)) return unit;
  const std::size_t line = name.rfind('_');
  if (line == std::string_view::npos) return std::nullopt;
  return recording::parse_unit(Dimension::rate, name.substr(line + 1));
}

/// Unit of the columns: that of their names, of --units, or of rates in deg/s.
recording::Unit unit_of_columns(const Rival& rival, const recording::Input& input) {
  const std::string& first = rival.columns.front();
  const auto unit = unit_of(first);
  for (const std::string& name : rival.columns) {
    if (unit_of(name) == unit) continue;
    throw recording::DataError(fmt::format("the columns {} and {} have different units",
                                           recording::excerpt(first), recording::excerpt(name)));
  }
  if (unit) return *unit;
  const auto said = input.layout.units.find(recording::Dimension::rate);
  if (said != input.layout.units.end()) return said->second;
  if (recording::Reader{input}.columns().rate_unit == recording::RateUnit::deg_per_s) {
    return *recording::parse_unit(recording::Dimension::rate, "dps");
  }
  throw recording::DataError(
      fmt::format("the name of the column {} gives no unit; name it {}_dps, {}_dph or {}_radps, or "
                  "say --units rate=... with --columns",
                  recording::excerpt(first), first, first, first));
}

/// The log with the columns of bias estimates as its rates.
recording::Input bias_columns(const Rival& rival, const recording::Input& input) {
  recording::Input biases = input;
  auto& columns = biases.layout.columns;
  for (const char* const key : {"gx", "gy", "gz", "rate"}) columns.erase(key);
  for (std::size_t k = 0; k < rival.columns.size(); ++k) {
    columns[rival.columns.size() == 1 ? "rate" : std::array{"gx", "gy", "gz"}[k]] =
        rival.columns[k];
  }
  biases.layout.units[recording::Dimension::rate] = unit_of_columns(rival, input);
  return biases;
}

std::unique_ptr<RivalBias> make_column(const Rival& rival, const recording::Input& input,
                                       const std::vector<std::size_t>& axes) {
  const std::size_t recorded = recording::Reader{input}.columns().axis_count;
  const std::size_t given = rival.columns.size();
  if (given == recorded) {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < recorded; ++i) all.push_back(i);
    return std::make_unique<ColumnBias>(bias_columns(rival, input), std::move(all));
  }
  if (given == 1 && axes.size() == 1) {
    return std::make_unique<ColumnBias>(bias_columns(rival, input), axes);
  }
  throw std::invalid_argument(
      fmt::format("--against column: {} column{} for {} axes; name one for each, or one and its "
                  "axis by --axis",
                  given, given == 1 ? "" : "s", recorded));
}

/// Biases that a program gave after each stretch of rest.
class ScriptBias : public RivalBias {
 public:
  explicit ScriptBias(std::vector<std::array<double, 3>> after_stops)
      : after_stops_(std::move(after_stops)) {}

 private:
  Biases follow(const evaluate::ReplayedSample& sample, const Biases& before) override {
    const bool stood = std::exchange(stands_, stands(sample));
    if (stood && !stands_ && stop_ < after_stops_.size()) return after_stops_[stop_++];
    return before;
  }

  std::vector<std::array<double, 3>> after_stops_;
  std::size_t stop_ = 0;
  bool stands_ = false;
};

/// The rows at rest as a program gets them; a stop has a number from 1 on.
class RestRows {
 public:
  RestRows(const recording::Input& input, std::FILE* file) : rows_(input), file_(file) {
    const recording::Columns& columns = rows_.columns();
    fmt::print(file_, "stop,t_s,{}{}\n",
               columns.axis_count == 1 ? "rate_dps" : "gx_dps,gy_dps,gz_dps",
               columns.temperature ? ",temp_c" : "");
  }

  void take(const evaluate::ReplayedSample& sample) {
    const recording::Row& row = rows_.at(sample);
    const bool stood = std::exchange(stands_, stands(sample));
    if (stands_ && !stood) ++stops_;
    if (!stands_ || !sample.message.has_rate()) return;
    fmt::print(file_, "{},{:.6f}", stops_, units::seconds(sample.time_ns));
    for (std::size_t i = 0; i < rows_.columns().axis_count; ++i) {
      fmt::print(file_, ",{:.9g}", double{row.rate_rad_s[i]} * units::kDegPerRad);
    }
    if (rows_.columns().temperature) fmt::print(file_, ",{:.4f}", row.temperature_degc);
    fmt::print(file_, "\n");
  }

  [[nodiscard]] std::size_t stops() const { return stops_; }

 private:
  RowsBeside rows_;
  std::FILE* file_;
  bool stands_ = false;
  std::size_t stops_ = 0;
};

std::unique_ptr<RivalBias> make_script(const Rival& rival, const recording::Input& input,
                                       const evaluate::ReplayOptions& replay) {
  Script script{rival.command, rival.limit_s};
  RestRows rest{input, script.input()};
  recording::Reader reader{input};
  (void)evaluate::replay(reader, replay, {.on_sample = [&](const evaluate::ReplayedSample& sample) {
                           rest.take(sample);
                         }});
  const std::size_t axes = reader.columns().axis_count;
  return std::make_unique<ScriptBias>(biases_of(script.run(), rest.stops(), axes));
}

}  // namespace

const RivalBias::Biases RivalBias::kUnknown{kNone, kNone, kNone};

void RivalBias::take(const evaluate::ReplayedSample& sample) {
  const bool stood = std::exchange(stood_, stands(sample));
  // A stop in which the calm is doubted for a while is still one: no drive parts it.
  if (stood_ && std::exchange(has_driven_, false)) held_rad_s_ = driven_rad_s_;
  bias_rad_s_ = follow(sample, bias_rad_s_);
  const bool is_driving = motion_.moves(sample);
  // Rest may have begun where the node still settles: what is learnt there came too late.
  if (is_driving || (stood && !stood_)) driven_rad_s_ = bias_rad_s_;
  has_driven_ = (has_driven_ || is_driving) && !stood_;
}

std::string Rival::name() const {
  switch (kind) {
    case Kind::last_mean:
      return "mean of the last stop";
    case Kind::exponential:
      return fmt::format("exponential mean of {:g} s", memory_s);
    case Kind::column:
      return fmt::format("column{} {}", columns.size() == 1 ? "" : "s", fmt::join(columns, ","));
    case Kind::script:
      return "program " + command;
  }
  return "unknown";
}

Rival parse_rival(std::string_view text) {
  const auto tail = [&](std::string_view word) {
    return text.starts_with(word) ? text.substr(word.size()) : std::string_view{};
  };
  if (text == "last-mean") return {};
  if (const std::string_view seconds = tail("exponential:"); !seconds.empty()) {
    const auto memory_s = recording::parse_real(seconds);
    if (memory_s && *memory_s > 0.0 && std::isfinite(*memory_s)) {
      return {.kind = Rival::Kind::exponential, .memory_s = *memory_s};
    }
  }
  if (std::string_view names = tail("column:"); !names.empty()) {
    Rival rival{.kind = Rival::Kind::column};
    while (true) {
      const std::size_t comma = names.find(',');
      rival.columns.emplace_back(names.substr(0, comma));
      if (comma == std::string_view::npos) break;
      names.remove_prefix(comma + 1);
    }
    if (rival.columns.size() == 1 || rival.columns.size() == 3) return rival;
  }
  if (const std::string_view command = tail("script:"); !command.empty()) {
    return {.kind = Rival::Kind::script, .command = std::string{command}};
  }
  throw std::invalid_argument(
      "--against: expected last-mean, exponential:SECONDS, as in exponential:30, column:NAME (or "
      "three names for x, y and z) or script:COMMAND");
}

std::unique_ptr<RivalBias> make_rival(const Rival& rival, const recording::Input& input,
                                      const std::vector<std::size_t>& axes,
                                      const evaluate::ReplayOptions& replay) {
  switch (rival.kind) {
    case Rival::Kind::last_mean:
      break;
    case Rival::Kind::exponential:
      return std::make_unique<ExponentialMean>(rival.memory_s);
    case Rival::Kind::column:
      return make_column(rival, input, axes);
    case Rival::Kind::script:
      return make_script(rival, input, replay);
  }
  return nullptr;
}

}  // namespace zerorate::contest
