/// @file
/// Recordings of a node's messages, also of interrupted ones.

#include "host_tools/lib/live/recorder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::live {
namespace {

using recording::Row;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kPeriod_ns = 10'000'000;
constexpr std::int64_t kUtc_ns = 1'700'000'000 * kSecond_ns;

wire::NumberedMessage message_at(std::uint32_t number, std::uint32_t pulses = 0) {
  wire::NumberedMessage numbered{.sequence = number, .message = {}};
  numbered.message.time = core::Instant::from_ns(5 * kSecond_ns + number * kPeriod_ns);
  float rate = 1e-3F * static_cast<float>(number);
  for (app::AxisRate& axis : numbered.message.axes) axis.measured = core::rad_per_s(rate += 0.5F);
  numbered.message.temperature = core::Temperature::from_degc(25.25F);
  numbered.message.odometer_pulses = pulses;
  return numbered;
}

/// Time of the wall clock at which the message comes.
std::int64_t utc_of(const wire::NumberedMessage& numbered) {
  return kUtc_ns + numbered.message.time.ns();
}

void feed(Recorder& recorder, std::uint32_t from, std::uint32_t to) {
  for (std::uint32_t number = from; number < to; ++number) {
    const auto message = message_at(number, number / 10);
    recorder.take(message, utc_of(message));
  }
}

struct Content {
  recording::Columns columns;
  std::vector<Row> rows;
  recording::Findings findings;
};
Content read(const std::filesystem::path& path) {
  recording::Reader reader{path};
  Content content{.columns = reader.columns(), .rows = {}, .findings = {}};
  for (Row row; reader.next(row);) content.rows.push_back(row);
  content.findings = reader.findings();
  return content;
}

class RecordingOfMessages : public ::testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] std::filesystem::path path() const { return folder_.path() / GetParam(); }
  [[nodiscard]] RecorderSettings settings(bool resumes = false) const {
    return {.path = path(), .resumes = resumes, .axis = {}, .comment = "a test"};
  }
  void cut_off(std::uintmax_t bytes) const {
    std::filesystem::resize_file(path(), std::filesystem::file_size(path()) - bytes);
  }

 private:
  testing::ScratchFolder folder_;
};

TEST_P(RecordingOfMessages, HoldsRateTemperatureAndPulsesBitForBit) {
  Recorder recorder{settings()};
  feed(recorder, 0, 1000);
  recorder.finish();
  const Content content = read(path());
  EXPECT_TRUE(content.columns.temperature && content.columns.odometer);
  EXPECT_FALSE(content.columns.still);
  ASSERT_EQ(content.rows.size(), 1000U);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Row& row = content.rows[i];
    const auto sent = message_at(i, i / 10);
    EXPECT_EQ(row.time_ns, utc_of(sent));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(row.rate_rad_s[axis], sent.message.axes[axis].measured.in(core::rad_per_s));
    }
    EXPECT_EQ(row.temperature_degc, 25.25F);
    EXPECT_EQ(row.odometer_pulses, i / 10);
    EXPECT_TRUE(row.findings.empty());
  }
  EXPECT_EQ(recorder.recorded_ns(), 999 * kPeriod_ns);
  EXPECT_EQ(recorder.counts().lost, 0U);
}

TEST_P(RecordingOfMessages, HoldsTheAccelerationBitForBit) {
  Recorder recorder{settings()};
  const auto force_at = [](std::uint32_t number, std::size_t axis) {
    return 0.1F * static_cast<float>(axis + 1) + 1e-3F * static_cast<float>(number);
  };
  constexpr std::uint32_t kSaturated = 7;  // a sample without
  for (std::uint32_t number = 0; number < 300; ++number) {
    auto message = message_at(number);
    for (std::size_t axis = 0; axis < 3 && number != kSaturated; ++axis) {
      if (!message.message.acceleration) message.message.acceleration.emplace();
      message.message.acceleration->at(axis) = core::m_per_s2(force_at(number, axis));
    }
    recorder.take(message, utc_of(message));
  }
  recorder.finish();
  const Content content = read(path());
  ASSERT_TRUE(content.columns.acceleration);
  ASSERT_EQ(content.rows.size(), 300U);
  for (std::uint32_t number = 0; number < 300; ++number) {
    const Row& row = content.rows[number];
    ASSERT_EQ(row.has_acceleration(), number != kSaturated);
    for (std::size_t axis = 0; axis < 3 && number != kSaturated; ++axis) {
      EXPECT_EQ(row.acceleration_m_s2[axis], force_at(number, axis));
    }
  }
}

TEST_P(RecordingOfMessages, HasNoColumnThatTheNodeDoesNotTell) {
  Recorder recorder{settings()};
  for (std::uint32_t number = 0; number < 300; ++number) {
    auto message = message_at(number);
    message.message.temperature.reset();
    message.message.odometer_pulses.reset();
    recorder.take(message, kUtc_ns);
  }
  recorder.finish();
  const Content content = read(path());
  EXPECT_FALSE(content.columns.temperature || content.columns.odometer);
  EXPECT_FALSE(content.columns.acceleration);
  EXPECT_EQ(content.rows.size(), 300U);
}

TEST_P(RecordingOfMessages, CountsWhatIsMissing) {
  Recorder recorder{settings()};
  feed(recorder, 0, 300);
  feed(recorder, 303, 400);  // three are lost
  auto late = message_at(398);
  recorder.take(late, utc_of(late));
  auto silent = message_at(400);
  silent.message.health.sensor_fault = true;
  recorder.take(silent, utc_of(silent));
  feed(recorder, 401, 410);
  recorder.finish();
  EXPECT_EQ(recorder.counts().lost, 3U);
  EXPECT_EQ(recorder.counts().out_of_order, 1U);
  EXPECT_EQ(recorder.counts().without_rate, 1U);
  EXPECT_EQ(recorder.counts().restarts, 0U);
  EXPECT_EQ(read(path()).rows.size(), 300U + 97U + 9U);
}

/// One message is damaged or forged: its time is an hour ahead, and its number is the next one.
TEST_P(RecordingOfMessages, LeavesOutOneThatIsAnHourAhead) {
  Recorder recorder{settings()};
  feed(recorder, 0, 300);
  auto ahead = message_at(300);
  ahead.message.time = ahead.message.time + core::Duration::seconds(3600);
  recorder.take(ahead, utc_of(message_at(300)));
  feed(recorder, 300, 600);
  recorder.finish();
  EXPECT_EQ(recorder.counts().out_of_order, 1U);
  EXPECT_EQ(recorder.counts().lost, 0U);
  EXPECT_EQ(read(path()).rows.size(), 600U);
}

TEST_P(RecordingOfMessages, FollowsAClockThatStaysAnHourAhead) {
  Recorder recorder{settings()};
  feed(recorder, 0, 300);
  for (std::uint32_t number = 300; number < 600; ++number) {
    auto ahead = message_at(number);
    ahead.message.time = ahead.message.time + core::Duration::seconds(3600);
    recorder.take(ahead, utc_of(ahead));
  }
  recorder.finish();
  EXPECT_EQ(recorder.counts().out_of_order, 1U);
  EXPECT_EQ(read(path()).rows.size(), 599U);
}

TEST_P(RecordingOfMessages, FollowsANodeThatRestarts) {
  Recorder recorder{settings()};
  feed(recorder, 0, 300);
  // Another boot: numbers, time and pulses begin anew, five seconds later.
  const std::int64_t boot_ns = utc_of(message_at(300)) + 5 * kSecond_ns;
  for (std::uint32_t number = 0; number < 100; ++number) {
    auto message = message_at(number, 2);
    message.message.time = core::Instant::from_ns(number * kPeriod_ns);
    recorder.take(message, boot_ns + number * kPeriod_ns);
  }
  recorder.finish();
  EXPECT_EQ(recorder.counts().restarts, 1U);
  EXPECT_EQ(recorder.counts().pauses, 1U);
  const Content content = read(path());
  ASSERT_EQ(content.rows.size(), 400U);
  EXPECT_EQ(content.rows[300].time_ns, boot_ns);
  EXPECT_EQ(content.rows[299].odometer_pulses, 29);
  EXPECT_EQ(content.rows[300].odometer_pulses, 29 + 1 + 2) << "it may have moved meanwhile";
  EXPECT_EQ(recorder.recorded_ns(), (299 + 99) * kPeriod_ns) << "a pause is not recorded time";
}

TEST_P(RecordingOfMessages, GoesOnAfterAnInterruption) {
  {
    Recorder recorder{settings()};
    feed(recorder, 0, 400);
    recorder.finish();
  }
  Recorder recorder{settings(true)};
  EXPECT_EQ(recorder.rows(), 400U);
  EXPECT_EQ(recorder.recorded_ns(), 399 * kPeriod_ns);
  feed(recorder, 500, 600);
  recorder.finish();
  const Content content = read(path());
  ASSERT_EQ(content.rows.size(), 500U);
  EXPECT_EQ(content.rows[400].time_ns, utc_of(message_at(500)));
  EXPECT_EQ(content.rows[400].odometer_pulses, 39 + 1);
  EXPECT_EQ(recorder.recorded_ns(), (399 + 99) * kPeriod_ns);
}

TEST_P(RecordingOfMessages, LosesNothingFlushed) {
  for (const std::uintmax_t cut : {1U, 5U, 100U}) {
    std::filesystem::remove(path());
    {
      Recorder recorder{settings()};
      feed(recorder, 0, 400);
      recorder.flush();
      feed(recorder, 400, 800);
      recorder.finish();
    }
    cut_off(cut);
    Recorder recorder{settings(true)};
    EXPECT_GE(recorder.rows(), 400U);
    EXPECT_GT(recorder.torn_bytes(), 0U);
    feed(recorder, 900, 1000);
    recorder.finish();
    const Content content = read(path());
    EXPECT_EQ(content.rows.size(), recorder.rows());
    EXPECT_EQ(content.rows.back().time_ns, utc_of(message_at(999)));
  }
}

TEST_P(RecordingOfMessages, DoesNotGoBackWithAClockThatWasSetBack) {
  {
    Recorder recorder{settings()};
    feed(recorder, 0, 300);
    recorder.finish();
  }
  Recorder recorder{settings(true)};
  for (std::uint32_t number = 300; number < 400; ++number) {
    recorder.take(message_at(number), 1000 * kSecond_ns);  // 1970: a board without a clock
  }
  recorder.finish();
  EXPECT_EQ(recorder.counts().set_back, 1U);
  const Content content = read(path());
  EXPECT_EQ(content.rows[300].time_ns - content.rows[299].time_ns, 2 * kSecond_ns);
  EXPECT_EQ(content.findings.count(recording::Finding::clock_step), 0U);
}

TEST_P(RecordingOfMessages, TouchesNoFileThatIsThereAlready) {
  std::ofstream{path()} << "mine";
  Recorder recorder{settings()};
  EXPECT_THROW(feed(recorder, 0, 300), recording::Error);
  EXPECT_THROW(Recorder{settings(true)}, recording::Error) << "no recording";
  std::ifstream file{path()};
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>{file}, {}), "mine");
}

TEST_P(RecordingOfMessages, IsWholeOnAFullDisk) {
  Recorder recorder{settings()};
  feed(recorder, 0, 400);
  recorder.flush();
  feed(recorder, 400, 2000);
  {
    const testing::FileSizeLimit limit{std::filesystem::file_size(path()) + 100};
    EXPECT_THROW(recorder.flush(), recording::Error);
  }
  EXPECT_EQ(read(path()).rows.size(), 400U);
  recorder.finish();  // there is room again
  EXPECT_EQ(read(path()).rows.size(), 2000U);
}

TEST_P(RecordingOfMessages, IsOfOneProgramAtATime) {
  Recorder first{settings()};
  feed(first, 0, 300);
  first.flush();
  EXPECT_THROW(Recorder{settings(true)}, recording::Error);
}

TEST_P(RecordingOfMessages, RefusesToGoOnWithOtherColumns) {
  {
    Recorder recorder{settings()};
    feed(recorder, 0, 300);
    recorder.finish();
  }
  RecorderSettings of_one_axis = settings(true);
  of_one_axis.axis = 2;
  EXPECT_THROW(Recorder{of_one_axis}, recording::Error);
  Recorder recorder{settings(true)};
  auto message = message_at(300);
  message.message.odometer_pulses.reset();
  EXPECT_THROW(recorder.take(message, utc_of(message)), recording::Error);
}

TEST_P(RecordingOfMessages, MayHaveOneAxis) {
  RecorderSettings of_z = settings();
  of_z.axis = 2;
  Recorder recorder{of_z};
  feed(recorder, 0, 300);
  recorder.finish();
  const Content content = read(path());
  EXPECT_EQ(content.columns.axis_count, 1U);
  EXPECT_EQ(content.rows[7].rate_rad_s[0],
            message_at(7).message.axes[2].measured.in(core::rad_per_s));
}

INSTANTIATE_TEST_SUITE_P(Formats, RecordingOfMessages,
                         ::testing::Values("recording.csv.gz", "recording.csv"),
                         [](const auto& format) {
                           return std::string{format.param}.ends_with(".gz") ? "Packed" : "Plain";
                         });

}  // namespace
}  // namespace zerorate::live
