#!/usr/bin/env python3
"""The Python package: the same figures as the command line, the node's bits, arrays in and out, wheel and notebook.

usage: python_test.py ZERORATE FOLDER_OF_THE_PACKAGE NOTEBOOK [unittest arguments]
"""

import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest

ZERORATE = sys.argv.pop(1)
FOLDER = pathlib.Path(sys.argv.pop(1))
NOTEBOOK = pathlib.Path(sys.argv.pop(1))
sys.path.insert(0, str(FOLDER))
sys.dont_write_bytecode = True

import numpy as np  # noqa: E402

import zerorate  # noqa: E402

LIMIT_S = 300.0
SCHEDULE = "still=20,drive=60,seed=1"


def rest(path, rows=6000):
    """White noise and a random walk, 10 samples a second; and every tenth second in motion, by the still column."""
    random = np.random.default_rng(4)
    rates = random.normal(0.0, 0.05, (rows, 3)) + np.cumsum(random.normal(0.0, 0.0005, (rows, 3)), axis=0)
    with open(path, "w", encoding="utf-8") as file:
        file.write("t_s,gx_dps,gy_dps,gz_dps,still\n")
        for i, (x, y, z) in enumerate(rates):
            file.write(f"{0.1 * i:.1f},{x:.6f},{y:.6f},{z:.6f},{int(i % 900 < 600)}\n")
    return path


class MeanOfStop:
    """The calibration mean: without the newest half second, in which the vehicle may move already; where the node doubts the
    calm for a while, what is left of the stop may be too short for a tick."""

    def __init__(self):
        self.mean = np.full(3, np.nan)

    def __call__(self, stop):
        rates = stop.rate_rad_s[stop.time_ns <= stop.time_ns[-1] - 500_000_000]
        if len(rates) >= 5:
            self.mean = rates.mean(axis=0)
        return self.mean


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        cls.addClassCleanup(cls._folder.cleanup)
        cls.folder = pathlib.Path(cls._folder.name)
        cls.path = rest(cls.folder / "rest.csv")
        cls.recording = zerorate.read(cls.path)

    def answer(self, *arguments):
        run = subprocess.run([ZERORATE, *map(str, arguments), "--json", "-"], capture_output=True, text=True, timeout=LIMIT_S,
                             check=False)
        self.assertIn(run.returncode, (0, 1), run.stderr)
        return json.loads(run.stdout)

    def test_characterizes_as_the_command_line(self):
        model = self.folder / "mine.toml"
        expected = self.answer("characterize", self.path, "--model-out", model)
        for recording in (self.path, self.recording):
            noise = zerorate.characterize(recording)
            self.assertEqual(noise.json, expected)
            self.assertEqual(noise.middle.toml, model.read_text(encoding="utf-8"))
        self.assertEqual(noise.axes["x"].angle_random_walk_dps_per_sqrt_hz.lo95,
                         expected["axes"]["x"]["angle_random_walk_dps_per_sqrt_hz"]["lo95"])

    def test_diagnoses_as_the_command_line(self):
        expected = self.answer("diagnose", self.path, "--axis", "z")
        diagnosis = zerorate.diagnose(self.recording, axis="z")
        self.assertEqual({key: diagnosis.json.get(key) for key in expected}, expected)
        self.assertEqual(diagnosis.axes["z"].verdict, expected["verdict"])
        self.assertIn("schema", diagnosis.axes["z"].model.toml)

    def test_evaluates_as_the_command_line(self):
        for schedule in (None, SCHEDULE):
            arguments = ["--schedule", schedule] if schedule else []
            expected = self.answer("replay", self.path, "--model", "lsm6dso", *arguments)
            scores = zerorate.evaluate(self.recording, model="lsm6dso", schedule=schedule)
            self.assertEqual(scores.json, expected)
            self.assertEqual(scores.scores["y"]["kalman"].drives, expected["axes"]["y"]["predictors"]["kalman"]["drives"])

    def test_has_all_coefficients_with_their_intervals(self):
        noise = zerorate.characterize(self.recording)
        for name, axis in noise.axes.items():
            json_of = noise.json["axes"][name]
            ieee = json_of["coefficients"]
            self.assertEqual(axis.coefficients.rate_random_walk_dph_per_sqrt_h is None,
                             ieee["rate_random_walk_dph_per_sqrt_h"] is None)
            self.assertEqual(axis.allan_floor.adev_dph.value, json_of["allan_floor"]["adev_dph"])
            pair = axis.without_flicker.rate_random_walk_dph_per_sqrt_h
            self.assertTrue(pair.lo95 < pair.value < pair.hi95)
            self.assertEqual(pair.value, ieee["without_flicker"]["rate_random_walk_dph_per_sqrt_h"]["value"])

    def test_scores_a_predictor_of_the_user(self):
        """The mean of the last stop, by its exact rule in Python, has the errors of the node's calibration mean."""
        for schedule in (None, SCHEDULE):
            evaluation = zerorate.evaluate(self.recording, model="lsm6dso", schedule=schedule, predictor=MeanOfStop())
            node, own = (evaluation.stops.error_dph[name] for name in ("calibration_mean", "own"))
            self.assertEqual(node.shape, own.shape)
            # The node's ticks begin and end otherwise: of 190 samples of 0.05 deg/s some 15 differ, more where the calm is
            # doubted. Three standard deviations; errors are five times as large.
            self.assertLess(np.nanmedian(np.abs(node - own)), 3 * 3600 * 0.05 * np.sqrt(15) / 190)
            self.assertEqual(evaluation.scores["z"]["own"].stops, np.count_nonzero(np.isfinite(own[:, 2])))
            self.assertGreater(evaluation.scores["z"]["own"].stops, 5)
        drives = evaluation.drives
        rms = {name: np.sqrt(np.nanmean(error[:, 2]**2)) for name, error in drives.error_deg.items()}
        self.assertAlmostEqual(rms["kalman"], evaluation.scores["z"]["kalman"].heading_drift_rms_deg, delta=1e-9 * rms["kalman"])
        self.assertAlmostEqual(rms["own"], evaluation.scores["z"]["own"].heading_drift_rms_deg, delta=1e-9 * rms["own"])
        apart = np.abs(drives.error_deg["own"] - drives.error_deg["calibration_mean"])
        self.assertLess(np.nanmedian(apart), 0.2 * np.sqrt(np.mean(drives.error_deg["calibration_mean"]**2)))
        self.assertEqual(len(drives.length_s), evaluation.scores["z"]["kalman"].drives)

    def test_predictor_that_knows_nothing_leaves_the_whole_bias(self):
        evaluation = zerorate.evaluate(self.recording, model="lsm6dso", schedule=SCHEDULE, predictor=lambda stop: np.zeros(3))
        np.testing.assert_allclose(evaluation.stops.error_dph["own"], evaluation.stops.measured_dph)
        asked = []
        zerorate.evaluate(self.recording, model="lsm6dso", predictor=lambda stop: asked.append(stop) or np.zeros(3))
        self.assertTrue(all(isinstance(stop, zerorate.Recording) and stop.still.all() for stop in asked))
        with self.assertRaisesRegex(ValueError, "expected 3 biases after stop 1"):
            zerorate.evaluate(self.recording, model="lsm6dso", predictor=lambda stop: 0.0)

    def test_takes_a_mask_of_the_stops(self):
        given = zerorate.evaluate(self.recording, model="lsm6dso", still=self.recording.still)
        self.assertEqual(given.json, zerorate.evaluate(self.recording, model="lsm6dso").json)
        self.assertFalse((given.still & ~self.recording.still).any())
        never = zerorate.evaluate(self.recording, model="lsm6dso", still=np.zeros(len(self.recording.time_ns), bool))
        self.assertFalse(never.still.any())
        self.assertEqual(never.scores["x"]["kalman"].stops, 0)
        with self.assertRaisesRegex(ValueError, "still: expected 6000 truth values"):
            zerorate.evaluate(self.recording, model="lsm6dso", still=np.ones(5))

    def test_scores_no_drift_where_nobody_knows_the_rate(self):
        score = zerorate.evaluate(self.recording, model="lsm6dso").scores["z"]["kalman"]
        self.assertEqual((score.heading_drift_rms_deg, score.coverage95), (None, None))
        self.assertGreater(score.stops, 5)

    def test_scores_drives_against_a_reference(self):
        path = self.folder / "drive.csv"
        subprocess.run([ZERORATE, "simulate", "--scenario", "dead-band", "-o", str(path)], check=True, capture_output=True)
        recording = zerorate.read(path)
        self.assertEqual(recording.ref_heading_rad.shape, recording.time_ns.shape)
        expected = self.answer("replay", path, "--model", "lsm6dso", "--vertical-axis", "z")
        for given in (path, recording):
            evaluation = zerorate.evaluate(given, model="lsm6dso", vertical_axis="z")
            self.assertEqual(evaluation.json, expected)
            self.assertGreater(evaluation.true_drives["scored"], 5)
        errors = zerorate.evaluate(path, model="lsm6dso", vertical_axis="z", predictor=MeanOfStop())
        kalman = errors.reference_drives.error_deg["kalman"]
        self.assertEqual(len(kalman), expected["true_drives"]["scored"])
        score = expected["true_drives"]["predictors"]["kalman"]["bias_at_departure"]
        self.assertAlmostEqual(np.sqrt(np.mean(kalman**2)), score["heading_error_rms_deg"], places=9)
        own, mean = (np.sqrt(np.mean(errors.reference_drives.error_deg[name]**2)) for name in ("own", "calibration_mean"))
        self.assertLess(abs(own / mean - 1), 0.5)

    def test_a_node_publishes_what_a_replay_writes(self):
        out = self.folder / "corrected.csv"
        self.answer("replay", self.path, "--model", "lsm6dso", "--out", out)
        whole = zerorate.Node("lsm6dso").replay_recording(self.recording)
        with open(out, encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(whole.time_ns))
        factor = np.float32(180.0 / np.pi)
        for i in range(0, len(rows), 7):
            self.assertEqual(rows[i]["motion"] == "still", whole.still[i])
            self.assertEqual(rows[i]["gx_sigma_dps"] != "", whole.calibrated[i])
            for name, values in (("gx_bias_dps", whole.bias_rad_s), ("gx_sigma_dps", whole.sigma_rad_s)):
                if rows[i][name]:
                    self.assertAlmostEqual(float(rows[i][name]), float(values[i, 0] * factor), delta=2e-7)

    def test_a_node_goes_on_where_it_stopped(self):
        arrays = self.recording.arrays()
        whole = zerorate.Node("lsm6dso").replay(**arrays)
        node = zerorate.Node("lsm6dso", sample_period_s=0.1)
        halves = [node.replay(**{name: value if value is None else value[part] for name, value in arrays.items()})
                  for part in (slice(0, 2500), slice(2500, None))]
        for name in ("bias_rad_s", "sigma_rad_s", "corrected_rad_s", "calibrated"):
            joined = np.concatenate([getattr(half, name) for half in halves])
            np.testing.assert_array_equal(joined, getattr(whole, name))
        self.assertTrue(whole.calibrated.any())

    def test_a_node_takes_single_samples(self):
        node = zerorate.Node("lsm6dso", sample_period_s=0.1)
        steps = [node.step(i * 100_000_000, tuple(self.recording.rate_rad_s[i]), still=True) for i in range(200)]
        self.assertTrue(steps[-1].calibrated[0])

    def test_gives_arrays_of_the_recording(self):
        self.assertEqual(self.recording.time_ns.dtype, np.int64)
        self.assertEqual(self.recording.rate_rad_s.shape, (6000, 3))
        self.assertEqual(self.recording.rate_rad_s.dtype, np.float32)
        self.assertEqual(self.recording.still.dtype, np.bool_)
        self.assertEqual(self.recording.time_ns[3], 300_000_000)
        self.assertIsNone(self.recording.temperature_degc)
        self.assertIsNone(self.recording.acceleration_m_s2)

    def test_gives_accelerations_and_takes_them(self):
        path = self.folder / "accelerated.csv"
        path.write_text("t_s,rate_dps,still,ax_g,ay_g,az_g\n0,0.1,1,0,0,1\n0.1,0.2,1,,,\n0.2,0.1,1,0,-1,0\n", encoding="utf-8")
        recording = zerorate.read(path)
        g = np.float32(9.80665)
        np.testing.assert_array_equal(recording.acceleration_m_s2, np.array([[0, 0, g], [np.nan] * 3, [0, -g, 0]], np.float32))
        self.assertEqual(len(zerorate.Node("lsm6dso").replay_recording(recording).time_ns), 3)
        with self.assertRaisesRegex(ValueError, "acceleration_m_s2: expected n by 3 elements"):
            zerorate.Node("lsm6dso").replay(recording.time_ns, recording.rate_rad_s, still=recording.still,
                                            acceleration_m_s2=recording.acceleration_m_s2[:, :2])

    def test_allan_deviation_is_that_of_its_definition(self):
        rate = np.random.default_rng(1).normal(size=4000)
        curve = zerorate.allan_deviation(rate, 0.5)
        for tau_s, adev in zip(curve.tau_s, curve.adev):
            m = round(tau_s / 0.5)
            means = np.convolve(rate, np.ones(m) / m, "valid")
            self.assertAlmostEqual(adev, np.sqrt(0.5 * np.mean((means[m:] - means[:-m])**2)), delta=1e-9 * adev)

    def test_shows_and_draws_its_results(self):
        import matplotlib
        matplotlib.use("Agg")
        results = [self.recording, zerorate.characterize(self.recording), zerorate.diagnose(self.recording, axis="x"),
                   zerorate.evaluate(self.recording, model="lsm6dso", schedule=SCHEDULE),
                   zerorate.Node("lsm6dso").replay_recording(self.recording),
                   zerorate.allan_deviation(self.recording.rate_rad_s[:, 0], 0.1)]
        for result in results:
            self.assertIn("<table>", result._repr_html_())
            self.assertTrue(result.plot().has_data())

    def test_refuses_figures_that_make_no_sense(self):
        nan, inf = float("nan"), float("inf")
        rate = np.random.default_rng(1).normal(size=1000)
        for points in (nan, inf, -inf, -1.0, 0.0, 1e9):
            with self.assertRaisesRegex(ValueError, "points_per_decade"):
                zerorate.allan_deviation(rate, 1.0, points_per_decade=points)
        for period in (nan, inf, -1.0, 0.0):
            with self.assertRaisesRegex(ValueError, "sample_period_s"):
                zerorate.allan_deviation(rate, period)
            with self.assertRaisesRegex(ValueError, "sample_period_s"):
                zerorate.Node("lsm6dso", sample_period_s=period).replay_recording(self.recording)
        for holdout in (nan, -1.0, 0.0, 1.0):
            with self.assertRaisesRegex(ValueError, "holdout"):
                zerorate.diagnose(self.recording, holdout=holdout)

    def test_refuses_times_and_counts_that_are_no_whole_numbers(self):
        seconds = self.recording.time_s
        for time in (seconds, seconds.astype(np.float32), seconds.astype(str), seconds * np.nan):
            with self.assertRaisesRegex(TypeError, "whole nanoseconds"):
                zerorate.Node("lsm6dso").replay(time, self.recording.rate_rad_s)
            with self.assertRaisesRegex(TypeError, "whole nanoseconds"):
                zerorate.characterize(zerorate.Recording(time, self.recording.rate_rad_s))
        with self.assertRaisesRegex(TypeError, "counts"):
            zerorate.Node("lsm6dso").replay(self.recording.time_ns, self.recording.rate_rad_s, odometer_pulses=seconds)

    def test_takes_paths_that_are_no_utf8(self):
        path = os.fsencode(self.folder) + b"/r\xffst.csv"
        shutil.copy(self.path, path)
        model = os.fsencode(self.folder) + b"/m\xffdel.toml"
        zerorate.model("lsm6dso").save(os.fsdecode(model))
        for name in (path, os.fsdecode(path), pathlib.Path(os.fsdecode(path))):
            recording = zerorate.read(name)
            self.assertEqual((recording.name, len(recording.time_ns)), ("r\ufffdst.csv", 6000))
            self.assertEqual(zerorate.characterize(name).json["recording"], "r\ufffdst.csv")
        self.assertIn("schema", zerorate.model(os.fsdecode(model)).toml)
        zerorate.Node(os.fsdecode(model)).replay_recording(recording)

    def test_a_node_tells_why_its_rate_may_be_wrong(self):
        rows = 2400
        time_ns = np.arange(rows) * 100_000_000
        rate = np.random.default_rng(2).normal(0.0, 1e-3, (rows, 3))
        rate[1200:, 2] += 0.2  # turns, and no pulse comes
        result = zerorate.Node("lsm6dso").replay(time_ns, rate, odometer_pulses=np.zeros(rows, int))
        self.assertFalse(result.odometer_disagreement[:1200].any())
        self.assertTrue(result.odometer_disagreement[1200:].any())
        self.assertFalse(result.saturated.any() or result.temperature_missing.any())
        model = zerorate.model("lsm6dso").toml
        follows = model + "\n[temperature]\nreference_degc = 25.0\nslope_sigma_dps_per_degc = 0.01\n"
        limited = model + "\n[saturation]\nlower_dps = -10.0\nupper_dps = 10.0\n"
        still = np.ones(rows, bool)
        result = zerorate.Node(zerorate.Model("follows", follows)).replay(time_ns, rate, still=still)
        self.assertTrue(result.temperature_missing.all())
        result = zerorate.Node(zerorate.Model("limited", limited)).replay(time_ns, rate, still=still)
        self.assertTrue(result.saturated[1300:].any())

    def test_a_node_shared_by_threads_takes_one_call_at_a_time(self):
        rows = 20_000
        node = zerorate.Node("lsm6dso", sample_period_s=0.01)
        rate = np.random.default_rng(3).normal(0.0, 1e-3, (rows, 3))
        time_ns, still = np.arange(rows) * 10_000_000, np.arange(rows) // 3000 % 2 == 0
        node.replay(time_ns[:100], rate[:100], still=still[:100])
        results, turns = [], 0
        threads = [threading.Thread(target=lambda part=part: results.append(
            node.replay(time_ns + part * 10**12, rate, still=still))) for part in range(1, 5)]
        for thread in threads:
            thread.start()
        while any(thread.is_alive() for thread in threads):
            turns += 1  # what Python does meanwhile
        self.assertEqual(len(results), 4)
        self.assertGreater(turns, 1000)
        for result in results:
            self.assertTrue(np.isfinite(result.bias_rad_s).all())
            # A call is taken whole: all of its samples, or none, are older than those of another.
            self.assertIn(np.count_nonzero(result.has_rate), (0, rows))

    def test_errors_are_exceptions_with_the_sentence_of_the_command_line(self):
        with self.assertRaisesRegex(zerorate.RecordingError, "expected"):
            bad = self.folder / "bad.csv"
            bad.write_text("t_s,gx_dps,gy_dps,gz_dps\n0,a,0,0\n")
            zerorate.read(bad)
        with self.assertRaisesRegex(ValueError, "did you mean"):
            zerorate.model("lsm6ds0")
        with self.assertRaisesRegex(ValueError, "n by 3"):
            zerorate.Node("lsm6dso").replay(np.arange(3), np.zeros((3, 2), np.float32))
        with self.assertRaisesRegex(zerorate.RecordingError, "turned"):
            turned = np.zeros((6000, 3), np.float32) + np.sin(np.arange(6000) / 10.0)[:, None].astype(np.float32)
            zerorate.characterize(zerorate.Recording(self.recording.time_ns, turned))


def run_in(folder, *command, environment=None):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=LIMIT_S, cwd=folder, env=environment,
                          check=False)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    return done.stdout


class DebianPackage(unittest.TestCase):
    def test_puts_the_package_where_debians_python_looks(self):
        with tempfile.TemporaryDirectory(prefix="zerorate-") as folder:
            run_in(folder, "cpack", "--config", FOLDER.parent / "CPackPython.cmake", "-B", folder)
            (package,) = pathlib.Path(folder).glob("python3-zerorate_*.deb")
            depends = run_in(folder, "dpkg-deb", "--field", package, "Depends")
            for name in ("python3-numpy", "libsqlite3-0", "libnlopt0"):
                self.assertIn(name, depends)
            run_in(folder, "dpkg-deb", "--extract", package, "root")
            root = pathlib.Path(folder) / "root"
            self.assertIn("/usr/lib/python3/dist-packages", sys.path)
            where = run_in(folder, sys.executable, "-c", "import zerorate; print(zerorate.__file__, zerorate.catalogue())",
                           environment={"PYTHONPATH": str(root / "usr/lib/python3/dist-packages")})
            self.assertTrue(where.startswith(str(root)), where)


class Wheel(unittest.TestCase):
    def test_installs_without_an_index_and_runs_the_notebook(self):
        wheels = list(FOLDER.glob("zerorate-*.whl"))
        self.assertEqual(len(wheels), 1)
        with tempfile.TemporaryDirectory(prefix="zerorate-") as folder:
            run_in(folder, sys.executable, "-m", "venv", "--system-site-packages", "venv")
            python = pathlib.Path(folder) / "venv/bin/python"
            run_in(folder, python, "-m", "pip", "install", "--no-index", "--quiet", wheels[0])
            where = run_in(folder, python, "-c", "import zerorate; print(zerorate.__file__, zerorate.catalogue())")
            self.assertTrue(where.startswith(folder), where)
            # The kernel named python3 is otherwise that of Debian, which does not see the environment.
            run_in(folder, python, "-m", "ipykernel", "install", "--sys-prefix")
            run_in(folder, python, "-m", "nbconvert", "--to", "notebook", "--execute", "--output-dir", folder, NOTEBOOK)


if __name__ == "__main__":
    unittest.main()
