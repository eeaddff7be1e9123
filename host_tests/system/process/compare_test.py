#!/usr/bin/env python3
"""`zerorate compare` on logs whose biases are known: the figures, the verdict and the advice.

usage: compare_test.py ZERORATE [unittest arguments]
"""

import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

ZERORATE = sys.argv.pop(1)
BAD_DATA, WRONG_USAGE = 3, 2
RATE_HZ = 20
STOP_S, DRIVE_S = 60, 30
NOISE_DPS = 0.01


def log(path, biases_dps, seed, temperatures=None):
    """A vehicle that stands and drives in turn, with one bias from the middle of a drive to that of the next."""
    noise = random.Random(seed)
    names = ["t_s", "rate_dps", "still"] + (["temp_c"] if temperatures else [])
    lines, row = [",".join(names)], 0
    for number in range(len(biases_dps)):
        following = min(number + 1, len(biases_dps) - 1)
        for still, seconds, now in ((1, STOP_S, number), (0, DRIVE_S // 2, number), (0, DRIVE_S // 2, following)):
            for _ in range(seconds * RATE_HZ):
                rate = biases_dps[now] + noise.gauss(0.0, NOISE_DPS) + (0 if still else 10)
                cells = [f"{row / RATE_HZ:.2f}", f"{rate:.6f}", str(still)]
                lines.append(",".join(cells + ([f"{temperatures[now]:.2f}"] if temperatures else [])))
                row += 1
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def root_mean_square(values):
    return math.sqrt(sum(value * value for value in values) / len(values))


class Compare(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        steps = random.Random(3)
        cls.biases = []
        for _ in range(5):
            walk = [0.3]
            while len(walk) < 9:
                walk.append(walk[-1] + steps.gauss(0.0, 0.02))
            cls.biases.append(walk)
        cls.logs = [log(cls.folder / f"{k}.csv", walk, k) for k, walk in enumerate(cls.biases)]

    def zerorate(self, *arguments):
        return subprocess.run([ZERORATE, *map(str, arguments)], capture_output=True, text=True, timeout=100, check=False)

    def compare(self, *arguments):
        run = self.zerorate("compare", *arguments, "--model", "lsm6dso", "--json", "-")
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def test_error_of_the_last_mean_is_that_of_the_steps(self):
        result = self.compare(*self.logs)
        steps = [3600 * (b - a) for walk in self.biases for a, b in zip(walk, walk[1:])]
        self.assertEqual(result["stops"], len(steps))
        last_mean = result["contestants"][-1]
        self.assertEqual(last_mean["name"], "mean of the last stop")
        # A mean of one second of 20 samples has an error of 8 deg/h beside steps of 72.
        self.assertAlmostEqual(last_mean["stop_error_dph"], root_mean_square(steps), delta=0.05 * root_mean_square(steps))
        self.assertEqual(last_mean["stop_ratio"], 1.0)
        self.assertEqual((result["drives"], last_mean["heading_error_deg"]), (0, None))

    def test_error_of_an_exponential_mean_is_that_of_its_rule(self):
        memory_s = 200.0
        errors = []
        for walk in self.biases:
            mean, seen_s = 0.0, 0.0
            for number, bias in enumerate(walk):
                if number > 0:
                    errors.append(3600 * (bias - mean))
                for _ in range((STOP_S - 1) * RATE_HZ):
                    seen_s += 1 / RATE_HZ
                    mean += max(1 / (RATE_HZ * memory_s), 1 / (RATE_HZ * seen_s)) * (bias - mean)
        found = self.compare(*self.logs, "--against", f"exponential:{memory_s}")["contestants"][-1]
        self.assertAlmostEqual(found["stop_error_dph"], root_mean_square(errors), delta=0.05 * root_mean_square(errors))

    def test_walk_of_the_bias_makes_a_long_memory_worse(self):
        run = self.zerorate("compare", *self.logs, "--against", "exponential:600", "--model", "lsm6dso")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("kalman is better than the exponential mean of 600 s", run.stdout)
        self.assertIn("an error of the scale factor cannot be seen", run.stdout)
        self.assertNotIn("nan", run.stdout)

    def test_temperature_that_the_model_leaves_out_is_named(self):
        steps = random.Random(7)
        logs = []
        for k in range(3):
            temperatures = [25 + steps.uniform(-15, 15) for _ in range(12)]
            logs.append(log(self.folder / f"t{k}.csv", [0.2 + 0.02 * (t - 25) for t in temperatures], k, temperatures))
        (unused,) = self.compare(*logs)["unused_inputs"]
        self.assertEqual(unused["quantity"], "temperature")
        # Two stops determine the slope; what is left is the noise of the first seconds, 8 of 360 deg/h and more.
        self.assertLess(unused["stop_ratio"], 0.5)
        self.assertLess(unused["stop_ratio_ci95"][1], 1.0)
        self.model_takes(unused["table"])

    def test_acceleration_that_the_model_leaves_out_is_named(self):
        plain = self.logs[0].read_text(encoding="utf-8").splitlines()
        forces = self.folder / "forces.csv"
        forces.write_text("\n".join([plain[0] + ",ax_mps2,ay_mps2,az_mps2"] + [row + ",0,0,9.81" for row in plain[1:]]) + "\n",
                          encoding="utf-8")
        (unused,) = self.compare(forces)["unused_inputs"]
        self.assertEqual(unused["quantity"], "acceleration")
        self.model_takes(unused["table"])

    def model_takes(self, table):
        """The advice is a table that a model file may have."""
        model = self.folder / "advised.toml"
        shown = self.zerorate("model", "show", "lsm6dso").stdout
        model.write_text(shown + "\n" + table + "\n", encoding="utf-8")
        run = self.zerorate("model", "check", model)
        self.assertEqual(run.returncode, 0, run.stderr)

    def test_logs_without_enough_stops_are_told(self):
        one = log(self.folder / "one.csv", [0.1, 0.2], 1)
        run = self.zerorate("compare", one)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("Too few stops", run.stdout)

    def test_mistakes_are_named(self):
        for text in ("exponential:", "exponential:-3", "exponential:nan", "median"):
            run = self.zerorate("compare", self.logs[0], "--against", text)
            self.assertEqual(run.returncode, WRONG_USAGE)
            self.assertIn("exponential:30", run.stderr)
        broken = self.folder / "broken.csv"
        broken.write_text("t_s,rate_dps\nnonsense\n", encoding="utf-8")
        run = self.zerorate("compare", self.logs[0], broken)
        self.assertEqual(run.returncode, BAD_DATA)
        self.assertIn("broken.csv", run.stderr)


if __name__ == "__main__":
    unittest.main()
