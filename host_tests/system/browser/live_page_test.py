#!/usr/bin/env python3
"""The live page of zerorate monitor in a headless browser, beside nodes that run. Loopback only.

usage: live_page_test.py ZERORATE ZERORATED SIMULATED_NODE [unittest arguments]

Without chromium it says so and ends with 77 (skipped).
"""

import json
import os
import pathlib
import re
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

ZERORATE, ZERORATED, SIMULATED_NODE = (sys.argv.pop(1) for _ in range(3))
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
LIMIT_S = 30.0

# A gyro that is not there: the node says so four times a second.
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
[real_time]
lock_memory = false
[[sink]]
type = "udp"
address = "127.0.0.1"
port = {port}
"""


class Browser:
    """A page in chromium, driven through a pipe by its own protocol."""

    def __init__(self, folder, url):
        to_browser, self.commands = os.pipe()
        self.answers, from_browser = os.pipe()

        def give_pipes():  # as descriptors 3 and 4, which the protocol wants
            first, second = os.dup(to_browser), os.dup(from_browser)
            os.dup2(first, 3)
            os.dup2(second, 4)
        self.process = subprocess.Popen(
            [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--window-size=1100,1400", f"--user-data-dir={folder}",
             "--remote-debugging-pipe"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=give_pipes,
            close_fds=False)
        os.close(to_browser)
        os.close(from_browser)
        self.unread, self.number, self.complaints = b"", 0, []
        target = self.command("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.command("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Runtime", "Log", "Page"):
            self.page(f"{domain}.enable")
        self.page("Page.navigate", url=url)

    def command(self, method, session=None, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.commands, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") == self.number:
                assert "result" in answer, answer
                return answer["result"]
            if answer.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded"):
                self.complaints.append(answer["params"])

    def message(self):
        while b"\0" not in self.unread:
            assert select.select([self.answers], [], [], LIMIT_S)[0], "the browser is silent"
            received = os.read(self.answers, 1 << 20)
            assert received, "the browser has ended"
            self.unread += received
        message, self.unread = self.unread.split(b"\0", 1)
        return json.loads(message)

    def page(self, method, **parameters):
        return self.command(method, self.session, **parameters)

    def evaluate(self, expression):
        return self.page("Runtime.evaluate", expression=expression, returnByValue=True)["result"].get("value")

    def close(self):
        os.close(self.commands)
        os.close(self.answers)
        self.process.terminate()
        self.process.wait(timeout=LIMIT_S)


class LivePage(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="zerorate-", ignore_cleanup_errors=True)
        self.folder = pathlib.Path(self._folder.name)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.processes = []
        self.monitor, self.url = self.start_monitor()
        self.assertRegex(self.url, r"^http://127\.0\.0\.1:\d+/$")

    def tearDown(self):
        for process in self.processes:
            if process.poll() is None:
                process.kill()
            process.communicate()
        self._folder.cleanup()

    def start_monitor(self, http_port=0):
        monitor = self.start(ZERORATE, "monitor", "--udp", self.port, "--http", http_port, "--interval", 0.2,
                             stderr=subprocess.PIPE)
        return monitor, monitor.stderr.readline().decode().split()[-1]

    def start(self, *command, stderr=subprocess.DEVNULL):
        process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=stderr)
        self.processes.append(process)
        return process

    def end(self, process, code=0):
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=LIMIT_S), code)

    def browse(self):
        browser = Browser(self.folder / f"profile-{time.monotonic_ns()}", self.url)
        self.addCleanup(browser.close)
        return browser

    def wait_for(self, browser, expression):
        deadline = time.monotonic() + LIMIT_S
        while not browser.evaluate(expression):
            if time.monotonic() > deadline:
                self.fail(f"never true: {expression}\n" + (browser.evaluate("document.body.innerText") or ""))
            time.sleep(0.1)

    def wait_for_motion(self, browser, words):
        self.wait_for(browser, f"document.getElementById('motion').textContent === '{words}'")

    def test_shows_a_node_that_stands_drives_and_learns(self):
        self.start(SIMULATED_NODE, self.port)
        browser = self.browse()
        self.wait_for_motion(browser, "Standing still")
        self.wait_for_motion(browser, "Driving")
        self.wait_for(browser, "document.getElementById('learnt').tBodies[0].rows.length === 3"
                               " && !document.getElementById('learnt').hidden")
        self.wait_for(browser, "Number(document.getElementById('axes').dataset.points) >= 3")
        self.wait_for(browser, "document.getElementById('verdict').textContent.includes('All is well')")
        text = browser.evaluate("document.body.innerText")
        self.assertRegex(text, r"z: turning at\s+-?0\.\d\d deg/s\s+bias 0\.3[45]\d\d ± 0\.\d{4} deg/s")
        self.assertRegex(text, r"\d+ stops? since the monitor was started\.")
        self.assertRegex(text, r"Learnt from \d+(\.\d)? stops? .* known to ± \d+ %\.")
        self.assertRegex(text, r"x\t\S+ ± \S+\t0\.\d+ ± \S+\t0\.\d+ ± \S+")
        self.assertRegex(text, r"From udp 127\.0\.0\.1:\d+: \d+ messages")
        self.assertEqual(browser.evaluate("document.querySelectorAll('#axes canvas').length"), 3)
        painted = """[...document.querySelectorAll('#axes canvas')].every((canvas) => canvas.getContext('2d')
                     .getImageData(0, 0, canvas.width, canvas.height).data.some((byte) => byte !== 0))"""
        self.assertTrue(browser.evaluate(painted))
        self.assertEqual(browser.complaints, [])

    def test_shows_nothing_of_the_past_as_the_present_and_goes_on_when_the_node_comes_back(self):
        browsers = [self.browse(), self.browse()]
        for browser in browsers:
            self.wait_for_motion(browser, "Waiting for the node")
        for _ in range(2):
            node = self.start(SIMULATED_NODE, self.port)
            for browser in browsers:
                self.wait_for_motion(browser, "Standing still")
                self.wait_for(browser, "/\\d/.test(document.querySelector('.rate').textContent)")
            self.end(node)
            for browser in browsers:
                self.wait_for_motion(browser, "The node is silent")
                text = browser.evaluate("document.body.innerText")
                self.assertIn("x: turning at\n– deg/s", re.sub(r"\n+", "\n", text))
                self.assertIn("Is zerorated running", text)
                self.assertNotIn("All is well", text)

    def test_says_that_the_monitor_is_away_and_goes_on_when_it_is_back(self):
        self.start(SIMULATED_NODE, self.port)
        browser = self.browse()
        self.wait_for_motion(browser, "Standing still")
        for signal_number in (signal.SIGTERM, signal.SIGSTOP):  # it ends; it hangs
            self.monitor.send_signal(signal_number)
            self.wait_for_motion(browser, "No connection")
            text = re.sub(r"\n+", "\n", browser.evaluate("document.body.innerText"))
            self.assertIn("x: turning at\n– deg/s", text)
            self.assertNotIn("All is well", text)
            if signal_number == signal.SIGTERM:
                self.assertEqual(self.monitor.wait(timeout=LIMIT_S), 0)
                self.monitor, url = self.start_monitor(self.url.rstrip("/").rsplit(":", 1)[1])
                self.assertEqual(url, self.url)
            else:
                self.monitor.send_signal(signal.SIGCONT)
            self.wait_for(browser, "document.documentElement.dataset.live === 'true'")
            self.wait_for(browser, "document.getElementById('verdict').textContent.includes('All is well')")

    def test_says_what_is_wrong_with_zerorated_and_what_to_do(self):
        browser = self.browse()
        self.wait_for_motion(browser, "Waiting for the node")
        file = self.folder / "zerorated.toml"
        file.write_text(CONFIGURATION.format(folder=self.folder, port=self.port))
        node = self.start(ZERORATED, "--config", file)
        self.wait_for(browser, "document.getElementById('health').textContent.includes('The gyro gives no samples')")
        text = browser.evaluate("document.getElementById('health').innerText")
        self.assertIn("'zerorate probe' looks for it", text)
        self.assertIn("The odometer cannot be read", text)
        self.assertIn("No bias is known yet", text)
        self.wait_for_motion(browser, "Standing or driving: not known")
        self.assertIn("3 things to look at", browser.evaluate("document.getElementById('verdict').textContent"))
        self.end(node)
        self.assertEqual(browser.complaints, [])

    def test_page_loads_nothing_from_elsewhere(self):
        with urllib.request.urlopen(self.url, timeout=LIMIT_S) as answer:
            page = answer.read().decode()
        self.assertIn("default-src 'none'", page)
        self.assertNotRegex(page, r"""(src|href)=["']?(https?:)?//""")


if __name__ == "__main__":
    if not BROWSER:
        print("skipped: no chromium")
        sys.exit(77)
    unittest.main()
