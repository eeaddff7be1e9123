/// @file
/// The node as a service: measured by one thread, published, watched and saved by another.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/node_loop.hpp"
#include "firmware/app/snapshot.hpp"
#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/hardware.hpp"
#include "firmware/boards/linux/log_words.hpp"
#include "firmware/boards/linux/message_queue.hpp"
#include "firmware/boards/linux/outputs/sinks.hpp"
#include "firmware/boards/linux/process/log.hpp"
#include "firmware/wire/learnt_frame.hpp"
#include "hal/linux/file_storage.hpp"

namespace zerorate::linux_node {

/// References of the heading since the start, by what became of them.
struct ReferenceCounters {
  std::uint32_t learnt = 0;
  std::uint32_t refused = 0;   ///< too far from what the gyro measured
  std::uint32_t unusable = 0;  ///< before the first bias, or of a time that is not remembered

  constexpr bool operator==(const ReferenceCounters&) const = default;
};

/// State of the measuring side, which hands it over when asked.
struct ServiceStatus {
  app::LoopCounters counters;
  bool is_running = false;
  app::RateWatch sample_rate;
  Node::State state;
  wire::LearntModel learnt;
  SampleCounters samples;
  ReferenceCounters references;
  app::Heading heading;
  int reference_error_number = 0;  ///< errno for which no reference can come; 0: none
  HardwareReasons reasons{};       ///< asked for where something fails
};

/// Counters of the publishing side since the start.
struct ServiceCounters {
  std::uint32_t saves = 0;
  std::uint32_t save_errors = 0;
};

/// No heap once it is made. Its functions belong to one of two threads each: the measuring one
/// never waits for the publishing one, nor for anything but the bus.
class NodeService {
 public:
  /// @param configuration, hardware  must outlive the service
  /// @param storage  must outlive the service; nullptr: nothing is saved
  NodeService(const Configuration& configuration, Hardware& hardware,
              hal::linux_os::FileStorage* storage, const app::Session& session, Log log);

  /// Publishes to one more receiver than the configuration names. Before measure().
  void add_sink(std::unique_ptr<Sink> sink);

  /// Takes up the saved state, if there is one that fits. Before measure().
  /// @return whether it did
  bool restore();
  /// Takes up the record of a node in this process.
  bool restore(std::span<const std::uint8_t> record);

  /// The measuring thread: sleeps until there is something to do, and does it.
  void measure();

  /// The publishing thread: everything that waits, to every sink.
  void publish_waiting();
  /// The publishing thread, about once a second: says what changed, tells the sinks what has been
  /// learnt, saves when it is time.
  /// @return whether the measuring thread has done anything since the last tick
  bool tick();
  /// After the measuring thread has ended: publishes what waits, and saves.
  void finish();

  /// Record of what the node has learnt; after finish().
  [[nodiscard]] std::vector<std::uint8_t> record() const;

  [[nodiscard]] const MessageQueue& queue() const { return queue_; }
  /// Status at the last tick.
  [[nodiscard]] const ServiceStatus& status() const { return last_status_; }
  [[nodiscard]] const std::optional<wire::NumberedMessage>& latest() const { return latest_; }
  [[nodiscard]] const std::vector<std::unique_ptr<Sink>>& sinks() const { return sinks_; }
  [[nodiscard]] const ServiceCounters& counters() const { return counters_; }
  [[nodiscard]] bool takes_references() const { return configuration_.reference.has_value(); }
  /// Name of the node; empty: it has none.
  [[nodiscard]] const std::string& name() const { return configuration_.name; }

 private:
  enum class Handover : std::uint8_t { idle, requested, ready };

  /// Fault of the gyro in the log, which is not told again while it lasts.
  struct ToldFault {
    drivers::DriverError error;
    int error_number = 0;
    std::string told;

    bool operator==(const ToldFault&) const = default;
  };

  /// Newest state of a sink that was told, and its messages until then.
  struct SinkReport {
    int error_number = 0;
    std::uint64_t sent = 0;
  };

  void take_references();
  void hand_over();
  [[nodiscard]] wire::LearntModel learnt() const;
  void report_changes(const ServiceStatus& now);
  void report_gyro(const ServiceStatus& now);
  void report_samples(const ServiceStatus& now);
  void report_sample_rate(const ServiceStatus& now);
  void report_odometer(const ServiceStatus& now);
  void report_references(const ServiceStatus& now);
  void report_sinks();
  void publish_learnt();
  void save(const Node::State& state);

  const Configuration& configuration_;
  Hardware& hardware_;
  hal::linux_os::FileStorage* storage_;
  app::Snapshot<Node> snapshot_;
  app::Session session_;
  Log log_;
  std::string odometer_name_;
  std::string reference_name_;

  Node node_;
  MessageQueue queue_;
  app::NodeLoop<Node, drivers::AnyGyro, Hardware, Hardware, Hardware, MessageQueue> loop_;
  std::optional<Reference> waiting_reference_;  ///< newer than the newest sample
  ReferenceCounters references_;
  std::atomic<std::uint32_t> turns_ = 0;
  std::atomic<Handover> handover_ = Handover::idle;
  std::uint32_t asked_failures_ = 0;  ///< failures of the gyro whose reasons were asked for
  HardwareReasons reasons_;           ///< why the gyro failed last
  ServiceStatus
      offered_status_;  ///< written by the measuring thread while requested, read while ready

  std::vector<std::unique_ptr<Sink>> sinks_;
  std::vector<SinkReport> sink_reports_;
  std::optional<wire::NumberedMessage> latest_;
  ServiceStatus last_status_;
  std::optional<ToldFault> told_fault_;  ///< fault of the gyro, since its newest samples
  std::uint32_t told_starts_ = 0;
  int told_save_error_ = 0;       ///< error of the newest save; 0: it succeeded
  bool odometer_failed_ = false;  ///< between the last two ticks
  ServiceCounters counters_;
  std::uint32_t turns_seen_ = 0;
  core::Instant save_at_;
};

/// The kernel's boot id, as /proc/sys/kernel/random/boot_id gives it: within one boot the monotonic
/// clock goes on, and so, as a rule, does the gyro's power. Throws std::system_error where the
/// kernel does not tell.
[[nodiscard]] app::Session read_boot_id(const char* file = "/proc/sys/kernel/random/boot_id");

/// This session, now by the wall clock.
[[nodiscard]] app::SnapshotTime time_in(const app::Session& session);

/// Tells gyros apart that a configuration may name one after the other.
[[nodiscard]] std::uint32_t sensor_id(const GyroSettings& gyro);

}  // namespace zerorate::linux_node
