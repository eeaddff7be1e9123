"""The maker of mutants: what it changes, what it leaves, and how it judges."""

import importlib.util
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
SPEC = importlib.util.spec_from_file_location("mutate", HERE.parent / "mutation/mutate.py")
mutate = importlib.util.module_from_spec(SPEC)
sys.modules["mutate"] = mutate
SPEC.loader.exec_module(mutate)
FILE = "core/base/a.hpp"


def after(line):
    return {(one.kind, one.after.strip()) for one in mutate.mutants_of_line(FILE, 1, line)}


class Mutants(unittest.TestCase):
    def test_each_operator_changes_one_place(self):
        self.assertIn(("relation", "if (a <= b) return c;"), after("if (a < b) return c;"))
        self.assertIn(("negation", "if (!(a < b)) return c;"), after("if (a < b) return c;"))
        self.assertIn(("logic", "return a || b;"), after("return a && b;"))
        self.assertIn(("arithmetic", "x = a - b;"), after("x = a + b;"))
        self.assertIn(("constant", "x = 3.0F;"), after("x = 2.0F;"))
        self.assertIn(("statement", ";"), after("  state_.ticks = n;"))

    def test_comments_and_promises_are_left_alone(self):
        for line in ("/// a < b", "ZERORATE_ASSERT(a < b);", "static_assert(a < b);", "#if A > 1", "template <int A = 1>"):
            self.assertEqual(after(line), set(), line)

    def test_a_seed_draws_the_same(self):
        every = [mutate.Mutant(FILE, n, "constant", f"x = {n};", f"x = {n + 1};") for n in range(50)]
        self.assertEqual(mutate.drawn(every, 9, 1), mutate.drawn(list(reversed(every)), 9, 1))
        self.assertNotEqual(mutate.drawn(every, 9, 1), mutate.drawn(every, 9, 2))

    def test_a_survivor_without_a_reason_and_too_many_of_them_are_found(self):
        every = [mutate.Mutant(FILE, n, "constant", f"x = {n};", f"x = {n + 1};") for n in range(20)]
        results = {one.key: "killed" for one in every}
        self.assertEqual(mutate.findings(every, results, [])[0], [])
        results[every[3].key] = "survived"
        self.assertEqual(len(mutate.findings(every, results, [])[0]), 1)
        reason = {"file": FILE, "after": "x = 4;", "reason": "equivalent"}
        self.assertEqual(mutate.findings(every, results, [reason])[0], [])
        results[every[4].key] = "survived"
        self.assertEqual(len(mutate.findings(every, results, [reason])[0]), 2)
        self.assertEqual(len(mutate.stale([{**reason, "after": "x = 99;"}], every)), 1)


if __name__ == "__main__":
    unittest.main()
