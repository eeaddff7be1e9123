#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::recording {
namespace {

using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Bytes of a message, laid out by hand: the encapsulation, then each field at a multiple of its
/// size.
class Message {
 public:
  explicit Message(bool is_big_endian) : is_big_endian_(is_big_endian) {
    bytes_ = {0, static_cast<char>(is_big_endian ? 0 : 1), 0, 0};
  }

  Message& u32(std::uint32_t value) {
    pad(4);
    return append(value);
  }
  Message& f64(std::initializer_list<double> values) {
    for (const double value : values) {
      pad(8);
      append(std::bit_cast<std::uint64_t>(value));
    }
    return *this;
  }
  Message& zeros(int count) {
    for (int i = 0; i < count; ++i) f64({0.0});
    return *this;
  }
  Message& text(const std::string& text) {
    u32(static_cast<std::uint32_t>(text.size() + 1));
    bytes_ += text + '\0';
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  void pad(std::size_t size) {
    while ((bytes_.size() - 4) % size != 0) bytes_ += '\xEE';
  }
  template <class Unsigned>
  Message& append(Unsigned value) {
    for (std::size_t i = 0; i < sizeof value; ++i) {
      const std::size_t byte = is_big_endian_ ? sizeof value - 1 - i : i;
      bytes_ += static_cast<char>(value >> (8 * byte) & 0xFF);
    }
    return *this;
  }

  std::string bytes_;
  bool is_big_endian_;
};

struct ImuFields {
  bool is_big_endian = false;
  double rate_covariance = 0.0;
  double acceleration_covariance = 0.0;
};

std::string imu(std::uint32_t second, double rate, const ImuFields& fields = {}) {
  return Message(fields.is_big_endian)
      .u32(second)
      .u32(500'000'000)
      .text("imu")
      .zeros(4 + 9)
      .f64({rate, 2.0, 3.0, fields.rate_covariance})
      .zeros(8)
      .f64({0.5, -0.25, 9.75, fields.acceleration_covariance})
      .zeros(8)
      .bytes();
}

std::string odometry(std::uint32_t second, double forwards, double turn_rad_s = 0.0) {
  return Message(false)
      .u32(second)
      .u32(0)
      .text("odom")
      .text("base_link")
      .zeros(3 + 4 + 36)
      .f64({forwards, 0.0, 0.0, 0.0, 0.0, turn_rad_s})
      .zeros(36)
      .bytes();
}

std::string twist(double forwards, double turn_rad_s) {
  return Message(false).f64({forwards, 0.0, 0.0, 0.0, 0.0, turn_rad_s}).bytes();
}

/// Writes databases as rosbag2 does.
class Bag : public ::testing::Test {
 protected:
  void SetUp() override { open("run_0.db3"); }
  void TearDown() override { sqlite3_close(database_); }

  void open(const std::string& name) {
    sqlite3_close(database_);
    path_ = folder_.path() / name;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &database_), SQLITE_OK);
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format "
        "TEXT)");
    run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data "
        "BLOB)");
  }

  void topic(int id, const std::string& name, const std::string& type) {
    run("INSERT INTO topics VALUES(" + std::to_string(id) + ",'" + name + "','" + type +
        "','cdr')");
  }

  void message(int topic, std::int64_t recorded_ns, const std::string& bytes) {
    sqlite3_stmt* insert = nullptr;
    const std::string sql = "INSERT INTO messages(topic_id, timestamp, data) VALUES(" +
                            std::to_string(topic) + "," + std::to_string(recorded_ns) + ",?1)";
    ASSERT_EQ(sqlite3_prepare_v2(database_, sql.c_str(), -1, &insert, nullptr), SQLITE_OK);
    sqlite3_bind_blob(insert, 1, bytes.data(), static_cast<int>(bytes.size()), SQLITE_TRANSIENT);
    ASSERT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_finalize(insert);
  }

  std::vector<Row> read(const Input& input) {
    Reader reader{input};
    columns_ = reader.columns();
    std::vector<Row> rows;
    for (Row row; reader.next(row);) rows.push_back(row);
    return rows;
  }

  std::string complaint(const Input& input) {
    try {
      static_cast<void>(read(input));
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  }

  zerorate::testing::ScratchFolder folder_;
  std::filesystem::path path_;
  Columns columns_;

 private:
  void run(const std::string& sql) {
    ASSERT_EQ(sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sql;
  }

  sqlite3* database_ = nullptr;
};

TEST_F(Bag, GivesRatesWithTheStampsOfTheirHeaders) {
  topic(1, "/other", "std_msgs/msg/String");
  topic(2, "/imu", "sensor_msgs/msg/Imu");
  message(1, 5, "not looked at");
  message(2, 20, imu(8, 0.25, {.is_big_endian = true}));
  message(2, 10, imu(7, -0.5));
  const auto rows = read({path_});
  ASSERT_EQ(rows.size(), 2);
  EXPECT_EQ(rows[0].time_ns, 7'500'000'000);
  EXPECT_THAT(rows[0].rate_rad_s, ElementsAre(-0.5F, 2.0F, 3.0F));
  EXPECT_EQ(rows[1].time_ns, 8'500'000'000);
  EXPECT_FLOAT_EQ(rows[1].rate_rad_s[0], 0.25F);
  EXPECT_TRUE(columns_.acceleration);
  EXPECT_THAT(rows[0].acceleration_m_s2, ElementsAre(0.5F, -0.25F, 9.75F));
  EXPECT_EQ(rows[1].acceleration_m_s2, rows[0].acceleration_m_s2);
  EXPECT_FALSE(columns_.still);
}

TEST_F(Bag, MarksRatesThatTheirSenderDoesNotKnow) {
  topic(1, "/imu", "sensor_msgs/msg/Imu");
  message(1, 10, imu(7, 0.0, {.rate_covariance = -1.0}));
  EXPECT_TRUE(read({path_})[0].findings.has(Finding::rate_lost));
}

TEST_F(Bag, WhoseFirstMessageHasNoAccelerationHasNone) {
  topic(1, "/imu", "sensor_msgs/msg/Imu");
  message(1, 10, imu(7, 0.0, {.acceleration_covariance = -1.0}));
  message(1, 20, imu(8, 0.0));
  const auto rows = read({path_});
  EXPECT_FALSE(columns_.acceleration);
  EXPECT_TRUE(rows[0].findings.empty());
  EXPECT_TRUE(std::isnan(rows[1].acceleration_m_s2[2]));
}

TEST_F(Bag, MarksAccelerationsThatAreAbsentLater) {
  topic(1, "/imu", "sensor_msgs/msg/Imu");
  message(1, 10, imu(7, 0.0));
  message(1, 20, imu(8, 0.0, {.acceleration_covariance = -1.0}));
  const auto rows = read({path_});
  EXPECT_TRUE(columns_.acceleration);
  EXPECT_TRUE(rows[1].findings.has(Finding::acceleration_lost));
}

TEST_F(Bag, TellsRestByTheSpeedOfItsOdometry) {
  topic(1, "/imu", "sensor_msgs/msg/Imu");
  topic(2, "/odom", "nav_msgs/msg/Odometry");
  for (std::uint32_t second = 0; second < 10; ++second) {
    message(1, second, imu(second, 0.0));
    message(2, second, odometry(second, second < 5 ? -0.4 : 0.0));
  }
  const auto rows = read({path_});
  EXPECT_TRUE(columns_.still);
  EXPECT_FALSE(rows[4].still);
  EXPECT_TRUE(rows[5].still);
}

TEST_F(Bag, TellsATurnOnTheSpotFromRest) {
  topic(1, "/imu", "sensor_msgs/msg/Imu");
  topic(2, "/odom", "nav_msgs/msg/Odometry");
  for (std::uint32_t second = 0; second < 10; ++second) {
    message(1, second, imu(second, 0.0));
    message(2, second, odometry(second, 0.0, second < 5 ? -0.5 : 0.0));
  }
  Input input{path_};
  const auto rows = read(input);
  EXPECT_FALSE(rows[4].still);
  EXPECT_TRUE(rows[5].still);
  // Half a track of 1 m, unless stated otherwise: 0.25 m/s.
  input.speed = SpeedRule{.dead_band_m_s = 0.24};
  EXPECT_FALSE(read(input)[4].still);
  input.speed->dead_band_m_s = 0.26;
  EXPECT_TRUE(read(input)[4].still);
}

TEST_F(Bag, TakesRestFromATwistThatIsNamed) {
  topic(1, "/imu", "sensor_msgs/msg/Imu");
  topic(2, "/cmd_vel", "geometry_msgs/msg/Twist");
  for (std::uint32_t second = 0; second < 10; ++second) {
    message(1, second, imu(second, 0.0));
    // A Twist has no stamp: the time of recording counts.
    message(2, second * 1'000'000'000LL + 500'000'000, twist(0.0, second < 5 ? 0.5 : 0.0));
  }
  Input input{path_};
  static_cast<void>(read(input));
  EXPECT_FALSE(columns_.still);
  input.odometry_topic = "/cmd_vel";
  const auto rows = read(input);
  EXPECT_TRUE(columns_.still);
  EXPECT_FALSE(rows[4].still);
  EXPECT_TRUE(rows[5].still);
}

TEST_F(Bag, MayBeAFolderOfSeveralFiles) {
  topic(1, "/imu", "sensor_msgs/msg/Imu");
  message(1, 20, imu(20, 0.0));
  open("run_10.db3");
  topic(1, "/imu", "sensor_msgs/msg/Imu");
  message(1, 10, imu(10, 0.0));
  const auto rows = read({folder_.path()});
  ASSERT_EQ(rows.size(), 2);
  EXPECT_LT(rows[0].time_ns, rows[1].time_ns);
}

TEST_F(Bag, WithSeveralGyrosWantsATopic) {
  topic(1, "/front", "sensor_msgs/msg/Imu");
  topic(2, "/rear", "sensor_msgs/msg/Imu");
  message(2, 10, imu(7, 1.0));
  EXPECT_THAT(complaint({path_}), HasSubstr("/front, /rear. Name the one that is meant: --topic"));
  Input input{path_};
  input.topic = "/rear";
  EXPECT_EQ(read(input).size(), 1);
  input.topic = "/rera";
  EXPECT_THAT(complaint(input), HasSubstr("no topic \"/rera\""));
}

TEST_F(Bag, ThatIsDamagedIsToldWithTheMessage) {
  topic(1, "/imu", "sensor_msgs/msg/Imu");
  message(1, 10, imu(7, 1.0));
  const std::string whole = imu(8, 1.0);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{3}, std::size_t{13}, whole.size() / 2}) {
    message(1, 20, whole.substr(0, size));
  }
  EXPECT_THAT(complaint({path_}), HasSubstr("a message that ends early as message 2 of /imu"));
}

TEST_F(Bag, WithoutAGyroIsRefused) {
  topic(1, "/odom", "nav_msgs/msg/Odometry");
  EXPECT_THAT(complaint({path_}), HasSubstr("no topic with messages of sensor_msgs/msg/Imu"));
}

TEST_F(Bag, NeedsNoColumns) {
  topic(1, "/imu", "sensor_msgs/msg/Imu");
  Input input{path_};
  input.layout.set_columns("gx=x");
  EXPECT_THAT(complaint(input), HasSubstr("Leave out --columns"));
}

TEST(FileThatOnlyBeginsAsADatabase, IsRefused) {
  const zerorate::testing::ScratchFolder folder;
  const auto path =
      folder.write("run.db3", std::string("SQLite format 3\0", 16) + std::string(500, 'x'));
  EXPECT_THROW(Reader{path}, Error);
}

// process.bags_of_ros1 reads whole ones.
TEST(BagOfRos1, IsRefusedWithItsCure) {
  const zerorate::testing::ScratchFolder folder;
  const auto path = folder.write("run.bag", "#ROSBAG V2.0\n\x45\0\0\0");
  try {
    const Reader reader{path};
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AnyOf(HasSubstr("rosbag reindex"),
                                    HasSubstr("Install librosbag-storage-dev and build again")));
  }
}

TEST(BagWhoseMessagesAreAView, IsRefusedAndNotComputed) {
  const testing::ScratchFolder folder;
  const std::string file = (folder.path() / "endless.db3").string();
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  const char* const sql =
      "CREATE TABLE topics(id, name, type, serialization_format);"
      "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
      "SELECT i AS id, 1 AS topic_id, i AS timestamp, x'00' AS data FROM n";
  ASSERT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  EXPECT_THROW(Reader{file}, DataError);
}

}  // namespace
}  // namespace zerorate::recording
