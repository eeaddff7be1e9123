#!/usr/bin/env python3
"""Counts the cases of a run of ctest: each case of a GoogleTest program, and each test of any other kind.

usage: count_cases.py CTEST_RECORD CASES_FOLDER

CTEST_RECORD is the JUnit file of `ctest --output-junit`; CASES_FOLDER/NAME.xml is what the GoogleTest program of the
test NAME wrote. Prints `PASSED FAILED SKIPPED`, and on a second line why cases were skipped, with their number. A
program that ends without a record, or fails without a failed case, counts as one failure. The lines that follow name
each failure with the part of its output that says why.
"""

import collections
import pathlib
import sys
import xml.etree.ElementTree


MOST_LINES = 10  # of one failure's output, of each kind
MOST_CHARACTERS = 400  # of one line


def telling_lines(output):
    """The lines that report a failure, and the last ones."""
    lines = [line.rstrip() for line in output.splitlines() if line.strip()]
    end = max(0, len(lines) - MOST_LINES)
    return [line for line in lines[:end] if "FAILED" in line][:MOST_LINES] + lines[end:]


class Count:
    def __init__(self):
        self.passed = 0
        self.failures = []  # (name, lines of its output)
        self.skipped = collections.Counter()  # reason -> cases

    @property
    def failed(self):
        return len(self.failures)

    def add_program(self, test, record):
        """The cases of a GoogleTest program, as `test` of ctest ran it."""
        failed_before = self.failed
        for case in xml.etree.ElementTree.parse(record).iter("testcase"):
            skip = case.find("skipped")
            failure = case.find("failure")
            if failure is not None:
                lines = failure.get("message", "").splitlines()[:MOST_LINES]
                self.failures.append((f"{test.get('name')}: {case.get('classname')}.{case.get('name')}", lines))
            elif skip is not None or case.get("status") == "notrun":
                message = "" if skip is None else skip.get("message", "")
                self.skipped[message.strip().splitlines()[-1] if message.strip() else "disabled"] += 1
            else:
                self.passed += 1
        if test.get("status") == "fail" and self.failed == failed_before:
            self.add_failure(test)

    def add_failure(self, test):
        self.failures.append((test.get("name"), telling_lines(test.findtext("system-out", ""))))

    def add_test(self, case):
        """A test of another kind."""
        status = case.get("status")
        if status == "run":
            self.passed += 1
        elif status in ("notrun", "disabled"):
            self.skipped[case.get("name")] += 1
        else:
            self.add_failure(case)


def count(record, cases):
    result = Count()
    for case in xml.etree.ElementTree.parse(record).iter("testcase"):
        program = cases / f"{case.get('name')}.xml"
        if case.get("status") in ("run", "fail") and program.exists():
            result.add_program(case, program)
        else:
            result.add_test(case)
    return result


def main():
    result = count(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
    print(result.passed, result.failed, result.skipped.total())
    print("; ".join(f"{number} x {reason}" for reason, number in sorted(result.skipped.items())))
    for name, lines in result.failures:
        print(name, *(line[:MOST_CHARACTERS] for line in lines), sep="\n    ")


if __name__ == "__main__":
    main()
