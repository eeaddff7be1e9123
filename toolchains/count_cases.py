#!/usr/bin/env python3
"""Counts the cases of a run of ctest: each case of a GoogleTest program, and each test of any other kind.

usage: count_cases.py CTEST_RECORD CASES_FOLDER

CTEST_RECORD is the JUnit file of `ctest --output-junit`; CASES_FOLDER/NAME.xml is what the GoogleTest program of the
test NAME wrote. Prints `PASSED FAILED SKIPPED`, and on a second line why cases were skipped, with their number. A
program that ends without a record, or fails without a failed case, counts as one failure.
"""

import collections
import pathlib
import sys
import xml.etree.ElementTree


class Count:
    def __init__(self):
        self.passed = self.failed = 0
        self.skipped = collections.Counter()  # reason -> cases

    def add_program(self, record, has_failed):
        """The cases of a GoogleTest program."""
        failed_before = self.failed
        for case in xml.etree.ElementTree.parse(record).iter("testcase"):
            skip = case.find("skipped")
            if case.find("failure") is not None:
                self.failed += 1
            elif skip is not None or case.get("status") == "notrun":
                message = "" if skip is None else skip.get("message", "")
                self.skipped[message.strip().splitlines()[-1] if message.strip() else "disabled"] += 1
            else:
                self.passed += 1
        if has_failed and self.failed == failed_before:
            self.failed += 1

    def add_test(self, case):
        """A test of another kind."""
        status = case.get("status")
        if status == "run":
            self.passed += 1
        elif status in ("notrun", "disabled"):
            self.skipped[case.get("name")] += 1
        else:
            self.failed += 1


def count(record, cases):
    result = Count()
    for case in xml.etree.ElementTree.parse(record).iter("testcase"):
        program = cases / f"{case.get('name')}.xml"
        if case.get("status") in ("run", "fail") and program.exists():
            result.add_program(program, case.get("status") == "fail")
        else:
            result.add_test(case)
    return result


def main():
    result = count(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
    print(result.passed, result.failed, result.skipped.total())
    print("; ".join(f"{number} x {reason}" for reason, number in sorted(result.skipped.items())))


if __name__ == "__main__":
    main()
