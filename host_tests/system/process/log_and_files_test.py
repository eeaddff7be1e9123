#!/usr/bin/env python3
"""zerorated where its log, its files or its configuration cannot be had.

usage: log_and_files_test.py ZERORATED [unittest arguments]
"""

import os
import signal
import stat
import subprocess
import time
import unittest

from zerorated_test import LIMIT_S, REPOSITORY, ZERORATED, Node


class LogAndFiles(Node):
    def test_goes_on_where_its_configuration_has_become_a_pipe(self):
        self.start()
        self.file.unlink()
        os.mkfifo(self.file)
        self.reload_in_vain()
        self.message()
        self.assertIn(f"not reloaded: {self.file}: Connection timed out", self.stop())

    def test_writes_into_a_folder_that_comes_later(self):
        folder = self.folder / "later"
        self.add_json_sink(folder / "rate")
        self.start()
        self.message()
        folder.mkdir()
        self.wait_for(lambda: (folder / "rate").exists() and (folder / "rate").stat().st_size > 0)
        errors = self.stop()
        self.assertIn(f"sink json:{folder}/rate: No such file or directory", errors)
        self.assertIn(f"sink json:{folder}/rate: takes messages again", errors)

    def test_is_started_again_however_often_it_could_not_be(self):
        unit = (REPOSITORY / "firmware/boards/linux/zerorated.service").read_text(encoding="ascii")
        head, _, service = unit.partition("[Service]")
        self.assertIn("\nStartLimitIntervalSec=0\n", head)
        self.assertIn("\nRestart=on-failure\n", service)

    def wait_for(self, condition):
        end = time.monotonic() + 3 * LIMIT_S
        while not condition():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.1)

    def start_with(self, errors):
        environment = dict(self.environment, NOTIFY_SOCKET=str(self.folder / "notify"))
        self.process = subprocess.Popen([ZERORATED, "--config", self.file], env=environment, stderr=errors,
                                        stdout=subprocess.DEVNULL)
        self.assertEqual(self.notification(), "READY=1")

    def measures_and_ends(self):
        for _ in range(6):
            self.message()
        self.process.send_signal(signal.SIGTERM)
        self.assertEqual(self.process.wait(timeout=LIMIT_S), 0)

    def test_measures_where_the_reader_of_its_log_has_gone(self):
        ours, theirs = os.pipe()
        self.start_with(theirs)
        os.close(theirs)
        os.close(ours)
        self.measures_and_ends()

    def test_measures_where_nobody_reads_its_log(self):
        ours, theirs = os.pipe()
        os.set_blocking(theirs, False)
        try:
            while True:
                os.write(theirs, bytes(4096))
        except BlockingIOError:
            pass
        os.set_blocking(theirs, True)
        self.start_with(theirs)
        os.close(theirs)
        self.measures_and_ends()
        os.close(ours)

    def test_measures_where_its_log_is_closed(self):
        environment = dict(self.environment, NOTIFY_SOCKET=str(self.folder / "notify"))
        self.process = subprocess.Popen(["sh", "-c", 'exec "$0" --config "$1" 2>&- <&-', ZERORATED, self.file],
                                        env=environment, stdout=subprocess.DEVNULL)
        self.assertEqual(self.notification(), "READY=1")
        self.measures_and_ends()

    def test_measures_where_the_disk_of_its_log_is_full(self):
        full = self.folder / "full"
        try:
            os.mknod(full, stat.S_IFCHR | 0o666, os.makedev(1, 7))
            errors = full.open("w")
        except PermissionError:
            self.skipTest("device nodes cannot be made or opened here")
        self.start_with(errors)
        errors.close()
        self.measures_and_ends()

    def test_tells_that_its_metrics_cannot_be_written(self):
        self.configure(("[metrics]", f'[metrics]\nfile = "{self.folder}/no-folder/metrics"'))
        self.start()
        self.message()
        time.sleep(2.5)
        errors = self.stop()
        self.assertEqual(errors.count(f"metrics: {self.folder}/no-folder/metrics: No such file or directory"), 1,
                         errors)


if __name__ == "__main__":
    unittest.main()
