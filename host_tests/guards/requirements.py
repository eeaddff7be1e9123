#!/usr/bin/env python3
"""Traces the requirements of docs/safety to the tests that name them.

usage: requirements.py PAGE [--write]

A test names requirements in a comment directly above it: `/// Verifies SR-STILL-01, SR-HEAD-02.` in C++ and JavaScript,
`# Verifies SR-MEM-01.` in Python and CMake. PAGE has them in tables of five columns: ID, requirement, rationale, status
(`tested`, or `open:` with a reason) and the tests. --write fills in the last column, and the line that counts them.

A finding is: a requirement that no test names and that is not open; an open one that a test names; a requirement that is
named, in a test or a page beside PAGE, and does not exist, and likewise an assumption; a comment above no test; a row that
is incomplete; a stale column or count. Prints `file:line: complaint` for each and exits with 1 where there is one.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys

SUFFIXES = {".cmake", ".cpp", ".mjs", ".py", ".txt"}
ID = r"SR-[A-Z]+-\d{2}"
NAMED = re.compile(r"SR-[A-Z]+-\d+|\bA-\d+\b")
ASSUMPTION = re.compile(r"^\| (A-\d+) \|", re.MULTILINE)
TAG = re.compile(rf"^\s*(?:///|#) Verifies ({ID}(?:, {ID})*)\.$")
ATTEMPT = re.compile(r"^\s*(?:///?|#)\s*Verifies:? .*SR-")
ROW = re.compile(rf"^\| ({ID}) \|(.*)\|$")
COUNT = re.compile(r"^\d+ requirements, \d+ of them open\.$", re.MULTILINE)
COLUMNS = ("requirement", "rationale", "status", "tests")
# Beginning of a test -> what tests of that kind are called.
TESTS = (
    (re.compile(r"(?:TYPED_)?TEST(?:_[FP])?\((\w+),\s*(\w+)\)"), r"\1.\2"),
    (re.compile(r"test\((['`])((?:(?!\1).)+)\1"), r"\2"),
    (re.compile(r"def (test_\w+)\("), r"\1"),
    (re.compile(r"add_test\(NAME (\S+)"), r"\1"),
    (re.compile(r"(?:build_test\(|zerorate_program_test\(|set\(test )([^\s)]+)"), r"\1"),
    (re.compile(r"(?:compile_fail|link_test)\((\w+)"), r"compile_fail.\1"),
    (re.compile(r"zerorate_fuzzer\((\w+)"), r"fuzz.\1.corpus"),
)


def test_at(lines, number):
    """The test that begins in a line, or nothing. An argument of the macro may stand in the next line."""
    text = "\n".join(lines[number:number + 2]).lstrip()
    for beginning, called in TESTS:
        found = beginning.match(text)
        if found:
            return re.sub(r"\$\{\w+\}", "*", found.expand(called))
    return None


def class_of(lines, number):
    """The class of Python that a method is in, with a dot."""
    for line in reversed(lines[:number]):
        found = re.match(r"class (\w+)", line)
        if found:
            return found[1] + "."
    return ""


class Tests:
    """Tests by the requirements that they name, and comments that name none."""

    def __init__(self, root, names):
        self.of = {}        # ID -> [(test, file)]
        self.places = {}    # ID -> first place that names it
        self.findings = []
        for name in sorted(names):
            self.read(root, name)

    def read(self, root, name):
        lines = (root / name).read_text(encoding="utf-8").splitlines()
        waiting = []
        for number, line in enumerate(lines):
            tag = TAG.match(line)
            if tag:
                waiting += tag[1].split(", ")
                for one in tag[1].split(", "):
                    self.places.setdefault(one, f"{name}:{number + 1}")
                continue
            if ATTEMPT.match(line):
                self.findings.append(f"{name}:{number + 1}: write `Verifies SR-GROUP-01, SR-GROUP-02.`")
            if waiting:
                self.note(name, lines, number, waiting)
                waiting = []

    def note(self, name, lines, number, requirements):
        test = test_at(lines, number)
        if test is None:
            self.findings.append(f"{name}:{number}: no test below: {', '.join(requirements)}")
            return
        if name.endswith(".py"):
            test = class_of(lines, number) + test
        for one in requirements:
            tests = self.of.setdefault(one, [])
            if (test, name) not in tests:
                tests.append((test, name))


def tracked_files(root):
    listed = subprocess.run(["git", "-C", root, "ls-files", "-z", "host_tests"], check=True, capture_output=True, text=True)
    return [name for name in listed.stdout.split("\0") if name and (root / name).exists()]


def tests_below(root, names=None):
    names = names if names is not None else tracked_files(root)
    return Tests(root, [name for name in names if pathlib.PurePosixPath(name).suffix in SUFFIXES])


def cell_of(tests, root, folder):
    """The links of a row."""
    return ", ".join(f"[`{test}`]({os.path.relpath(root / name, folder)})" for test, name in tests)


def rows_of(text):
    """Each requirement of a page: line, ID and columns."""
    for number, line in enumerate(text.splitlines(), start=1):
        row = ROW.match(line)
        if row:
            yield number, row[1], [cell.strip() for cell in row[2].split("|")]


def is_open(cells):
    return len(cells) > 2 and re.fullmatch(r"open: \S.*", cells[2]) is not None


def written(page, root, tests):
    """The page with its column of tests, and its count of requirements, made anew."""
    lines = page.read_text(encoding="utf-8").split("\n")
    rows = list(rows_of("\n".join(lines)))
    for number, one, cells in rows:
        cell = cell_of(tests.of.get(one, []), root, page.parent)
        lines[number - 1] = "| " + " | ".join([one, *cells[:3], cell]) + " |"
    still_open = sum(is_open(cells) for _, _, cells in rows)
    return COUNT.sub(f"{len(rows)} requirements, {still_open} of them open.", "\n".join(lines))


def complaints_of_row(one, cells, tests, seen):
    if len(cells) != len(COLUMNS):
        yield f"{one} has {len(cells) + 1} columns of {len(COLUMNS) + 1}"
        return
    if one in seen:
        yield f"{one} stands here twice"
    requirement, rationale, status, _ = cells
    if not re.search(r"\bshall\b", requirement) or not rationale:
        yield f"{one} needs a sentence with `shall`, and a rationale"
    if not is_open(cells) and status != "tested":
        yield f"{one}: the status is `tested`, or `open:` with a reason"
    elif is_open(cells) and one in tests.of:
        yield f"{one} is open, and {tests.of[one][0][0]} names it"
    elif not is_open(cells) and one not in tests.of:
        yield f"{one}: no test names it"


def strangers(folder, root, requirements):
    """Names of requirements and assumptions in the pages of a folder that stand in no table."""
    pages = {path.relative_to(root).as_posix(): path.read_text(encoding="utf-8") for path in sorted(folder.glob("*.md"))}
    known = requirements.union(*(ASSUMPTION.findall(text) for text in pages.values()))
    for name, text in pages.items():
        for number, line in enumerate(text.splitlines(), start=1):
            for one in NAMED.findall(line):
                if one not in known:
                    what = "requirement" if one.startswith("SR-") else "assumption"
                    yield f"{name}:{number}: no such {what}: {one}"


def findings(page, root, tests):
    name = page.relative_to(root).as_posix()
    text = page.read_text(encoding="utf-8")
    found = list(tests.findings)
    seen = set()
    for number, one, cells in rows_of(text):
        found += [f"{name}:{number}: {complaint}" for complaint in complaints_of_row(one, cells, tests, seen)]
        seen.add(one)
    found += [f"{place}: no such requirement: {one}" for one, place in tests.places.items() if one not in seen]
    if not seen:
        found.append(f"{name}:1: no requirements")
    found += strangers(page.parent, root, seen)
    if not found and written(page, root, tests) != text:
        found.append(f"{name}:1: stale; run requirements.py {name} --write")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    page = arguments.page.resolve()
    root = pathlib.Path(__file__).resolve().parents[2]
    tests = tests_below(root)
    if arguments.write:
        page.write_text(written(page, root, tests), encoding="utf-8")
    found = findings(page, root, tests)
    print("\n".join(found))
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
