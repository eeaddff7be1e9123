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
import time
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


def driven(path, biases_dps, seed, scale):
    """A vehicle with a reference of heading and speed, whose gyro measures too much by `scale` and turns 300 deg a drive."""
    noise = random.Random(seed)
    lines, row, heading = ["t_s,rate_dps,still,ref_heading_deg,ref_speed_mps"], 0, 0.0
    for number, bias in enumerate(biases_dps):
        turn = noise.choice((-10, 10))
        for still, seconds in ((1, STOP_S), (0, DRIVE_S)):
            for _ in range(seconds * RATE_HZ):
                true = 0 if still else turn
                rate = bias + (1 + scale) * true + noise.gauss(0.0, NOISE_DPS)
                lines.append(f"{row / RATE_HZ:.2f},{rate:.6f},{still},{heading:.4f},{0 if still else 2}")
                heading += true / RATE_HZ
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

    def test_stop_with_a_charger_is_scored_by_its_first_temperature(self):
        """Three stops of four minutes, in which the sensor warms up by 6 K: 430 deg/h, which no prediction has to know."""
        noise, temperature, row, lines = random.Random(5), 25.0, 0, ["t_s,rate_dps,still,temp_c"]
        for number in range(12):
            charges = number % 4 == 3
            for still, seconds in ((1, 240 if charges else 30), (0, 150)):
                for _ in range(seconds * RATE_HZ):
                    temperature += ((33 if still and charges else 25) - temperature) / (RATE_HZ * 200)
                    rate = 0.1 + 0.02 * (temperature - 25) + noise.gauss(0.0, NOISE_DPS) + (0 if still else 8)
                    lines.append(f"{row / RATE_HZ:.2f},{rate:.6f},{still},{temperature:.3f}")
                    row += 1
        path = self.folder / "charger.csv"
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        model = self.folder / "warm.toml"
        table = "[temperature]\nreference_degc = 25\nslope_sigma_dps_per_degc = 0.03\n"
        model.write_text(self.zerorate("model", "show", "lsm6dso").stdout + "\n" + table, encoding="utf-8")
        run = self.zerorate("replay", path, "--model", model, "--json", "-")
        score = json.loads(run.stdout)["axes"]["rate"]["predictors"]["kalman"]
        # Of 11 stops an honest sigma gives 1 +- 0.21; the mean of the whole minute of a stop gave 10.
        self.assertLess(score["stop_error_rms_sigmas"], 1 + 4 * 0.21)

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

    def with_column(self, number, name, value_of):
        """A log with one more column, made of the number of the stop that is or was."""
        lines = self.logs[number].read_text(encoding="utf-8").splitlines()
        rows, stops, stood = [f"{lines[0]},{name}"], 0, False
        for line in lines[1:]:
            still = line.endswith(",1")
            stops += still and not stood
            stood = still
            rows.append(f"{line},{value_of(stops - 1):.9f}")
        path = self.folder / f"{name}{number}.csv"
        path.write_text("\n".join(rows) + "\n", encoding="utf-8")
        return path

    def test_column_of_the_biases_before_is_the_last_mean(self):
        logs = [self.with_column(k, "mine_dps", lambda stop, k=k: self.biases[k][stop]) for k in range(5)]
        steps = [3600 * (b - a) for walk in self.biases for a, b in zip(walk, walk[1:])]
        found = self.compare(*logs, "--against", "column:mine_dps")["contestants"][-1]
        self.assertEqual(found["name"], "column mine_dps")
        self.assertAlmostEqual(found["stop_error_dph"], root_mean_square(steps), delta=0.05 * root_mean_square(steps))

    def test_column_that_saw_the_future_is_found_out_as_perfect(self):
        """Biases of the next stop: what is left is the white noise of its first seconds, half of kalman's own sigma."""
        logs = [self.with_column(k, "ahead_dph", lambda stop, k=k: 3600 * self.biases[k][min(stop + 1, 8)]) for k in range(5)]
        result = self.compare(*logs, "--against", "column:ahead_dph")
        errors = {one["name"]: one["stop_error_dph"] for one in result["contestants"]}
        self.assertLess(errors["column ahead_dph"], 0.5 * errors["kalman"])
        self.assertIn("worse", result["verdict"])

    def test_unit_of_a_column_without_one_is_that_of_the_recording(self):
        plain = [self.with_column(k, "mine", lambda stop, k=k: self.biases[k][stop]) for k in range(2)]
        named = [self.with_column(k, "mine_dps", lambda stop, k=k: self.biases[k][stop]) for k in range(2)]
        errors = [self.compare(*logs, "--against", f"column:{name}")["contestants"][-1]["stop_error_dph"]
                  for logs, name in ((plain, "mine"), (named, "mine_dps"))]
        self.assertEqual(*errors)

    def script(self, name, text):
        path = self.folder / f"{name}.py"
        path.write_text(text, encoding="utf-8")
        return f"script:{sys.executable} {path}"

    def test_program_with_the_rule_of_an_exponential_mean_has_its_errors(self):
        memory_s = 200.0
        program = self.script("mean", f"""
import csv, sys
mean, seen, stop = 0.0, 0, None
print("rate_dps")
for row in csv.DictReader(sys.stdin):
    if stop not in (None, row["stop"]): print(repr(mean))
    stop = row["stop"]
    seen += 1
    mean += max(1 / ({RATE_HZ} * {memory_s}), 1 / seen) * (float(row["rate_dps"]) - mean)
print(repr(mean))
""")
        errors = [self.compare(*self.logs, "--against", against)["contestants"][-1]["stop_error_dph"]
                  for against in (program, f"exponential:{memory_s}")]
        self.assertAlmostEqual(errors[0] / errors[1], 1.0, delta=1e-3)

    def test_program_that_fails_is_told_with_its_words(self):
        for name, text, words in (
                ("fails", "import sys; sys.exit('no such matrix')", ("exit code 1", "no such matrix")),
                ("silent", "", ("0 lines of biases for ",)),
                ("wordy", "print('0.1\\nwell')", ("line 2", "well", "expected a bias")),
                ("kills", "import os; os.kill(os.getpid(), 9)", ("signal 9",))):
            run = self.zerorate("compare", self.logs[0], "--against", self.script(name, text))
            # The shell may take the place of the program, or tell of its end.
            self.assertEqual(run.returncode, BAD_DATA, run.stderr)
            for word in words:
                self.assertIn(word.replace("signal 9", "137") if "137" in run.stderr else word, run.stderr)
            self.assertIn("0.csv", run.stderr)

    def test_program_that_never_ends_is_ended(self):
        began = time.monotonic()
        run = self.zerorate("compare", self.logs[0], "--script-seconds", "0.5", "--against",
                            self.script("sleeps", "import time; time.sleep(600)"))
        self.assertEqual(run.returncode, BAD_DATA)
        self.assertIn("ended after 0.5 s", run.stderr)
        self.assertLess(time.monotonic() - began, 60)

    def test_scale_error_is_not_seen_without_a_reference(self):
        self.assertIn("scale factor cannot be seen", " ".join(self.compare(self.logs[0])["advice"]))
        self.assertIsNone(self.compare(self.logs[0])["scale_factor"])

    def test_scale_error_is_named_with_a_reference(self):
        for scale, is_told in ((0.015, True), (0.0, False)):
            logs = [driven(self.folder / f"s{k}.csv", walk, k, scale) for k, walk in enumerate(self.biases)]
            result = self.compare(*logs)
            found = result["scale_factor"]
            low, high = found["error_percent_ci95"]
            # Four of the standard errors that it states, which a drive of 300 deg makes small.
            self.assertAlmostEqual(found["error_percent"], 100 * scale, delta=(high - low))
            self.assertEqual("show an error of the scale factor of" in " ".join(result["advice"]), is_told)
            if is_told:
                self.assertLess(found["heading_ratio_ci95"][1], 0.5)
                self.assertLess(high - low, 0.2)
                self.model_takes(found["table"])

    def test_sensitivity_to_acceleration_is_named(self):
        """A robot that stands on ramps: 0.05 deg/s/g along x, of which the tilt gives up to 0.5 g."""
        tilts = random.Random(11)
        logs = []
        for k in range(3):
            forces = [tilts.uniform(-0.5, 0.5) for _ in range(12)]
            path = log(self.folder / f"g{k}.csv", [0.2 + 0.05 * force for force in forces], k, forces)
            rows = path.read_text(encoding="utf-8").splitlines()
            tilted = ["t_s,rate_dps,still,ax_g,ay_g,az_g"]
            for row in rows[1:]:
                cells = row.split(",")
                along = float(cells.pop())
                tilted.append(",".join(cells + [f"{along:.4f}", "0", f"{math.sqrt(1 - along * along):.4f}"]))
            path.write_text("\n".join(tilted) + "\n", encoding="utf-8")
            logs.append(path)
        (unused,) = self.compare(*logs)["unused_inputs"]
        self.assertEqual(unused["quantity"], "acceleration")
        self.assertLess(unused["stop_ratio_ci95"][1], 1.0)

    def test_columns_that_do_not_fit_are_named(self):
        one = self.with_column(0, "mine_dps", lambda stop: 0.0)
        for against, words in (("column:yours_dps", "no column"), ("column:a,b", "--against"),
                               ("column:mine_dps,a,b", "3 columns for 1 axes")):
            run = self.zerorate("compare", one, "--against", against)
            self.assertIn(run.returncode, (BAD_DATA, WRONG_USAGE))
            self.assertIn(words, run.stderr)

    def test_mistakes_are_named(self):
        for text in ("exponential:", "exponential:-3", "exponential:nan", "median", "column:", "script:"):
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
