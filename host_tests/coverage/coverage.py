#!/usr/bin/env python3
"""Lines and branches of what is flashed that the unit and contract tests reach.

usage: coverage.py BUILD [--write] [--list]

BUILD is a build folder with ZERORATE_COVERAGE=ON whose unit and contract tests have run. What gcov counted is held against
limits.toml beside this file. A finding is: more lines or branches of a folder that are not reached, and have no reason there, than
its ceiling allows; a reason for something that is reached, or is no longer there. Prints each and exits with 1 where there is one.
--write makes the table of docs/safety/coverage.md anew; --list prints all that is not reached.

A template is instantiated many times. Its line is reached if one instantiation reaches it; its branch, if one of the
instantiations that have as many branches in that line takes it.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import tomllib

FOLDERS = ("core", "drivers", "firmware/app", "firmware/c_api", "firmware/wire", "hal/contract")
TABLE = re.compile(r"(?<=<!-- coverage -->\n).*?(?=<!-- end -->)", re.DOTALL)
# Where somebody wrote a decision: in this line, or at the end of the line before.
DECISION = re.compile(r"\b(?:if|for|while|switch|and|or)\b|&&|\|\||\?|\.\.\.\)")
CONTINUED = re.compile(r"(?:&&|\|\||\?|:)$")
# The other side of a promise between our own functions is a mistake in the program, which no input reaches.
PROMISE = re.compile(r"\bZERORATE_ASSERT\(|\bstatic_assert\(")


def folder_of(name):
    return next((folder for folder in FOLDERS if name.startswith(folder + "/")), None)


def decisions(branches):
    """Counts of the branches of a line, without those of exceptions: a call that may throw has two, and the second says so."""
    counts = []
    for branch in branches:
        if not branch["throw"]:
            counts.append(branch["count"])
        elif counts:
            counts.pop()
    return counts


class Coverage:
    """What was reached, by file and line."""

    def __init__(self, root):
        self.root = root
        self.lines = collections.defaultdict(int)  # (file, line) -> count
        self.branches = {}  # (file, line, function's line, number of branches) -> counts
        self.sources = {}

    def source(self, name, line):
        if name not in self.sources:
            self.sources[name] = (self.root / name).read_text(encoding="utf-8").splitlines()
        return self.sources[name][line - 1].strip()

    def has_decision(self, name, line):
        """Whether the branches of a line are those of the program. A comparison that is `= default`, the copy of an array or a
        placement new has branches that the compiler made."""
        text = self.source(name, line)
        before = self.source(name, line - 1) if line > 1 else ""
        return not PROMISE.search(text) and bool(DECISION.search(text) or CONTINUED.search(before))

    def add(self, report):
        """Adds what gcov says of one object file."""
        for file in report["files"]:
            path = os.path.normpath(os.path.join(report.get("current_working_directory", ""), file["file"]))
            name = os.path.relpath(path, self.root)
            if folder_of(name):
                begins = {function["name"]: function["start_line"] for function in file["functions"]}
                for line in file["lines"]:
                    self.add_line(name, begins.get(line.get("function_name"), 0), line)

    def add_line(self, name, begin, line):
        number = line["line_number"]
        self.lines[name, number] += line["count"]
        counts = decisions(line["branches"])
        if counts and self.has_decision(name, number):
            key = (name, number, begin, len(counts))
            self.branches[key] = [a + b for a, b in zip(counts, self.branches.get(key, [0] * len(counts)))]

    def uncovered(self):
        """Places that are not reached: (file, line) -> what of it is not."""
        places = {place: "line" for place, count in self.lines.items() if count == 0}
        for (name, number, _, _), counts in self.branches.items():
            if 0 in counts and (name, number) not in places:
                places[name, number] = "branch"
        return dict(sorted(places.items()))

    def figures(self, folder, excused=frozenset()):
        """Lines, lines not reached, branches, branches not reached; places that are excused count as reached."""
        def missed(counts):
            return sum(count == 0 and place not in excused for place, count in counts)
        lines = [(place, count) for place, count in self.lines.items() if folder_of(place[0]) == folder]
        branches = [(key[:2], count) for key, counts in self.branches.items() if folder_of(key[0]) == folder for count in counts]
        return len(lines), missed(lines), len(branches), missed(branches)


def reports_of(notes):
    """What gcov says of some object files. A batch is one process; each line of its output is one object file."""
    result = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities", *notes],
                            capture_output=True, text=True, check=True)
    return [json.loads(line) for line in result.stdout.splitlines() if line.startswith("{")]


def measured(build, root):
    coverage = Coverage(root)
    notes = sorted(str(path) for path in build.rglob("*.gcno"))
    if not any(pathlib.Path(note).with_suffix(".gcda").exists() for note in notes):
        sys.exit(f"{build}: nothing was counted; run the unit and contract tests of a build with ZERORATE_COVERAGE=ON")
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for reports in pool.map(reports_of, [[note] for note in notes]):
            for report in reports:
                coverage.add(report)
    return coverage


def is_meant(entry, coverage, place):
    return entry["file"] == place[0] and entry["line"] == coverage.source(*place)


def excused(coverage, reasons):
    """Places that are not reached and have a reason."""
    return {place for place in coverage.uncovered() if any(is_meant(entry, coverage, place) for entry in reasons)}


def bad_reasons(coverage, reasons):
    places = coverage.uncovered()
    for entry in reasons:
        if not any(is_meant(entry, coverage, place) for place in places):
            yield f"limits.toml: stale: {entry['file']}: {entry['line']}"
        if not entry.get("reason", "").strip():
            yield f"limits.toml: no reason: {entry['file']}: {entry['line']}"


def excess(coverage, ceilings, places_excused):
    """Folders of which more is left than their ceilings, in per cent."""
    for folder, ceiling in ceilings.items():
        lines, missed_lines, branches, missed_branches = coverage.figures(folder, places_excused)
        for what, missed, all_of_it in (("lines", missed_lines, lines), ("branches", missed_branches, branches)):
            if 100 * missed > ceiling[what] * all_of_it:
                yield (f"{folder}: {missed} of {all_of_it} {what} are not reached, more than {ceiling[what]} %: test them, or give a "
                       "reason in host_tests/coverage/limits.toml")


def percent(part, whole):
    return f"{100 * (whole - part) / whole:.1f} %" if whole else "-"


def table_of(coverage, ceilings):
    rows = ["| folder | lines | reached | branches | reached | ceilings of what is not, % |", "|---|---|---|---|---|---|"]
    for folder in FOLDERS:
        lines, missed_lines, branches, missed_branches = coverage.figures(folder)
        limits = f"{ceilings[folder]['lines']}, {ceilings[folder]['branches']}"
        rows.append(f"| `{folder}` | {lines} | {percent(missed_lines, lines)} | {branches} | {percent(missed_branches, branches)} "
                    f"| {limits} |")
    return "\n".join(rows) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--list", action="store_true")
    arguments = parser.parse_args()
    here = pathlib.Path(__file__).resolve().parent
    root = here.parents[1]
    page = root / "docs/safety/coverage.md"
    coverage = measured(arguments.build.resolve(), root)
    limits = tomllib.loads((here / "limits.toml").read_text(encoding="utf-8"))
    if arguments.list:
        for (name, number), what in coverage.uncovered().items():
            print(f"{name}:{number}: {what}: {coverage.source(name, number)}")
    if arguments.write:
        text = TABLE.sub(lambda _: table_of(coverage, limits["ceiling"]), page.read_text(encoding="utf-8"))
        page.write_text(text, encoding="utf-8")
    reasons = limits.get("reason", [])
    found = [*bad_reasons(coverage, reasons), *excess(coverage, limits["ceiling"], excused(coverage, reasons))]
    print("\n".join(found))
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
