/// @file
/// A gyro whose samples are watched for a chip that froze.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "drivers/common/any_gyro.hpp"
#include "drivers/common/repetition.hpp"

namespace zerorate::linux_node {

/// The samples in a row that noise makes alike on one axis once in 10^12, if it is half of what the
/// model says and the rate lies in the middle between two counts' borders: there a value returns
/// with the probability erf(1 / (2 sqrt(2) sigma / lsb)). At least those of half a second, because
/// a filter makes neighbours alike; Repetition::kEndless where the noise is too small to tell.
/// @param sigma of one sample, in the unit of the LSB
[[nodiscard]] std::uint32_t longest_repetition(double sigma, double lsb, double rate_hz);

/// Passes a gyro on. A frozen one gives that error instead of samples, so that the loop starts it
/// again and again; what it froze at is no sample until another value has come.
class WatchedGyro final : public drivers::AnyGyro {
 public:
  WatchedGyro(std::unique_ptr<drivers::AnyGyro> gyro, drivers::Repetition repetition)
      : gyro_(std::move(gyro)), repetition_(repetition) {}

  core::Result<void, drivers::DriverError> start(core::Instant now) override {
    return gyro_->start(now);
  }
  core::Result<std::size_t, drivers::DriverError> read(core::Instant now,
                                                       std::span<drivers::GyroSample> out) override;
  core::Result<void, drivers::DriverError> verify_next() override { return gyro_->verify_next(); }
  [[nodiscard]] core::Duration sample_period() const override { return gyro_->sample_period(); }
  [[nodiscard]] bool is_batched() const override { return gyro_->is_batched(); }

 private:
  std::unique_ptr<drivers::AnyGyro> gyro_;
  drivers::Repetition repetition_;
};

}  // namespace zerorate::linux_node
