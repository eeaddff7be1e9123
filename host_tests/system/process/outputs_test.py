#!/usr/bin/env python3
"""What zerorate writes: files that appear whole, devices and FIFOs that stay what they are, lost output that is told.

usage: outputs_test.py ZERORATE [unittest arguments]
"""

import os
import pathlib
import signal
import stat
import subprocess
import sys
import tempfile
import threading
import time
import unittest

ZERORATE = sys.argv.pop(1)
LIMIT_S = 60.0
SCHEDULE = "still=5,drive=5,seed=1"
NULL_DEVICE, ZERO_DEVICE, FULL_DEVICE = os.makedev(1, 3), os.makedev(1, 5), os.makedev(1, 7)


def recording(path, rows):
    path.write_text("t_s,gx_dps,gy_dps,gz_dps\n" +
                    "".join(f"{0.01 * i:.2f},{0.01 * (i % 7)},{0.01 * (i % 5)},{0.01 * (i % 3)}\n" for i in range(rows)))


class Outputs(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        self.addCleanup(self._folder.cleanup)
        self.folder = pathlib.Path(self._folder.name)
        self.recording = self.folder / "rest.csv"
        recording(self.recording, 3000)

    def run_zerorate(self, *arguments, stdout=subprocess.PIPE):
        return subprocess.run([ZERORATE, *map(str, arguments)], stdout=stdout, stderr=subprocess.PIPE, text=True,
                              timeout=LIMIT_S, check=False)

    def node(self, name, device):
        """A device of this test's own; the machine's are not touched."""
        path = self.folder / name
        try:
            os.mknod(path, stat.S_IFCHR | 0o666, device)
            os.close(os.open(path, os.O_WRONLY))
        except PermissionError:
            self.skipTest("device nodes cannot be made or opened here")
        return path

    def outputs(self, path):
        schedule = ["--schedule", SCHEDULE]
        return [["replay", self.recording, *schedule, "--out", path],
                ["replay", self.recording, *schedule, "--report", path],
                ["replay", self.recording, *schedule, "--json", path],
                ["characterize", self.recording, "--report", path],
                ["characterize", self.recording, "--model-out", path],
                ["export", "lsm6dso", "--c", "--sample-rate", "100", "-o", path]]

    def test_a_device_is_written_to_and_stays_a_device(self):
        null = self.node("null", NULL_DEVICE)
        for command in self.outputs(null):
            run = self.run_zerorate(*command)
            self.assertEqual((run.returncode, run.stderr), (0, ""), command)
            self.assertTrue(stat.S_ISCHR(null.lstat().st_mode), command)

    def test_a_fifo_gives_its_reader_the_whole_text(self):
        fifo = self.folder / "fifo"
        os.mkfifo(fifo)
        for command in self.outputs(fifo):
            texts = []
            reader = threading.Thread(target=lambda into=texts: into.append(fifo.read_text()), daemon=True)
            reader.start()
            run = self.run_zerorate(*command)
            reader.join(LIMIT_S)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertTrue(stat.S_ISFIFO(fifo.lstat().st_mode), command)
            file = self.folder / "as-a-file"
            self.run_zerorate(*[file if word == fifo else word for word in command])
            self.assertEqual(texts, [file.read_text()], command)

    def test_a_socket_and_a_folder_are_refused_and_stay(self):
        folder = self.folder / "folder"
        folder.mkdir()
        for command in self.outputs(folder):
            run = self.run_zerorate(*command)
            self.assertEqual(run.returncode, 3, command)
            self.assertIn("Is a directory", run.stderr)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["folder", "rest.csv"])

    def test_a_file_is_replaced_whole_with_its_permissions(self):
        file = self.folder / "mine"
        for command in self.outputs(file):
            file.write_text("older")
            file.chmod(0o640)
            reader = file.open()
            run = self.run_zerorate(*command)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(reader.read(), "older", "who reads the older file reads it to its end")
            reader.close()
            self.assertNotEqual(file.read_text(), "older")
            self.assertEqual(stat.S_IMODE(file.stat().st_mode), 0o640)

    def test_a_full_device_is_told(self):
        full = self.node("full", FULL_DEVICE)
        for command in self.outputs(full):
            run = self.run_zerorate(*command)
            self.assertEqual(run.returncode, 3, command)
            self.assertIn("No space left on device", run.stderr)

    def test_an_interrupted_command_leaves_no_partial_file(self):
        recording(self.recording, 1_000_000)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            process = subprocess.Popen([ZERORATE, "replay", self.recording, "--schedule", SCHEDULE, "--out", self.folder / "out.csv"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            deadline = time.monotonic() + LIMIT_S
            while not list(self.folder.glob("out.csv.*.partial")) and time.monotonic() < deadline:
                time.sleep(0.005)
            process.send_signal(number)
            self.assertEqual(process.wait(LIMIT_S), -number)
            self.assertEqual([path.name for path in self.folder.iterdir()], ["rest.csv"])

    def test_what_others_wrote_cannot_steer_the_terminal(self):
        model = self.folder / "model.toml"
        text = self.run_zerorate("model", "show", "lsm6dso").stdout
        for evil, code in [(text.replace('name = "', 'name = "\\u001b]0;pwned\\u0007\\u009b', 1), 0),
                           (text + '\n["\\u001b[2J"]\n', 3)]:
            model.write_text(evil)
            run = self.run_zerorate("model", "check", model)
            self.assertEqual(run.returncode, code, run.stderr)
            self.assertIn("\\x1B", run.stdout + run.stderr)
            self.assertNotRegex(run.stdout + run.stderr, "[\x00-\x08\x0b-\x1f\x7f\x80-\x9f]")

    def test_an_exported_header_needs_the_rate_of_the_samples(self):
        for language in ("--c", "--cpp"):
            run = self.run_zerorate("export", "lsm6dso", language)
            self.assertEqual((run.returncode, run.stdout), (2, ""))
            self.assertIn("--sample-rate is required", run.stderr)
            run = self.run_zerorate("export", "lsm6dso", language, "--sample-rate", "100")
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            self.assertIn("For 100.000 Hz samples", run.stdout)

    def test_a_header_that_the_default_configuration_refuses_is_not_written(self):
        for language, rate, places in (("--c", "50", "29"), ("--cpp", "200", "104")):
            export = ["export", "lsm6dso", language, "--sample-rate", "208", "--filter-rate", rate]
            run = self.run_zerorate(*export)
            self.assertEqual((run.returncode, run.stdout), (2, ""))
            self.assertIn(f"--held-ticks {places}", run.stderr)
            run = self.run_zerorate(*export, "--held-ticks", places)
            self.assertEqual((run.returncode, run.stderr), (0, ""))

    def test_a_model_that_exhausts_stack_or_memory_is_refused(self):
        deep = self.folder / "deep.toml"
        deep.write_text(f"[a{'.a' * 200_000}]\n")
        for model in (deep, self.node("zero", ZERO_DEVICE)):
            for command in (["model", "check", model], ["export", model, "--c", "--sample-rate", "100"],
                            ["replay", self.recording, "--schedule", SCHEDULE, "--model", model]):
                run = self.run_zerorate(*command)
                self.assertEqual(run.returncode, 3, command)
                self.assertIn("more than 32768 bytes", run.stderr, command)

    def test_a_full_standard_output_is_told(self):
        full = self.node("full", FULL_DEVICE)
        for command in [["--help"], ["--version"], ["replay", "--help"], ["model", "list"], ["model", "show", "lsm6dso"],
                        ["export", "lsm6dso", "--c", "--sample-rate", "100"],
                        ["export", "lsm6dso", "--cpp", "--sample-rate", "100"], ["replay", self.recording, "--schedule", SCHEDULE],
                        ["replay", self.recording, "--schedule", SCHEDULE, "--json", "-"], ["simulate", "--scenario", "list"],
                        ["characterize", self.recording, "--json", "-"]]:
            with full.open("w") as out:
                run = self.run_zerorate(*command, stdout=out)
            self.assertEqual(run.returncode, 3, command)
            self.assertIn("No space left on device", run.stderr, command)


if __name__ == "__main__":
    unittest.main()
