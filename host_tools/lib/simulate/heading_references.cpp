#include "host_tools/lib/simulate/heading_references.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "host_tools/lib/simulate/draws.hpp"
#include "host_tools/lib/simulate/require.hpp"

namespace zerorate::simulate {
namespace {

/// Distances between events, exponential around a mean; 0: the events never come.
class Events {
 public:
  Events(double mean_s, const random::RandomStream& stream) : mean_s_(mean_s), draws_(stream) {
    wait_from(0.0);
  }
  [[nodiscard]] bool is_due(double t_s) const { return t_s >= next_s_; }
  void wait_from(double t_s) {
    next_s_ =
        mean_s_ > 0.0 ? t_s + draws_.exponential(mean_s_) : std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] Draws& draws() { return draws_; }

 private:
  double mean_s_;
  Draws draws_;
  double next_s_ = 0.0;
};

class OutageWatch {
 public:
  OutageWatch(const Outages& outages, const random::RandomStream& stream)
      : mean_length_s_(outages.mean_length_s),
        events_(outages.mean_between_s, stream.substream("outages")) {}

  /// Times come in order.
  bool is_out(double t_s) {
    if (events_.is_due(t_s)) {
      ends_s_ = t_s + events_.draws().exponential(mean_length_s_);
      events_.wait_from(ends_s_);
    }
    return t_s < ends_s_;
  }

 private:
  double mean_length_s_;
  Events events_;
  double ends_s_ = 0.0;
};

class Reflections {
 public:
  Reflections(const Multipath& multipath, const random::RandomStream& stream)
      : multipath_(multipath), events_(multipath.mean_between_s, stream.substream("multipath")) {}

  /// Error of the heading; times come in order.
  double error_rad(double t_s) {
    if (events_.is_due(t_s)) {
      jump_rad_ = events_.draws().normal(multipath_.jump_sigma_rad);
      since_s_ = t_s;
      events_.wait_from(t_s);
    }
    return jump_rad_ * std::exp(-(t_s - since_s_) / multipath_.decay_s);
  }

 private:
  Multipath multipath_;
  Events events_;
  double jump_rad_ = 0.0;
  double since_s_ = 0.0;
};

void validate(const TrueCourse& truth) {
  require(truth.period_s > 0.0, "period_s: expected a time above 0");
  require(truth.heading_rad.size() == truth.speed_m_s.size(),
          "heading_rad and speed_m_s: expected as many of each");
}

/// Samples between two headings of a source.
std::size_t stride(const TrueCourse& truth, double rate_hz) {
  validate(truth);
  require(rate_hz > 0.0 && rate_hz * truth.period_s <= 1.0,
          "rate_hz: expected at most a heading a sample");
  return static_cast<std::size_t>(std::lround(1.0 / (rate_hz * truth.period_s)));
}

}  // namespace

std::vector<SensedHeading> GnssCourse::sense(const TrueCourse& truth,
                                             const random::RandomStream& stream) const {
  require(least_speed_m_s > 0.0 && delay_s >= 0.0,
          "least_speed_m_s and delay_s: expected a speed above 0 and a time from 0 on");
  const std::size_t step = stride(truth, rate_hz);
  const auto late = static_cast<std::size_t>(std::lround(delay_s / truth.period_s));
  OutageWatch watch{outages, stream};
  Reflections reflections{multipath, stream};
  Draws noise{stream.substream("noise")};
  std::vector<SensedHeading> headings;
  for (std::size_t k = 0; k + late < truth.heading_rad.size(); k += step) {
    const double t_s = static_cast<double>(k) * truth.period_s;
    const double speed_m_s = truth.speed_m_s[k];
    const double reflected_rad = reflections.error_rad(t_s);
    if (watch.is_out(t_s) || speed_m_s < least_speed_m_s) continue;
    const double sigma_rad = sigma_at_10_m_s_rad * 10.0 / speed_m_s;
    headings.push_back(
        {.time_s = static_cast<double>(k + late) * truth.period_s,
         .heading_rad = truth.heading_rad[k] + reflected_rad + noise.normal(sigma_rad),
         .sigma_rad = sigma_rad});
  }
  return headings;
}

std::vector<SensedHeading> TwoAntennas::sense(const TrueCourse& truth,
                                              const random::RandomStream& stream) const {
  require(baseline_m > 0.0, "baseline_m: expected a length above 0");
  const std::size_t step = stride(truth, rate_hz);
  const double sigma_rad = position_sigma_m / baseline_m;
  OutageWatch watch{outages, stream};
  Draws noise{stream.substream("noise")};
  std::vector<SensedHeading> headings;
  for (std::size_t k = 0; k < truth.heading_rad.size(); k += step) {
    const double t_s = static_cast<double>(k) * truth.period_s;
    if (watch.is_out(t_s)) continue;
    headings.push_back({.time_s = t_s,
                        .heading_rad = truth.heading_rad[k] + noise.normal(sigma_rad),
                        .sigma_rad = sigma_rad});
  }
  return headings;
}

std::vector<SensedHeading> Mark::sense(const TrueCourse& truth,
                                       const random::RandomStream& stream) const {
  require(after_s >= 0.0, "after_s: expected a time from 0 on");
  validate(truth);
  const auto after = static_cast<std::size_t>(std::lround(after_s / truth.period_s));
  Draws noise{stream.substream("noise")};
  std::vector<SensedHeading> headings;
  std::size_t rested = 0;  // samples of the stop so far
  for (std::size_t k = 0; k < truth.heading_rad.size(); ++k) {
    rested = truth.speed_m_s[k] == 0.0 ? rested + 1 : 0;
    if (rested != after + 1) continue;
    headings.push_back({.time_s = static_cast<double>(k) * truth.period_s,
                        .heading_rad = truth.heading_rad[k] + noise.normal(sigma_rad),
                        .sigma_rad = sigma_rad});
  }
  return headings;
}

}  // namespace zerorate::simulate
