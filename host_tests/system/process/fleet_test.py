#!/usr/bin/env python3
"""Fleets as processes: killed runs, shards, a Slurm of the test's own, and the commands around them.

usage: fleet_test.py ZERORATE REPOSITORY [unittest arguments]

$ZERORATE_FLEET_KILLS is the number of kill -9 at random moments, $ZERORATE_FLEET_SENSORS that of the sensors of the
simulated population, $ZERORATE_FLEET_NEW_SENSORS that of the sensors that start with its prior. Without Slurm OnSlurm
says so and ends with 77 (skipped).
"""

import csv
import json
import math
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import unittest

ZERORATE = sys.argv.pop(1)
REPOSITORY = pathlib.Path(sys.argv.pop(1))
KILLS = int(os.environ.get("ZERORATE_FLEET_KILLS", "5"))
SENSORS = int(os.environ.get("ZERORATE_FLEET_SENSORS", "80"))
NEW_SENSORS = int(os.environ.get("ZERORATE_FLEET_NEW_SENSORS", "40"))
SLURM = ("munged", "slurmctld", "slurmd", "sinfo", "sbatch", "squeue", "scancel", "scontrol")
PASS, FAIL, USAGE, BAD_DATA, TOO_SHORT = range(5)


def zerorate(*arguments, timeout=300):
    return subprocess.run([ZERORATE, *map(str, arguments)], capture_output=True, text=True, timeout=timeout, check=False)


def successful(*arguments, timeout=300):
    run = zerorate(*arguments, timeout=timeout)
    if run.returncode != 0:
        raise RuntimeError(f"{arguments}: {run.stderr}")
    return run


def block_of_how_to(mark):
    text = (REPOSITORY / "docs/how-to/run-a-fleet.md").read_text(encoding="utf-8")
    return re.search(rf"<!-- {mark} -->\n```\w+\n(.*?)```", text, re.DOTALL)[1]


class MadeFleet(unittest.TestCase):
    """Six simulated sensors, and the database that one process makes of them."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.fleet = cls.folder / "fleet"
        successful("simulate", "--fleet", "--sensors", 6, "--samples", 1500, "--lots", 2, "--seed", 3, "-o", cls.fleet)
        cls.one = cls.folder / "one.sqlite"
        successful("fleet", "run", cls.fleet, "--db", cls.one, "--json", cls.folder / "run.json")
        cls.expected = cls.merged(cls.one)

    @classmethod
    def merged(cls, *shards):
        out = pathlib.Path(tempfile.mkdtemp(dir=cls.folder)) / "merged.sqlite"
        successful("fleet", "merge", *shards, "--db", out)
        return out.read_bytes()


class Fleet(MadeFleet):
    def test_run_tells_what_it_did_and_is_quiet_without_a_terminal(self):
        summary = json.loads((self.folder / "run.json").read_text(encoding="utf-8"))
        self.assertEqual((summary["recordings"], summary["analysed"], summary["bad"]), (6, 6, []))
        again = zerorate("fleet", "run", self.fleet, "--db", self.one)
        self.assertIn("0 analysed", again.stdout)
        self.assertEqual(again.stderr, "")

    def test_two_jobs_give_the_bytes_of_one(self):
        two = self.folder / "two.sqlite"
        self.assertEqual(zerorate("fleet", "run", self.fleet, "--db", two, "--jobs", 2).returncode, 0)
        self.assertEqual(self.merged(two), self.expected)

    def test_runs_that_are_killed_lose_nothing_and_repeat_nothing(self):
        database, moments = self.folder / "killed.sqlite", random.Random(21)
        started = time.monotonic()
        zerorate("fleet", "run", self.fleet, "--db", self.folder / "timed.sqlite")
        duration = time.monotonic() - started
        for _ in range(KILLS):
            run = subprocess.Popen([ZERORATE, "fleet", "run", self.fleet, "--db", database], stdout=subprocess.DEVNULL)
            time.sleep(moments.uniform(0.0, 0.5 * duration))
            run.send_signal(signal.SIGKILL)
            run.wait(timeout=60)
            if database.exists() and database.stat().st_size > 0:
                self.merged(database)  # whole at every moment
        last = zerorate("fleet", "run", self.fleet, "--db", database, "--json", "-")
        summary = json.loads(last.stdout)
        self.assertEqual(summary["analysed"] + summary["done_before"], 6)
        self.assertEqual(self.merged(database), self.expected)

    def test_second_writer_is_refused(self):
        database = self.folder / "shared.sqlite"
        first = subprocess.Popen([ZERORATE, "fleet", "run", self.fleet, "--db", database], stdout=subprocess.DEVNULL)
        try:
            deadline = time.monotonic() + 60
            while not database.exists() and time.monotonic() < deadline:
                time.sleep(0.01)
            second = zerorate("fleet", "run", self.fleet, "--db", database)
            if first.poll() is None:
                self.assertEqual(second.returncode, BAD_DATA)
                self.assertIn("another process", second.stderr)
        finally:
            first.wait(timeout=300)

    def test_wrong_usage_is_told(self):
        for shard in ("0/2", "3/2", "1", "1/2x"):
            run = zerorate("fleet", "run", self.fleet, "--db", self.folder / "x", "--shard", shard)
            self.assertEqual(run.returncode, USAGE)
            self.assertIn("--shard", run.stderr)
        self.assertEqual(zerorate("fleet").returncode, USAGE)
        self.assertEqual(zerorate("simulate").returncode, USAGE)

    def test_report_prior_and_limits_are_read_by_those_who_need_them(self):
        report = self.folder / "report.json"
        successful("fleet", "report", "--db", self.one, "--json", report, "--report", self.folder / "fleet.html",
                   "--csv", self.folder / "axes.csv", "--limits-out", self.folder / "limits.toml")
        self.assertEqual(json.loads(report.read_text(encoding="utf-8"))["axes"], 18)
        self.assertEqual(len((self.folder / "axes.csv").read_text(encoding="utf-8").splitlines()), 19)
        successful("fleet", "report", "--db", self.one, "--json", report, "--report", self.folder / "yield.html",
                   "--limits", self.folder / "limits.toml")
        quality = json.loads(report.read_text(encoding="utf-8"))["quality"]
        sensors = quality["passed"] + quality["failed"] + quality["too_short"]
        self.assertEqual(sensors, json.loads(report.read_text(encoding="utf-8"))["sensors"])
        self.assertLess(quality["yield"]["ci95"][0], quality["yield"]["ci95"][1])
        html = (self.folder / "yield.html").read_text(encoding="utf-8")
        for words in ("Yield and capability", "Ppk", "Control charts"):
            self.assertIn(words, html)
        model = self.folder / "type.toml"
        successful("fleet", "prior", "--db", self.one, "--model-out", model)
        self.assertIn("[prior]", model.read_text(encoding="utf-8"))
        recording = self.fleet / "S00001-1.csv.gz"
        successful("replay", recording, "--model", model, "--schedule", "still=10,drive=10,seed=1")
        accepted = zerorate("accept", recording, "--limits", self.folder / "limits.toml", "--json", "-")
        self.assertIn(accepted.returncode, (PASS, FAIL, TOO_SHORT), accepted.stderr)
        self.assertEqual(json.loads(accepted.stdout)["recording"], recording.name)

    def test_kubernetes_manifest_has_the_fields_of_an_indexed_job(self):
        try:
            import yaml
        except ImportError:
            self.skipTest("no python3-yaml")
        job = yaml.safe_load(block_of_how_to("kubernetes"))
        self.assertEqual((job["apiVersion"], job["kind"]), ("batch/v1", "Job"))
        spec = job["spec"]
        self.assertEqual(spec["completionMode"], "Indexed")
        self.assertLessEqual(spec["parallelism"], spec["completions"])
        pod = spec["template"]["spec"]
        self.assertIn(pod["restartPolicy"], ("OnFailure", "Never"))
        (worker,) = pod["containers"]
        self.assertIn("JOB_COMPLETION_INDEX", worker["args"][0])
        self.assertIn(f"/{spec['completions']}", worker["args"][0])
        self.assertEqual({one["name"] for one in pod["volumes"]}, {one["name"] for one in worker["volumeMounts"]})


class Population(unittest.TestCase):
    """A larger simulated fleet is described as it was made, and its prior helps the next sensors."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.database = cls.folder / "fleet.sqlite"
        cls.simulate("fleet", "--sensors", SENSORS, "--seed", 11)
        successful("fleet", "run", cls.folder / "fleet", "--db", cls.database, "--jobs", 0, timeout=None)
        run = successful("fleet", "report", "--db", cls.database, "--json", "-", timeout=None)
        cls.report = json.loads(run.stdout)
        with open(cls.folder / "fleet/truth.csv", encoding="utf-8", newline="") as file:
            cls.truth = list(csv.DictReader(file))

    @classmethod
    def simulate(cls, name, *options):
        successful("simulate", "--fleet", *options, "--jobs", 0, "-o", cls.folder / name, timeout=None)

    def test_means_and_spreads_are_those_of_the_sensors(self):
        # Eighty sensors differ from what they are drawn from by chance: that is no error of the report.
        for key, kind, column, coordinate in (
                ("angle_random_walk_dps_per_sqrt_hz", "log_", "white_dps_per_sqrt_hz", math.log),
                ("bias_instability_dph", "log_", "flicker_dph", math.log), ("order", "", "order", float)):
            sensors = {}
            for row in self.truth:
                if row["lot_is_bad"] == "0":
                    sensors.setdefault(row["sensor"], []).append(coordinate(float(row[column])))
            means = [statistics.mean(axes) for axes in sensors.values()]
            sampling = statistics.stdev(means) / math.sqrt(len(means))
            figure = self.report["distributions"][key]
            error, deviation = figure["mean_standard_error"], figure[f"{kind}mean"] - statistics.mean(means)
            ratio = figure[f"{kind}spread"] / statistics.pstdev(value for axes in sensors.values() for value in axes)
            print(f"{key}: mean off by {deviation:.4f} = {deviation / error:.2f} errors, spread {ratio:.3f} of the truth, "
                  f"error {error / sampling:.2f} times that of the sampling")
            # The standard error counts both the sampling, known within 1 / sqrt(2 sensors), and the errors of the
            # recordings, which double it at most. Only the latter are in the deviation.
            self.assertLess(abs(deviation), 3.0 * error)
            self.assertGreater(error / sampling, 1.0 - 3.0 / math.sqrt(2.0 * len(means)))
            self.assertLess(error / sampling, 2.0)
            # Three axes of a sensor have half of their variance in common: sampling leaves the spread an error of
            # 1 / (2 sqrt(sensors)), and what doubles it at most adds sqrt(3) times as much.
            self.assertLess(abs(ratio - 1.0), 3.0 * math.sqrt(3.0) / (2.0 * math.sqrt(len(means))))

    def test_hidden_effects_and_the_bad_lot_are_named(self):
        bad = {row["lot"] for row in self.truth if row["lot_is_bad"] == "1"}
        differing = {row["lot"] for row in self.report["lots"] if row["differs"]}
        self.assertLessEqual(bad, differing)
        self.assertLessEqual(len(differing - bad), 1)  # at a false discovery rate of 0.05 one fleet in twenty has one
        hidden = {row["sensor"]: row["effect"] for row in self.truth if row["effect"] and row["lot"] not in bad}
        named = {row["sensor"] for row in self.report["outliers"] if row["lot"] not in bad}
        missed = {sensor: effect for sensor, effect in hidden.items() if sensor not in named}
        wrong = {row["sensor"]: row["reason"] for row in self.report["outliers"] if row["sensor"] in named - set(hidden)}
        print(f"hidden {len(hidden)}, named of them {len(hidden) - len(missed)}, missed {missed}, wrong {wrong}")
        # 95 % are to be found, and 5 % of the named may be wrong: three binomial standard deviations, and one.
        self.assertLessEqual(len(missed), 1 + 0.05 * len(hidden) + 3 * math.sqrt(0.05 * len(hidden)))
        self.assertLessEqual(len(wrong), 1 + 0.05 * len(named) + 3 * math.sqrt(0.05 * len(named)))

    def test_prior_of_the_fleet_predicts_the_first_hour_of_new_sensors_better(self):
        successful("fleet", "prior", "--db", self.database, "--model-out", self.folder / "type.toml", timeout=None)
        (self.folder / "sheet.toml").write_text("""schema = "zerorate.model/1"
name = "data sheet"
[white]
angle_random_walk_dps_per_sqrt_hz = 0.005
[flicker]
bias_instability_dph = 12.0
order = 0.5
decades = 6
shortest_time_constant_s = 0.5
""", encoding="utf-8")
        self.simulate("new", "--sensors", NEW_SENSORS, "--samples", 72000, "--hidden-share", 0, "--bad-lot-factor", 1, "--seed", 12)
        gains, coverages = [], {"type": [], "sheet": []}
        for number, recording in enumerate(sorted((self.folder / "new").glob("*.csv.gz"))):
            drifts = {}
            for model, into in coverages.items():
                run = successful("replay", recording, "--model", self.folder / f"{model}.toml", "--json", "-",
                                 "--schedule", f"still=60,drive=300,seed={number}")
                axes = [axis["predictors"]["kalman"] for axis in json.loads(run.stdout)["axes"].values()]
                drifts[model] = math.sqrt(sum(axis["heading_drift_rms_deg"] ** 2 for axis in axes))
                into.append(statistics.mean(axis["coverage95"] for axis in axes))
            gains.append(math.log(drifts["type"] / drifts["sheet"]))
        gain, error = interval(gains)
        print(f"heading drift over the data sheet's {math.exp(gain):.3f} "
              f"[{math.exp(gain - error):.3f}, {math.exp(gain + error):.3f}]")
        for model, values in coverages.items():
            print("coverage of {}: {:.3f} +- {:.3f}".format(model, *interval(values)))
        self.assertLess(gain, error)  # not worse
        self.assertGreater(statistics.mean(coverages["type"]), 0.9)


def interval(values):
    """The mean, and half the width of its 95 % interval."""
    return statistics.mean(values), 1.96 * statistics.stdev(values) / math.sqrt(len(values))


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Slurm:
    """munged, slurmctld and slurmd of this test, on loopback, with a configuration and folders of their own."""

    def __init__(self, folder):
        self.folder = folder
        for name in ("state", "spool", "munge"):
            (folder / name).mkdir()
        os.chmod(folder / "munge", 0o700)
        key = folder / "munge/key"
        key.write_bytes(os.urandom(1024))
        os.chmod(key, 0o400)
        host = socket.gethostname().split(".")[0]
        (folder / "slurm.conf").write_text(f"""ClusterName=zerorate
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MpiDefault=none
NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
""", encoding="utf-8")
        self.environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf")}
        self.daemons = []

    def start(self, *command):
        log = open(self.folder / f"{command[0]}.out", "wb")
        self.daemons.append(subprocess.Popen(command, env=self.environment, stdout=log, stderr=log))
        log.close()

    def __enter__(self):
        munge = self.folder / "munge"
        self.start("munged", "--foreground", "--force", f"--key-file={munge}/key", f"--socket={munge}/socket",
                   f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed")
        self.wait_for((munge / "socket").exists, 30)
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        self.wait_for(lambda: "idle" in self.call("sinfo", "-h", "-o", "%t"), 90)
        return self

    def __exit__(self, *_):
        self.call("scancel", "--user", "root")
        for daemon in reversed(self.daemons):
            daemon.terminate()
            try:
                daemon.wait(timeout=30)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait(timeout=30)

    def call(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=60, check=False).stdout

    @staticmethod
    def wait_for(condition, seconds):
        deadline = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > deadline:
                raise TimeoutError(f"{condition} after {seconds} s")
            time.sleep(0.2)


class OnSlurm(MadeFleet):
    """The array of the how-to, one of its tasks killed and requeued."""

    def test_array_with_a_killed_task_gives_the_bytes_of_one_process(self):
        parts = self.folder / "parts"
        parts.mkdir()
        script = self.folder / "fleet.sh"
        # A worker that dies in its first life once its database is there.
        die = f"""if [ "$SLURM_ARRAY_TASK_ID" = 2 ] && [ "${{SLURM_RESTART_COUNT:-0}}" = 0 ]; then
  {ZERORATE} fleet run "$FLEET" --db "$PARTS/part2.sqlite" --shard 2/4 & worker=$!
  while [ ! -s "$PARTS/part2.sqlite" ]; do sleep 0.05; done
  kill -9 "$worker"; touch "$PARTS/killed"; scontrol requeue "$SLURM_JOB_ID"; sleep 60
fi
"""
        script.write_text(block_of_how_to("slurm").replace("exec zerorate", die + f"exec {ZERORATE}"), encoding="utf-8")
        with Slurm(pathlib.Path(tempfile.mkdtemp(dir=self.folder))) as slurm:
            slurm.environment.update(FLEET=str(self.fleet), PARTS=str(parts))
            job = slurm.call("sbatch", "--parsable", f"--output={parts}/%a.log", str(script)).strip()
            self.assertTrue(job.isdigit(), job)
            slurm.wait_for((parts / "killed").exists, 120)
            # A requeued task waits for two minutes, unless it is let go.
            try:
                slurm.wait_for(lambda: not slurm.call("squeue", "-h"), 300)
            except TimeoutError:
                self.fail(slurm.call("squeue") + (slurm.folder / "slurmctld.log").read_text(encoding="utf-8")[-3000:])
            self.assertIn("1 analysed", (parts / "1.log").read_text(encoding="utf-8") + (parts / "3.log").read_text(encoding="utf-8"))
        self.assertEqual(self.merged(*parts.glob("part*.sqlite")), self.expected)


def obstacle_to_slurm():
    missing = [name for name in SLURM if not shutil.which(name)]
    if missing:
        return f"not installed: {', '.join(missing)}"
    return "" if os.geteuid() == 0 else "only root can start the daemons"


if __name__ == "__main__":
    if "OnSlurm" in sys.argv and obstacle_to_slurm():
        print(obstacle_to_slurm())
        sys.exit(77)
    unittest.main()
