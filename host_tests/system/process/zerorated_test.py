#!/usr/bin/env python3
"""zerorated as a process on a machine without its hardware: what it says, and how it ends.

usage: zerorated_test.py ZERORATED [unittest arguments]
"""

import os
import pathlib
import pwd
import shutil
import signal
import socket
import stat
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

ZERORATED = sys.argv.pop(1)
REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
LIMIT_S = 20.0

CONFIGURATION = """schema = "zerorate.daemon/1"
[gyro]
chip = "lsm6dso"
bus = "spi"
device = "{folder}/no-spidev"
rate_hz = 104
full_scale_dps = 250
[odometer]
chip = "{folder}/no-gpiochip"
line = 3
[state]
file = "{folder}/state"
[real_time]
lock_memory = false
[metrics]
socket = "{folder}/metrics.sock"
[[sink]]
type = "udp"
address = "127.0.0.1"
port = {port}
"""


def decoded(frame):
    """Sequence, health bits and axis x of a frame, checked against its page and zlib."""
    magic, version, sequence, motion, health = struct.unpack_from("<2sBxI8xBH", frame)
    assert (magic, version) == (b"ZR", 5) and 120 <= len(frame) <= 196, frame
    assert struct.unpack_from("<I", frame, len(frame) - 4)[0] == zlib.crc32(frame[:-4])
    return {"sequence": sequence, "motion": motion, "health": health,
            "x": struct.unpack_from("<4f", frame, 20)}


def may_be_urgent():
    return subprocess.run(["chrt", "--fifo", "1", "true"], capture_output=True, check=False).returncode == 0


def is_sanitized():
    return b"__asan_init" in pathlib.Path(ZERORATED).read_bytes()


class Node(unittest.TestCase):
    """A process with its folder, its receiver and its service manager."""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        self.folder = pathlib.Path(self._folder.name)
        self.receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.receiver.bind(("127.0.0.1", 0))
        self.receiver.settimeout(LIMIT_S)
        self.notified = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.notified.bind(str(self.folder / "notify"))
        self.notified.settimeout(LIMIT_S)
        self.file = self.folder / "zerorated.toml"
        self.configure()
        self.further_files = []
        self.process = None
        self.environment = os.environ

    def tearDown(self):
        if self.process and self.process.poll() is None:
            self.process.kill()
            self.process.communicate()
        self.receiver.close()
        self.notified.close()
        self._folder.cleanup()

    def configure(self, *changes):
        text = CONFIGURATION.format(folder=self.folder, port=self.receiver.getsockname()[1])
        for change in changes:
            text = text.replace(*change)
        self.file.write_text(text)

    def add_json_sink(self, path, *changes):
        self.configure(("[[sink]]", f'[[sink]]\ntype = "json"\nfile = "{path}"\n[[sink]]'), *changes)

    def start(self):
        environment = dict(self.environment, NOTIFY_SOCKET=str(self.folder / "notify"), WATCHDOG_USEC="2000000")
        files = [word for file in (self.file, *self.further_files) for word in ("--config", file)]
        self.process = subprocess.Popen([ZERORATED, *files], env=environment,
                                        stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        self.assertEqual(self.notification(), "READY=1")

    def notification(self):
        return self.notified.recv(256).decode()

    def message(self):
        frame = self.receiver.recv(256)
        while frame.startswith(b"ZL"):  # of what was learnt, once a second
            frame = self.receiver.recv(256)
        return decoded(frame)

    def metrics(self, file="metrics.sock"):
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as reader:
            reader.settimeout(LIMIT_S)
            reader.connect(str(self.folder / file))
            text = b""
            while chunk := reader.recv(65536):
                text += chunk
        return text.decode()

    def reload(self):
        """Until its messages are numbered anew."""
        self.process.send_signal(signal.SIGHUP)
        time.sleep(0.3)
        while self.message()["sequence"] != 0:
            pass

    def reload_in_vain(self):
        self.process.send_signal(signal.SIGHUP)
        while self.notification() != "READY=1":
            pass

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        while self.notification() != "STOPPING=1":
            pass
        errors = self.process.communicate(timeout=LIMIT_S)[1]
        self.assertEqual(self.process.returncode, 0)
        return errors


class Zerorated(Node):
    def test_says_that_the_sensor_is_faulty_and_never_claims_standstill(self):
        self.start()
        numbers = []
        for _ in range(4):
            message = self.message()
            self.assertEqual(message["motion"], 0)
            self.assertTrue(message["health"] & 0x40, "sensor_fault")
            self.assertTrue(message["health"] & 0x20, "odometer_fault")
            self.assertFalse(message["health"] & 0x01, "calibrated")
            self.assertEqual(message["x"][0], 0.0)
            self.assertEqual(message["x"][3], float("inf"))
            numbers.append(message["sequence"])
        self.assertEqual(numbers, list(range(numbers[0], numbers[0] + 4)))
        errors = self.stop()
        self.assertIn(f"zerorated: lsm6dso on {self.folder}/no-spidev, 104 Hz, 250 deg/s, model lsm6dso", errors)
        self.assertIn(f"zerorated: gyro: {self.folder}/no-spidev: No such file or directory (is the bus", errors)
        self.assertIn(f"zerorated: odometer {self.folder}/no-gpiochip line 3: No such file or directory (is", errors)
        self.assertTrue(all(line.startswith("zerorated: ") for line in errors.splitlines()), errors)

    def test_says_that_a_can_interface_is_not_there(self):
        self.configure(("[[sink]]", '[[sink]]\ntype = "can"\ninterface = "no-can"\n[[sink]]'))
        self.start()
        for _ in range(12):
            self.message()
        self.assertRegex(self.stop(), r"zerorated: sink can:no-can: .+ \(.+\); its messages are dropped")

    def test_feeds_the_watchdog_and_serves_its_metrics(self):
        self.start()
        self.assertEqual(self.notification(), "WATCHDOG=1")
        text = self.metrics()
        self.assertIn("\nzerorate_gyro_running 0\n", text)
        self.assertIn('zerorate_health{flag="sensor_fault"} 1\n', text)
        self.stop()
        self.assertFalse((self.folder / "metrics.sock").exists())

    def test_saves_its_state_at_the_end_and_takes_it_up_again(self):
        self.start()
        self.assertIn("state: nothing saved", self.stop())
        self.assertTrue((self.folder / "state.1").exists())
        self.start()
        self.assertIn("state: restored", self.stop())

    def status(self):
        lines = pathlib.Path(f"/proc/{self.process.pid}/status").read_text(encoding="ascii").splitlines()
        return {name: value.split() for name, value in (line.split(":", 1) for line in lines)}

    @unittest.skipUnless(os.geteuid() == 0, "not started as root")
    def test_becomes_its_user_and_keeps_nothing_of_root(self):
        user = pwd.getpwnam("nobody")
        for path in (self.folder, self.folder / "notify"):
            os.chown(path, user.pw_uid, user.pw_gid)
        self.configure(("[gyro]", 'user = "nobody"\n[gyro]'))
        self.start()
        status = self.status()
        self.assertEqual(status["Uid"], 4 * [str(user.pw_uid)])
        self.assertEqual(status["Gid"], 4 * [str(user.pw_gid)])
        self.assertEqual(status["Groups"], [str(user.pw_gid)])
        self.assertEqual((status["CapPrm"], status["CapEff"]), (["0" * 16], ["0" * 16]))
        self.stop()

    @unittest.skipIf(is_sanitized(), "the address sanitizer locks no memory")
    def test_locks_its_memory(self):
        self.configure(("lock_memory = false", "lock_memory = true"))
        self.start()
        locked = int(self.status()["VmLck"][0])
        if "memory cannot be locked" in self.stop():
            self.skipTest("memory may not be locked here")
        self.assertGreater(locked, 0)

    @unittest.skipUnless(may_be_urgent(), "real time is not permitted here")
    def test_measures_in_real_time(self):
        self.configure(("lock_memory = false", "lock_memory = false\npriority = 7"))
        self.start()
        threads = [int(task.name) for task in pathlib.Path(f"/proc/{self.process.pid}/task").iterdir()]
        classes = {os.sched_getscheduler(thread): os.sched_getparam(thread).sched_priority for thread in threads}
        self.assertEqual((len(threads), classes), (2, {os.SCHED_OTHER: 0, os.SCHED_FIFO: 7}))
        self.stop()

    @unittest.skipUnless(shutil.which("systemd-analyze"), "no systemd")
    def test_unit_has_nothing_that_systemd_does_not_understand(self):
        unit = self.folder / "zerorated.service"
        text = (REPOSITORY / "firmware/boards/linux/zerorated.service").read_text(encoding="ascii")
        unit.write_text(text.replace("/usr/sbin/zerorated", str(pathlib.Path(ZERORATED).resolve())))
        run = subprocess.run(["systemd-analyze", "verify", "--man=no", unit], capture_output=True, text=True,
                             timeout=LIMIT_S)
        self.assertEqual((run.returncode, run.stderr), (0, ""))

    def test_reloads_on_sighup(self):
        self.start()
        other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        other.bind(("127.0.0.1", 0))
        other.settimeout(LIMIT_S)
        self.configure((str(self.receiver.getsockname()[1]), str(other.getsockname()[1])))
        self.process.send_signal(signal.SIGHUP)
        notes = [self.notification(), self.notification()]
        while notes[-1] != "READY=1":
            notes.append(self.notification())
        self.assertTrue(any(note.startswith("RELOADING=1\nMONOTONIC_USEC=") for note in notes), notes)
        self.assertTrue(decoded(other.recv(256))["health"] & 0x40)
        other.close()
        self.stop()

    def test_goes_on_as_before_if_the_new_configuration_is_wrong(self):
        self.start()
        self.configure(("rate_hz = 104", "rate_hz = 105"))
        before = self.message()["sequence"]
        self.reload_in_vain()
        self.assertGreater(self.message()["sequence"], before)
        self.assertIn("zerorated.toml:6:11", self.stop())

    def test_goes_on_as_before_if_the_new_configuration_cannot_be_followed(self):
        self.start()
        self.configure(("metrics.sock", "no-folder/metrics.sock"))
        self.reload()
        self.assertTrue((self.folder / "metrics.sock").exists())
        self.assertIn(f'not reloaded: "socket" in [metrics]: {self.folder}/no-folder/metrics.sock: No such file or '
                      "directory (make its folder first", self.stop())

    def test_goes_on_without_what_has_gone_if_it_cannot_go_back_to_it(self):
        gone = self.folder / "gone"
        gone.mkdir()
        self.add_json_sink(gone / "rate", ("metrics.sock", "gone/metrics.sock"))
        self.start()
        self.message()
        shutil.rmtree(gone)
        self.reload()
        errors = self.stop()
        self.assertIn("not reloaded: ", errors)
        self.assertEqual(errors.count("left out until the next SIGHUP: "), 1, errors)
        self.assertIn(f"sink json:{gone}/rate: No such file or directory (make its folder first", errors)

    def refusal(self):
        run = subprocess.run([ZERORATED, "--config", self.file], capture_output=True, text=True, timeout=LIMIT_S,
                             check=False)
        self.assertEqual(run.returncode, 3)
        return run.stderr

    def test_escapes_the_names_of_sinks_in_its_metrics(self):
        self.add_json_sink(f'{self.folder}/a\\"b\\\\c')
        self.start()
        self.assertIn(f'zerorate_sink_sent_total{{sink="json:{self.folder}/a\\"b\\\\c"}} ', self.metrics())
        self.stop()

    def test_refuses_paths_that_would_make_lines_of_the_log(self):
        self.add_json_sink(f"{self.folder}/rate\\nzerorated: all is well")
        refusal = self.refusal()
        self.assertIn('"file" in [sink]: expected text without line breaks', refusal)
        self.assertNotIn("all is well", refusal)

    def test_serves_its_metrics_from_the_start(self):
        self.start()
        self.assertIn("\nzerorate_gyro_running 0\n", self.metrics())
        self.stop()

    def test_gives_whole_lines_of_metrics_where_there_are_too_many(self):
        self.configure(("[[sink]]", 200 * f'[[sink]]\ntype = "json"\nfile = "{self.folder}/sink"\n' + "[[sink]]"))
        self.start()
        self.notification()
        text = self.metrics()
        self.assertIn('\nzerorate_sigma_dps{axis="z"} ', text)
        self.assertRegex(text.splitlines()[-1], r"^zerorate_\w+\{.*\} \d+$")
        self.assertTrue(text.endswith("\n"))
        self.stop()

    def test_does_not_wait_for_the_reader_of_a_fifo(self):
        fifo = self.folder / "fifo"
        os.mkfifo(fifo)
        self.add_json_sink(fifo)
        self.start()
        self.message()
        self.reload()
        self.stop()

    def test_does_not_wait_for_a_fifo_in_the_place_of_its_state(self):
        for name in ("state.0", "state.1", "state.0.new", "state.1.new"):
            os.mkfifo(self.folder / name)
        self.start()
        self.message()
        self.assertIn("state: both slots are damaged", self.stop())

    def test_removes_no_file_in_the_place_of_its_socket(self):
        file = self.folder / "metrics.sock"
        file.write_text("not a socket")
        self.assertIn(f"{file}: File exists", self.refusal())
        self.assertEqual(file.read_text(), "not a socket")

    def test_replaces_the_socket_of_a_run_that_was_killed(self):
        self.start()
        self.process.kill()
        self.process.communicate()
        self.assertTrue((self.folder / "metrics.sock").is_socket())
        self.start()
        self.stop()

    def test_leaves_state_and_socket_to_the_process_that_has_them(self):
        self.start()
        self.assertIn(f"{self.folder}/metrics.sock: Address already in use", self.refusal())
        self.configure(("metrics.sock", "other.sock"))
        self.assertIn(f'state "{self.folder}/state" is in use by another process', self.refusal())
        self.assertTrue((self.folder / "metrics.sock").is_socket())
        self.stop()

    def test_lets_everybody_connect_to_its_metrics(self):
        self.start()
        self.assertEqual(stat.S_IMODE((self.folder / "metrics.sock").stat().st_mode), 0o666)
        self.stop()

    def test_follows_no_link_where_it_saves(self):
        victim = self.folder / "victim"
        victim.write_text("untouched")
        for name in ("state.0.new", "state.1.new", "metrics.new", "state.lock"):
            (self.folder / name).symlink_to(victim)
        self.configure(("[metrics]", f'[metrics]\nfile = "{self.folder}/metrics"'))
        self.start()
        self.assertIn("state: not saved", self.stop())
        self.assertEqual(victim.read_text(), "untouched")

    def test_tells_that_its_standard_output_is_full(self):
        full = self.folder / "full"
        try:
            os.mknod(full, stat.S_IFCHR | 0o666, os.makedev(1, 7))
            out = full.open("w")
        except PermissionError:
            self.skipTest("device nodes cannot be made or opened here")
        for arguments in (["--help"], ["--version"], ["--config", self.file, "--check-config"]):
            run = subprocess.run([ZERORATED, *arguments], stdout=out, stderr=subprocess.PIPE, text=True,
                                 timeout=LIMIT_S, check=False)
            self.assertEqual(run.returncode, 3)
            self.assertIn("No space left on device", run.stderr)
        out.close()

    def test_refuses_a_wrong_configuration_with_its_place(self):
        self.configure(("chip = \"lsm6dso\"", "chip = \"lsm6\""))
        for arguments in (["--check-config"], []):
            run = subprocess.run([ZERORATED, "--config", self.file, *arguments], capture_output=True,
                                 text=True, timeout=LIMIT_S)
            self.assertEqual(run.returncode, 3)
            self.assertIn(f"{self.file}:3:8:", run.stderr)

    def test_says_that_a_right_configuration_is_valid(self):
        run = subprocess.run([ZERORATED, "--config", self.file, "--check-config"],
                             capture_output=True, text=True, timeout=LIMIT_S)
        self.assertEqual((run.returncode, run.stdout), (0, f"{self.file}: valid\n"))


if __name__ == "__main__":
    unittest.main()
