"""Every requirement of docs/safety has a test that names it, and the guard finds each planted offence."""

import pathlib
import tempfile
import unittest

import requirements

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
HEAD = "| ID | requirement | rationale | status | verified by |\n|---|---|---|---|---|\n"
TAGGED = "/// Verifies SR-STILL-01.\nTEST(Stop, IsFound) {}\n"
LINK = "[`Stop.IsFound`](../../host_tests/stop_test.cpp)"


def row(one="SR-STILL-01", requirement="It shall stop.", status="tested", tests=LINK):
    return f"| {one} | {requirement} | Stops teach. | {status} | {tests} |\n"


def checked(rows, files):
    """Findings in a scratch tree, and its page after --write."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder).resolve()
        page = root / "docs/safety/requirements.md"
        for name, text in {"docs/safety/requirements.md": HEAD + rows, **files}.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        tests = requirements.tests_below(root, [name for name in files if name.startswith("host_tests/")])
        return requirements.findings(page, root, tests), requirements.written(page, root, tests)


def found(rows, tests=TAGGED, name="host_tests/stop_test.cpp"):
    return checked(rows, {name: tests})[0]


class OurTree(unittest.TestCase):
    def test_traces_every_requirement(self):
        page = REPOSITORY / "docs/safety/requirements.md"
        self.assertEqual(requirements.findings(page, REPOSITORY, requirements.tests_below(REPOSITORY)), [])


class Requirement(unittest.TestCase):
    def test_with_a_test_is_traced(self):
        self.assertEqual(found(row()), [])

    def test_without_a_test_is_found(self):
        self.assertEqual(found(row() + row("SR-STILL-02", tests="")),
                         ["docs/safety/requirements.md:4: SR-STILL-02: no test names it"])

    def test_that_is_open_with_a_reason_is_none(self):
        self.assertEqual(found(row() + row("SR-STILL-02", status="open: no board", tests="")), [])

    def test_that_is_open_without_a_reason_is_found(self):
        self.assertEqual(found(row() + row("SR-STILL-02", status="open", tests="")),
                         ["docs/safety/requirements.md:4: SR-STILL-02: the status is `tested`, or `open:` with a reason"])

    def test_that_is_open_although_a_test_names_it_is_found(self):
        self.assertEqual(found(row(status="open: no board")),
                         ["docs/safety/requirements.md:3: SR-STILL-01 is open, and Stop.IsFound names it"])

    def test_without_shall_twice_or_with_too_few_columns_is_found(self):
        self.assertIn("shall", found(row(requirement="It stops."))[0])
        self.assertIn("twice", found(row() + row())[0])
        self.assertIn("columns", found("| SR-STILL-01 | It shall stop. | tested |\n")[0])


class NameInATest(unittest.TestCase):
    def test_without_a_requirement_is_found(self):
        tests = TAGGED + "/// Verifies SR-STILL-01, SR-STILL-09.\nTEST(Stop, Ends) {}\n"
        self.assertEqual(found(row(), tests), ["host_tests/stop_test.cpp:3: no such requirement: SR-STILL-09"])

    def test_above_no_test_is_found(self):
        self.assertEqual(found(row(), TAGGED + "/// Verifies SR-STILL-01.\nint stop();\n"),
                         ["host_tests/stop_test.cpp:3: no test below: SR-STILL-01"])

    def test_in_another_form_is_found(self):
        self.assertEqual(found(row(), TAGGED + "// Verifies SR-STILL-01\nTEST(Stop, Ends) {}\n"),
                         ["host_tests/stop_test.cpp:3: write `Verifies SR-GROUP-01, SR-GROUP-02.`"])

    def test_in_a_page_beside_without_a_requirement_is_found(self):
        files = {"host_tests/stop_test.cpp": TAGGED, "docs/safety/README.md": "see SR-STILL-7\n"}
        self.assertEqual(checked(row(), files)[0], ["docs/safety/README.md:1: no such requirement: SR-STILL-7"])

    def test_of_an_assumption_that_stands_nowhere_is_found(self):
        files = {"host_tests/stop_test.cpp": TAGGED, "docs/safety/README.md": "see A-1 and A-2\n",
                 "docs/safety/assumptions.md": "| A-1 | One clock. |\n"}
        self.assertEqual(checked(row(), files)[0], ["docs/safety/README.md:1: no such assumption: A-2"])


class Column(unittest.TestCase):
    def test_that_is_stale_is_found_and_made_anew(self):
        complaints, page = checked(row(tests="[`Stop.IsGone`](gone.cpp)"), {"host_tests/stop_test.cpp": TAGGED})
        self.assertEqual(complaints, ["docs/safety/requirements.md:1: stale; run requirements.py "
                                      "docs/safety/requirements.md --write"])
        self.assertEqual(page, HEAD + row())

    def test_is_counted(self):
        rows = row() + row("SR-STILL-02", status="open: no board", tests="") + "\n9 requirements, 9 of them open.\n"
        complaints, page = checked(rows, {"host_tests/stop_test.cpp": TAGGED})
        self.assertIn("stale", complaints[0])
        self.assertTrue(page.endswith("\n2 requirements, 1 of them open.\n"))

    def test_names_tests_of_every_kind(self):
        kinds = {"host_tests/a_test.cpp": ("/// Verifies SR-STILL-01.\nTYPED_TEST(Stop,\n           Ends) {}\n", "Stop.Ends"),
                 "host_tests/a_test.py": ("class Stop(TestCase):\n    # Verifies SR-STILL-01.\n    def test_ends(self):\n",
                                          "Stop.test_ends"),
                 "host_tests/a.test.mjs": ("/// Verifies SR-STILL-01.\ntest('a stop ends', () => {\n", "a stop ends"),
                 "host_tests/CMakeLists.txt": ("# Verifies SR-STILL-01.\nadd_test(NAME stop.${name} COMMAND x)\n", "stop.*"),
                 "host_tests/a.cmake": ("  # Verifies SR-STILL-01.\n  build_test(stop.image \"x\")\n", "stop.image")}
        for name, (text, called) in kinds.items():
            self.assertIn(f"| [`{called}`](../../{name}) |", checked(row(), {name: text})[1])


if __name__ == "__main__":
    unittest.main()
