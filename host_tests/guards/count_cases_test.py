"""The number of cases that ./test gives: every case of a program counts, and none that did not pass is lost."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

COUNT = pathlib.Path(__file__).parents[2] / "toolchains/count_cases.py"
PASSED = '<testcase name="Passes" status="run" result="completed"/>'
FAILED = '<testcase name="Fails" status="run" result="completed"><failure message="no"/></testcase>'
SKIPPED = ('<testcase name="Skips" status="run" result="skipped">'
           '<skipped message="a_test.cpp:7&#x0A;no recordings"/></testcase>')


def counted(tests, programs):
    """What is printed for {test: status} of ctest and {program: cases of GoogleTest}."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        cases = "".join(f'<testcase name="{name}" status="{status}"/>' for name, status in tests.items())
        (root / "record.xml").write_text(f"<testsuite>{cases}</testsuite>", encoding="utf-8")
        for name, text in programs.items():
            (root / f"{name}.xml").write_text(f"<testsuites><testsuite>{text}</testsuite></testsuites>", encoding="utf-8")
        run = subprocess.run([sys.executable, "-B", COUNT, root / "record.xml", root], check=True, capture_output=True,
                             text=True)
        return run.stdout.splitlines()


class Count(unittest.TestCase):
    def test_is_that_of_the_cases_in_a_program(self):
        self.assertEqual(counted({"a": "run"}, {"a": 3 * PASSED}), ["3 0 0", ""])

    def test_has_failed_cases_and_skipped_ones_with_their_reason(self):
        self.assertEqual(counted({"a": "fail"}, {"a": PASSED + FAILED + 2 * SKIPPED}), ["1 1 2", "2 x no recordings"])

    def test_takes_a_test_of_another_kind_as_one(self):
        self.assertEqual(counted({"a": "run", "b": "fail", "c": "notrun"}, {}), ["1 1 1", "1 x c"])

    def test_has_one_failure_for_a_program_that_ended_without_a_record(self):
        self.assertEqual(counted({"a": "fail"}, {}), ["0 1 0", ""])

    def test_has_one_failure_for_a_program_that_failed_after_its_last_case(self):
        self.assertEqual(counted({"a": "fail"}, {"a": PASSED}), ["1 1 0", ""])

    def test_ignores_the_record_of_a_program_that_did_not_run(self):
        self.assertEqual(counted({"a": "notrun"}, {"a": PASSED}), ["0 0 1", "1 x a"])


if __name__ == "__main__":
    unittest.main()
