#!/usr/bin/env python3
"""Mutation test: changes one place of the code at a time, and asks whether the unit tests of that room notice.

usage: mutate.py [--mutants N] [--seed N] [--jobs N] [--changed [BASE]] [--rooms ROOM...] [--list]

N mutants are drawn from all places in core, firmware/app, firmware/wire and firmware/c_api (--rooms: some of them; --changed:
from the files that differ from BASE, HEAD by default). Each is made in a copy of the tree below build/mutation, where the tests
of its room alone are built and run. A mutant is killed if a test fails, crashes or does not end, or a static_assert holds it;
one that does not compile otherwise counts for nothing. Results are kept by seed and content in build/mutation/results.jsonl: what
was tried is not tried again, and a run that was stopped goes on. --list prints the places without trying them.

The exit code is 1 where fewer than 92 % are killed, a survivor stands not in survivors.toml, or an entry there is stale.
"""

import argparse
import hashlib
import json
import pathlib
import queue
import random
import re
import shutil
import subprocess
import sys
import threading
import tomllib
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parents[2]
WORK = ROOT / "build/mutation"
KILLED_AT_LEAST = 0.92
# Room -> programs that test it.
ROOMS = {f"core/{name}": [f"core_{name}_test"]
         for name in ("base", "estimator", "heading", "inputs", "monitor", "noise", "samples", "standstill")}
ROOMS |= {"firmware/app": ["firmware_app_test"], "firmware/wire": ["firmware_wire_test"],
          "firmware/c_api": ["firmware_c_api_test", "firmware_c_api_inputs_test"]}
# Kind of mutation -> what is looked for, and what takes its place.
OPERATORS = (
    ("relation", r" (<=|>=|<|>|==|!=) (?!=)", {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}),
    ("arithmetic", r"(?<=[\w)\]]) ([+*/-]) (?=[\w(])", {"+": "-", "-": "+", "*": "/", "/": "*"}),
    ("logic", r" (&&|\|\|) ", {"&&": "||", "||": "&&"}),
    ("constant", r"(?<![\w.])(\d+\.\d+F|\d+U?)(?![\w.'])", None),
    ("negation", r"\bif \((?!const|auto|constexpr)(.+)\) (?:return|\{|continue|break)", None),
    ("statement", r"^ +((?:state_|work_|this->|\w+_)[\w.\[\]>-]* [-+*/]?= [^;]+;|\w+(?:\.\w+)*\([^;]*\);)$", None),
)
NO_CODE = re.compile(r"^\s*(?://|#|\*|static_assert|template|using |friend |case |default:)|ZERORATE_ASSERT|operator[<>=!]")


@dataclass(frozen=True)
class Mutant:
    file: str
    line: int
    kind: str
    before: str  # the whole line
    after: str

    @property
    def key(self):
        return hashlib.sha256(f"{self.file}|{self.kind}|{self.before}|{self.after}".encode()).hexdigest()[:16]

    @property
    def room(self):
        return next(room for room in ROOMS if self.file.startswith(room + "/"))

    def __str__(self):
        return f"{self.file}:{self.line}: {self.kind}: `{self.before.strip()}` became `{self.after.strip()}`"


def replacement(kind, table, text):
    if table is not None:
        return table[text]
    if kind == "negation":
        return f"!({text})"
    if kind == "statement":
        return ";"
    number = re.match(r"(\d+)(\.\d+F|U?)$", text)  # of a constant: one more
    return f"{int(number[1]) + 1}{number[2]}"


def mutants_of_line(file, number, line):
    """Every mutant of a line. What follows a comment sign is no code."""
    code = line.split("//")[0].rstrip()
    if NO_CODE.search(code):
        return
    for kind, pattern, table in OPERATORS:
        for found in re.finditer(pattern, code):
            begin, end = found.span(1)
            after = code[:begin] + replacement(kind, table, found[1]) + code[end:]
            yield Mutant(file, number, kind, line, after)


def mutants_of(root, files):
    for file in sorted(files):
        for number, line in enumerate((root / file).read_text(encoding="utf-8").splitlines(), start=1):
            yield from mutants_of_line(file, number, line)


def drawn(mutants, count, seed):
    """So many of them, the same for a seed: in an order that hardly changes when a file does."""
    order = sorted(mutants, key=lambda one: hashlib.sha256(f"{seed}|{one.key}|{one.line}".encode()).digest())
    return order[:count]


def files_of(rooms, changed_since=None):
    command = ["git", "-C", ROOT, "ls-files", *rooms]
    if changed_since:
        command = ["git", "-C", ROOT, "diff", "--name-only", changed_since, "--", *rooms]
    listed = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    return [name for name in listed if name.endswith((".hpp", ".cpp")) and "/examples/" not in name and (ROOT / name).exists()]


def copy_tree(to):
    """The tracked files; what did not change keeps its time, so that little is built."""
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], check=True, capture_output=True, text=True).stdout
    for name in filter(None, listed.split("\0")):
        source, target = ROOT / name, to / name
        if not source.is_file() or (target.exists() and target.read_bytes() == source.read_bytes()):
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)


class Tree:
    """A copy of the project in which one mutant after the other is built."""

    def __init__(self, number):
        self.root = WORK / f"tree{number}"
        copy_tree(self.root)
        self.build = self.root / "build/host-dev"
        subprocess.run(["cmake", "--preset", "host-dev"], cwd=self.root, check=True, capture_output=True)

    def make(self, programs):
        return subprocess.run(["cmake", "--build", self.build, "-j1", "--target", *programs], capture_output=True, text=True)

    def run(self, programs):
        """Whether all of them pass. A mutant that loops for ever is stopped by the time limit."""
        for name in programs:
            program = next(path for path in self.build.rglob(name) if path.is_file())
            try:
                subprocess.run([program, "--gtest_brief=1", "--gtest_fail_fast"], cwd=program.parent, check=True,
                               capture_output=True, timeout=300)
            except (subprocess.CalledProcessError, subprocess.TimeoutExpired):
                return False
        return True

    def ready(self, room):
        """The tests of a room pass without a mutant; else no result means anything."""
        made = self.make(ROOMS[room])
        if made.returncode != 0 or not self.run(ROOMS[room]):
            sys.exit(f"{room}: its tests do not pass without a mutant\n{made.stdout[-3000:]}")

    def verdict(self, mutant):
        path = self.root / mutant.file
        good = path.read_text(encoding="utf-8")
        lines = good.split("\n")
        lines[mutant.line - 1] = mutant.after
        path.write_text("\n".join(lines), encoding="utf-8")
        try:
            made = self.make(ROOMS[mutant.room])
            if made.returncode != 0:
                return "killed" if "static assertion failed" in made.stdout + made.stderr else "invalid"
            return "survived" if self.run(ROOMS[mutant.room]) else "killed"
        finally:
            path.write_text(good, encoding="utf-8")


def known_results(path):
    results = {}
    if path.exists():
        for line in path.read_text(encoding="utf-8").splitlines():
            one = json.loads(line)
            results[one["key"]] = one["verdict"]
    return results


def try_all(mutants, jobs, results, path):
    """Tries what has no result yet, in threads with a tree each, room by room."""
    waiting = queue.Queue()
    for mutant in sorted((one for one in mutants if one.key not in results), key=lambda one: one.room):
        waiting.put(mutant)
    lock = threading.Lock()

    def work(number):
        tree, ready = None, set()
        while True:
            try:
                mutant = waiting.get_nowait()
            except queue.Empty:
                return
            tree = tree or Tree(number)
            if mutant.room not in ready:
                tree.ready(mutant.room)
                ready.add(mutant.room)
            verdict = tree.verdict(mutant)
            with lock, path.open("a", encoding="utf-8") as out:
                results[mutant.key] = verdict
                out.write(json.dumps({"key": mutant.key, "verdict": verdict, "mutant": str(mutant)}) + "\n")
                print(f"{verdict:9} {mutant}", flush=True)

    threads = [threading.Thread(target=work, args=(number,)) for number in range(jobs)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def findings(mutants, results, listed):
    """What is wrong with the results: too many survivors, one without a reason, a reason for none."""
    tried = {one.key: one for one in mutants if results.get(one.key) in ("killed", "survived")}
    survivors = [one for key, one in tried.items() if results[key] == "survived"]
    reasons = {(entry["file"], entry["after"]) for entry in listed if entry.get("reason", "").strip()}
    found = [f"survived, and no reason is given: {one}" for one in survivors if (one.file, one.after.strip()) not in reasons]
    share = 1 - len(survivors) / len(tried) if tried else 1.0
    if share < KILLED_AT_LEAST:
        found.append(f"{share:.1%} of {len(tried)} mutants are killed; at least {KILLED_AT_LEAST:.0%} must be")
    return found, len(tried), len(survivors)


def stale(listed, every):
    places = {(one.file, one.after.strip()) for one in every}
    return [f"survivors.toml: no such mutant any more: {entry['file']}: {entry['after']}"
            for entry in listed if (entry["file"], entry["after"]) not in places]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mutants", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--changed", nargs="?", const="HEAD", metavar="BASE")
    parser.add_argument("--rooms", nargs="+", default=list(ROOMS), choices=list(ROOMS))
    parser.add_argument("--list", action="store_true")
    arguments = parser.parse_args()
    every = list(mutants_of(ROOT, files_of(arguments.rooms, arguments.changed)))
    chosen = drawn(every, arguments.mutants, arguments.seed)
    if arguments.list:
        print("\n".join(str(one) for one in chosen) + f"\n{len(every)} places")
        return
    WORK.mkdir(parents=True, exist_ok=True)
    path = WORK / "results.jsonl"
    results = known_results(path)
    try_all(chosen, arguments.jobs, results, path)
    listed = tomllib.loads((ROOT / "host_tests/mutation/survivors.toml").read_text(encoding="utf-8")).get("survivor", [])
    found, tried, survivors = findings(chosen, results, listed)
    found += stale(listed, mutants_of(ROOT, files_of(list(ROOMS))))
    print(f"{tried} mutants of {len(every)} places: {tried - survivors} killed, {survivors} survived")
    print("\n".join(found))
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
