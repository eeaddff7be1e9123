"""The reader of coverage on made-up counts: what is planted must be found, and what the compiler made must not."""

import importlib.util
import pathlib
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
SPEC = importlib.util.spec_from_file_location("coverage_reader", HERE.parent / "coverage/coverage.py")
reader = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(reader)
FILE = "core/a.hpp"
SOURCE = """if (a) {
return b && c;
ZERORATE_ASSERT(a);
bool operator==(const A&) const = default;
return b &&
d;
"""


def branch(count, throw=False):
    return {"count": count, "throw": throw, "fallthrough": False}


def line(number, count, *branches, function="f"):
    return {"line_number": number, "count": count, "function_name": function, "branches": list(branches)}


class Reader(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "core").mkdir()
        (self.root / FILE).write_text(SOURCE, encoding="utf-8")
        self.coverage = reader.Coverage(self.root)

    def add(self, *lines):
        functions = [{"name": name, "start_line": 1} for name in ("f", "g")]
        self.coverage.add({"current_working_directory": str(self.root),
                           "files": [{"file": FILE, "functions": functions, "lines": list(lines)}]})

    def missed(self, *reasons):
        """Lines and branches that are not reached, without those that have a reason."""
        _, lines, _, branches = self.coverage.figures("core", reader.excused(self.coverage, reasons))
        return lines, branches

    def test_a_planted_branch_and_a_planted_line_are_found(self):
        self.add(line(1, 5, branch(5), branch(0)), line(2, 0))
        self.assertEqual(self.coverage.uncovered(), {(FILE, 1): "branch", (FILE, 2): "line"})
        ceilings = {"core": {"lines": 0.0, "branches": 0.0}}
        found = list(reader.excess(self.coverage, ceilings, set()))
        self.assertEqual([one.split(" are")[0] for one in found], ["core: 1 of 2 lines", "core: 1 of 2 branches"])

    def test_a_reason_excuses_and_a_stale_or_empty_one_is_found(self):
        self.add(line(1, 5, branch(5), branch(0)), line(2, 1))
        good = {"file": FILE, "line": "if (a) {", "reason": "hardware"}
        self.assertEqual(self.missed(), (0, 1))
        self.assertEqual(self.missed(good), (0, 0))
        self.assertEqual(list(reader.bad_reasons(self.coverage, [good])), [])
        self.assertIn("stale", next(reader.bad_reasons(self.coverage, [good, {**good, "line": "return b && c;"}])))
        self.assertIn("no reason", next(reader.bad_reasons(self.coverage, [{**good, "reason": " "}])))

    def test_one_instantiation_of_a_template_is_enough(self):
        self.add(line(1, 5, branch(5), branch(0)), line(1, 0, branch(0), branch(0), function="g"))
        self.add(line(1, 5, branch(0), branch(5)))
        self.assertEqual(self.coverage.figures("core"), (1, 0, 2, 0))

    def test_an_exception_is_no_branch_nor_is_what_the_compiler_made(self):
        self.add(line(1, 5, branch(5), branch(0, throw=True)), line(3, 5, branch(5), branch(0)),
                 line(4, 5, branch(5), branch(0)))
        self.assertEqual(self.coverage.figures("core")[2:], (0, 0))

    def test_the_last_condition_of_a_long_line_is_one(self):
        self.add(line(6, 5, branch(5), branch(0)))
        self.assertEqual(self.missed(), (0, 1))

    def test_more_than_the_limit_is_found(self):
        self.add(line(1, 5, branch(5), branch(0)), line(2, 5, branch(5), branch(5)))
        limits = {"core": {"lines": 1.0, "branches": 20.0}}
        self.assertEqual(len(list(reader.excess(self.coverage, limits, set()))), 1)
        self.assertEqual(list(reader.excess(self.coverage, {"core": {"lines": 1.0, "branches": 25.0}}, set())), [])


if __name__ == "__main__":
    unittest.main()
