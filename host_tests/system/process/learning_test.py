#!/usr/bin/env python3
"""What zerorate says of a node that learns: `evaluate drives --learn` and `replay`.

usage: learning_test.py ZERORATE [unittest arguments]
"""

import json
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

ZERORATE = sys.argv.pop(1)
WRONG_USAGE = 2
MODEL = """schema = "zerorate.model/1"
name = "made for a test"
[white]
angle_random_walk_dps_per_sqrt_hz = 0.02
[flicker]
bias_instability_dph = 20.0
order = 0.5
decades = 6
shortest_time_constant_s = 0.5
"""


def recording(path, seed):
    """An hour at rest: white noise, and a bias that wanders around zero within some minutes."""
    noise, bias, lines = random.Random(seed), [0.0] * 3, ["t_s,gx_dps,gy_dps,gz_dps"]
    for second in range(3600):
        bias = [0.995 * one + noise.gauss(0.0, 0.002) for one in bias]
        lines.append(f"{second}," + ",".join(f"{one + noise.gauss(0.0, 0.02):.6f}" for one in bias))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


class Learning(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.recordings = [recording(cls.folder / f"{seed}.csv", seed) for seed in (1, 2)]
        cls.model = cls.folder / "model.toml"
        cls.model.write_text(MODEL, encoding="utf-8")

    def zerorate(self, *arguments):
        return subprocess.run([ZERORATE, *map(str, arguments)], capture_output=True, text=True, timeout=240, check=False)

    def evaluate(self, *options):
        return self.zerorate("evaluate", "drives", *self.recordings, "--schedules", "30/60", "--seeds", 1, *options)

    def test_evaluate_compares_every_data_sheet_with_the_fitted_filters(self):
        report, figures = self.folder / "learn.html", self.folder / "learn.json"
        run = self.evaluate("--learn", self.model, "--white-factor", "1,3", "--flicker-factor", "0.5", "--json", figures,
                            "--report", report)
        self.assertEqual(run.returncode, 0, run.stderr)
        for text in ("fitted on the other recordings", "in hindsight", "learning", "fixed", "First 5 drives", "Coverage",
                     "Noise learnt by the end of a run"):
            self.assertIn(text, run.stdout)
            self.assertIn(text, report.read_text(encoding="utf-8"))
        found = json.loads(figures.read_text(encoding="utf-8"))
        self.assertEqual(found["schema"], "zerorate.learning/1")
        self.assertEqual([(case["white_factor"], case["flicker_factor"]) for case in found["cases"]], [(1, 0.5), (3, 0.5)])
        for standing in [found["fitted_on_others"], found["hindsight"],
                         *(case[who] for case in found["cases"] for who in ("learning", "fixed"))]:
            for figure in ("ratio_to_calibration_mean", "coverage95"):
                low, high = standing[figure + "_ci95"]
                self.assertLessEqual(low, standing[figure])
                self.assertLessEqual(standing[figure], high)
            self.assertIn("coverage95", standing["first_drives"])
            self.assertEqual(len(standing["schedules"]), 1)
        learnt = found["cases"][1]["learnt"]
        self.assertEqual(len(learnt), 6, "a run each of two recordings of three axes")
        for run in learnt:
            low, high = run["angle_random_walk_dps_per_sqrt_hz_ci95"]
            self.assertTrue(low < run["angle_random_walk_dps_per_sqrt_hz"] < high, run)
            self.assertTrue(0.0 < run["order"] < 1.0, run)

    def test_evaluate_refuses_options_that_contradict_each_other(self):
        alone = self.folder / "one.toml"
        alone.write_text(MODEL + "[learning]\nhypotheses = 1\n", encoding="utf-8")
        for options, reason in [
            (["--white-factor", "3"], "--white-factor requires --learn"),
            (["--flicker-factor", "3"], "--flicker-factor requires --learn"),
            (["--learn", self.model, "--fit-on", "itself"], "--fit-on excludes --learn"),
            (["--learn", self.model, "--fit-by", "diagnosis"], "--fit-by excludes --learn"),
            (["--learn", "nonesuch"], "no sensor model \"nonesuch\""),
            (["--learn", self.model, "--white-factor", "0"], "not in range"),
            (["--learn", self.model, "--white-factor", "nan"], "must be positive"),
            (["--learn", self.model, "--flicker-factor", "much"], "much"),
            (["--learn", self.model, "--white-factor", "1,2", "--flicker-factor", "1,2,3"], "name as many"),
            (["--learn", alone], "leaves nothing to learn"),
        ]:
            run = self.evaluate(*options)
            self.assertEqual(run.returncode, WRONG_USAGE, (options, run.stdout, run.stderr))
            self.assertIn(reason, run.stderr)

    def test_replay_tells_what_was_learnt_unless_nothing_is(self):
        command = ["replay", self.recordings[0], "--schedule", "still=60,drive=60,seed=1", "--model"]
        run = self.zerorate(*command, self.model)
        self.assertEqual(run.returncode, 0, run.stderr)
        table = run.stdout[run.stdout.index("Noise model learnt from the stops"):].splitlines()
        self.assertEqual([line.split()[0] for line in table[2:]], ["z", "x", "y"])
        still = self.zerorate("replay", self.recordings[0], "--still-from", "gyro", "--model", self.model)
        self.assertIn("Noise model learnt", still.stdout, "also where nothing is scored")
        alone = self.folder / "alone.toml"
        alone.write_text(MODEL + "[learning]\nhypotheses = 1\n", encoding="utf-8")
        for options in ([self.model, "--trust-model"], [alone]):
            run = self.zerorate(*command, *options)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertNotIn("learnt", run.stdout)
            figures = json.loads(self.zerorate(*command, *options, "--json", "-").stdout)
            self.assertIsNone(figures["axes"]["x"]["learnt"])


if __name__ == "__main__":
    unittest.main()
