"""The table of static rules has every check of three families, and says of each whether it is on."""

import pathlib
import re
import subprocess
import unittest

REPOSITORY = pathlib.Path(__file__).parents[2]
PAGE = REPOSITORY / "docs/safety/static-rules.md"
FAMILIES = "-*,cert-*,cppcoreguidelines-*,hicpp-*"
# A row: the check, and what stands beside it.
ROW = re.compile(r"^\| `([a-z0-9-]+)` \|(?: (.+) \|)?$", re.MULTILINE)


def listed(*arguments, folder=REPOSITORY):
    """The checks that clang-tidy lists."""
    run = subprocess.run(["clang-tidy", "--list-checks", *arguments], cwd=folder, check=True, capture_output=True, text=True)
    return {line.strip() for line in run.stdout.splitlines() if line.startswith("    ")}


def sections(page):
    """Heading -> {check: what stands beside it}."""
    parts = re.split(r"^## (.+)$", page, flags=re.MULTILINE)
    return {heading: {check: beside.strip("`") for check, beside in ROW.findall(body)}
            for heading, body in zip(parts[1::2], parts[2::2])}


def findings(page, of_families, on):
    """What the page says and is not so."""
    tables = sections(page)
    off, alias, by_name = tables["Deviations"], tables["On by another name"], tables["On"]
    rows = [*off, *alias, *by_name]
    found = [f"{check}: stands twice" for check in {row for row in rows if rows.count(row) > 1}]
    found += [f"{check}: missing" for check in of_families - set(rows)]
    found += [f"{check}: there is no such check" for check in set(rows) - of_families]
    found += [f"{check}: is on, and the page has a deviation" for check in on & set(off)]
    found += [f"{check}: has no reason" for check, reason in off.items() if len(reason) < 20]
    found += [f"{check}: is off" for check in set(by_name) - on]
    found += [f"{check}: {other} is off" for check, other in alias.items() if other not in on]
    return sorted(found)


class StaticRules(unittest.TestCase):
    def test_are_what_the_page_says(self):
        on = listed("base/numeric.hpp", folder=REPOSITORY / "core")
        of_families = listed(f"--checks={FAMILIES}", "numeric.hpp", folder="/")
        self.assertGreater(len(of_families), 50)
        self.assertEqual(findings(PAGE.read_text(encoding="utf-8"), of_families, on), [])

    def test_are_missed_where_the_page_is_wrong(self):
        page = ("## Deviations\n| `a-b` | short |\n| `a-c` | a reason that is long enough |\n"
                "## On by another name\n| `a-d` | `x-y` |\n## On\n| `a-e` |\n| `a-f` |\n")
        found = findings(page, of_families={"a-b", "a-c", "a-d", "a-e", "a-g"}, on={"a-c", "a-f"})
        self.assertEqual(found, ["a-b: has no reason", "a-c: is on, and the page has a deviation", "a-d: x-y is off",
                                 "a-e: is off", "a-f: there is no such check", "a-g: missing"])


if __name__ == "__main__":
    unittest.main()
