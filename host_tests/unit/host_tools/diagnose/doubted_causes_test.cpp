// Slow causes of a record whose bias was taken out upstream: none is sure.

#include "host_tools/lib/diagnose/doubted_causes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::diagnose {
namespace {

/// White noise and an Ornstein-Uhlenbeck process of 60 samples at 1 Hz, about as strong.
Record correlated_record() {
  const random::RandomStream white{21};
  const random::RandomStream driving{22};
  const double kept = std::exp(-1.0 / 60.0);
  Record record{.axis = "rate", .sample_period_s = 1.0, .mean_period_s = 1.0};
  double slow = 0.0;
  for (std::int64_t k = 0; k < 6'000; ++k) {
    slow = kept * slow + std::sqrt(1.0 - kept * kept) * driving.normal(k);
    record.time_s.push_back(static_cast<double>(k));
    record.rate_rad_s.push_back(1e-4 * (white.normal(k) + slow));
  }
  return record;
}

TEST(SlowCause, IsSureWhereTheMeanIsThatOfASensor) {
  const Diagnosis diagnosis = diagnose(correlated_record());
  ASSERT_FALSE(diagnosis.causes.empty());
  EXPECT_EQ(diagnosis.verdict, Verdict::explained);
  EXPECT_TRUE(std::ranges::any_of(diagnosis.causes, &Cause::stands_alone));
}

TEST(SlowCause, IsNotSureWhereABiasWasTakenOut) {
  Record record = correlated_record();
  record.is_bias_taken_out = true;
  const Diagnosis diagnosis = diagnose(std::move(record));
  ASSERT_FALSE(diagnosis.causes.empty());
  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
  for (const Cause& cause : diagnosis.causes) {
    EXPECT_FALSE(cause.stands_alone()) << cause.effect;
    EXPECT_EQ(cause.set95.front().effect, std::string(kByBiasTakenOut)) << cause.effect;
  }
  EXPECT_NE(diagnosis.extended_adequacy.failures.front().find("taken out upstream"),
            std::string::npos);
}

}  // namespace
}  // namespace zerorate::diagnose
