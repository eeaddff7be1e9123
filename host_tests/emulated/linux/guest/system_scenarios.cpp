#include <sys/inotify.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <sched.h>
#include <csignal>
#include <cstdlib>

#include "hal/linux/file_storage.hpp"
#include "host_tests/emulated/linux/guest/bench.hpp"
#include "host_tests/emulated/linux/guest/scenarios.hpp"

namespace zerorate::emulated {
namespace {

constexpr const char* kStateFolder = "/run/state";
constexpr double kSaveInterval_s = 10.0;  // value in /zerorated.toml

/// Steps the time of day by hours, to and fro.
void wall_clock_steps(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world, verdict, "the wall clock steps", {}};
  bench.schedule->run(3.0);
  const std::size_t first = bench.witness->published().size();
  const Tally before = bench.tally();
  for (const std::time_t step_s : {3600, -7200, 3600}) {
    std::timespec now{};
    (void)clock_gettime(CLOCK_REALTIME, &now);
    now.tv_sec += step_s;
    if (clock_settime(CLOCK_REALTIME, &now) != 0) give_up("clock_settime");
    bench.schedule->run(2.0);
  }
  const auto& published = bench.witness->published();
  core::Duration longest;
  for (std::size_t i = first; i < published.size(); ++i) {
    longest = std::max(longest, published[i].message.time - published[i - 1].message.time);
  }
  const double longest_ms = static_cast<double>(longest.ns()) / 1e6;
  verdict.check("time stamps go on evenly", longest_ms < 11.0, longest_ms);
  verdict.check("nothing is faulty",
                bench.tally().faulty == before.faulty && bench.tally().odometer_faulty == 0, 0);
  check_recovery(bench, 0.5);
}

/// A record of the state is whole, by its checksum.
void check_state(Verdict& verdict, const char* what) {
  hal::linux_os::FileCalls calls;
  hal::linux_os::FileStorage storage{std::string{kStateFolder} + "/state", calls};
  std::vector<std::uint8_t> record(65536);
  const auto size = storage.load(record);
  verdict.check(what, size.has_value(), size ? static_cast<double>(*size) : -1.0);
}

/// Waits, more urgent than zerorated, until it has begun to write a state, and signals it then.
void signal_in_a_save(Bench& bench, int signal) {
  const hal::linux_os::Descriptor watch{inotify_init()};
  (void)inotify_add_watch(watch.get(), kStateFolder, IN_CREATE);
  std::thread killer{[&] {
    const sched_param urgent{.sched_priority = 90};
    (void)sched_setscheduler(0, SCHED_FIFO, &urgent);
    std::array<char, 4096> events{};
    (void)!read(watch.get(), events.data(), events.size());
    bench.daemon->send(signal);
  }};
  bench.schedule->run(kSaveInterval_s + 3.0);
  killer.join();
}

void ended_in_a_save(DeviceWorld& world, Verdict& verdict, int signal, const char* name) {
  Bench bench{world, verdict, name, {}};
  bench.schedule->run(kSaveInterval_s + 3.0);  // one save that is not disturbed
  signal_in_a_save(bench, signal);
  const int code = bench.daemon->wait();
  verdict.check("it ended", code == (signal == SIGKILL ? -SIGKILL : 0), code);
  if (signal == SIGKILL) {
    const bool is_cut = std::system("ls /run/state/*.new >/dev/null 2>&1") == 0;
    verdict.check("in the middle of a save", is_cut, 0);
  }
  check_state(verdict, "a whole state is there");
  bench.witness->expect_restart();
  bench.daemon->start();
  bench.schedule->run(2.0);
  verdict.check("and is taken up again", DaemonProcess::has_logged("state: restored"), 0);
  verdict.check("calibrated from the first message on",
                bench.witness->newest()->message.health.calibrated, 0);
  check_recovery(bench, 0.5);
}

void disk_full(DeviceWorld& world, Verdict& verdict) {
  (void)mount("small", kStateFolder, "tmpfs", 0, "size=64k");
  {
    Bench bench{world, verdict, "the disk is full", {}};
    bench.schedule->run(kSaveInterval_s + 3.0);
    const double saves = DaemonProcess::metric("state_saves_total");
    verdict.check("a state was saved", saves >= 1.0, saves);
    (void)std::system("dd if=/dev/zero of=/run/state/filler bs=1k 2>/dev/null");
    const Tally before = bench.tally();
    bench.schedule->run(kSaveInterval_s + 3.0);
    const Tally& during = bench.tally();
    const double errors = DaemonProcess::metric("state_save_errors_total");
    verdict.check("the failed save is counted", errors >= 1.0, errors);
    verdict.check("and named", DaemonProcess::has_logged(": no space left ("), 0);
    const auto samples = during.with_rate - before.with_rate;
    verdict.check("samples go on", samples >= 1000, samples);
    check_state(verdict, "the state from before is whole");
    (void)unlink("/run/state/filler");
    bench.schedule->run(kSaveInterval_s + 3.0);
    const double more = DaemonProcess::metric("state_saves_total");
    verdict.check("with room it saves again", more > saves, more);
    check_recovery(bench, 0.5);
  }
  check_state(verdict, "a whole state is there at the end");
  (void)umount(kStateFolder);
}

void receivers_absent(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world, verdict, "CAN interface down, UDP receiver absent", {}};
  bench.schedule->run(2.0);
  (void)std::system("ip link set vcan0 down");
  bench.receivers.close_udp();
  const Tally before = bench.tally();
  bench.schedule->run(5.0);
  const std::size_t can_before = bench.receivers.can().size();
  const Tally& during = bench.tally();
  const auto samples = during.with_rate - before.with_rate;
  verdict.check("the others get everything",
                samples >= 500 && during.number_gaps == before.number_gaps, samples);
  const double dropped = DaemonProcess::metric("sink_dropped_total{sink=\"can:vcan0\"}") +
                         DaemonProcess::metric("sink_dropped_total{sink=\"udp:127.0.0.1:24680\"}");
  verdict.check("what was dropped is counted", dropped >= 400.0, dropped);
  (void)std::system("ip link set vcan0 up");
  bench.receivers.open_udp();
  const std::size_t udp_before = bench.receivers.udp().size();
  bench.schedule->run(3.0);
  const std::size_t by_can = bench.receivers.can().size() - can_before;
  const std::size_t by_udp = bench.receivers.udp().size() - udp_before;
  verdict.check("CAN works again", by_can >= 200, by_can);
  verdict.check("UDP works again", by_udp >= 300, by_udp);
  check_recovery(bench, 0.5);
}

}  // namespace

void break_the_system(DeviceWorld& world, Verdict& verdict) {
  wall_clock_steps(world, verdict);
  ended_in_a_save(world, verdict, SIGTERM, "SIGTERM in the middle of a save");
  ended_in_a_save(world, verdict, SIGKILL, "killed in the middle of a save");
  disk_full(world, verdict);
  receivers_absent(world, verdict);
}

}  // namespace zerorate::emulated
