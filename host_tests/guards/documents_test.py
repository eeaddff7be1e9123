"""Documents and comments hold what a reader relies on, and the guard finds each planted offence."""

import pathlib
import tempfile
import unittest

import documents

REPOSITORY = pathlib.Path(__file__).parents[2]
BIBLIOGRAPHY = {documents.BIBLIOGRAPHY: "- **Self and Liang 1987** Asymptotic properties.\n"}


def findings_in(files, check):
    """What one check says of a tree that holds these files."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return list(check(documents.Tree(folder, list(files))))


class OurTree(unittest.TestCase):
    def test_holds_every_rule(self):
        self.assertEqual(documents.findings(documents.Tree(REPOSITORY)), [])


class BrokenLink(unittest.TestCase):
    def test_to_a_missing_file_is_found(self):
        self.assertEqual(findings_in({"docs/a.md": "see\n[b](b.md)\n"}, documents.broken_links),
                         ["docs/a.md:2: no such file: b.md"])

    def test_to_a_missing_heading_is_found(self):
        files = {"docs/a.md": "[b](b.md#tick)\n", "docs/b.md": "# Tock\n"}
        self.assertEqual(findings_in(files, documents.broken_links), ["docs/a.md:1: no such heading: b.md#tick"])

    def test_is_not_a_file_a_folder_a_heading_or_an_address(self):
        files = {"docs/a.md": "# Two `words` here\n[1](b.md) [2](../docs) [3](#two-words-here) [4](https://x.org/)\n",
                 "docs/b.md": ""}
        self.assertEqual(findings_in(files, documents.broken_links), [])

    def test_in_a_block_of_code_is_left_alone(self):
        self.assertEqual(findings_in({"a.md": "```\n[b](b.md)\n```\n"}, documents.broken_links), [])


class DeadPath(unittest.TestCase):
    def test_in_backticks_is_found(self):
        self.assertEqual(findings_in({"a.md": "`core/gone.hpp`\n"}, documents.dead_paths),
                         ["a.md:1: no such file: core/gone.hpp"])

    def test_is_also_the_bare_name_of_a_source_that_no_folder_holds(self):
        files = {"a.md": "`units.hpp` `gone.hpp` `NAME_test.cpp` `gone.toml`\n", "core/base/units.hpp": "",
                 "host_tests/a_test.cpp": ""}
        self.assertEqual(findings_in(files, documents.dead_paths), ["a.md:1: no such file: gone.hpp"])

    def test_is_not_one_with_a_stand_in_that_fits(self):
        files = {"a.md": "`core/*.hpp` `core/NAME` `core/noise/`\n", "core/noise/white.hpp": "", "core/units.hpp": ""}
        self.assertEqual(findings_in(files, documents.dead_paths), [])


class LooseCitation(unittest.TestCase):
    def test_without_an_entry_is_found_even_across_two_lines(self):
        files = BIBLIOGRAPHY | {"a.md": "(Self and Liang 1987)\n", "core/a.hpp": "/// chi squared (Wilson\n/// and Hilferty 1931)\n"}
        self.assertEqual(findings_in(files, documents.loose_citations),
                         [f"core/a.hpp:1: not in {documents.BIBLIOGRAPHY}: Wilson and Hilferty 1931"])

    def test_is_also_an_entry_that_nobody_cites(self):
        self.assertEqual(findings_in(BIBLIOGRAPHY, documents.loose_citations),
                         [f"{documents.BIBLIOGRAPHY}:1: cited nowhere: Self and Liang 1987"])

    def test_is_not_a_date_a_standard_or_an_entry(self):
        files = BIBLIOGRAPHY | {"a.md": "Self and Liang (1987); November 2026; IEEE Std 1139-2008\n"}
        self.assertEqual(findings_in(files, documents.loose_citations), [])


class MissingZero(unittest.TestCase):
    def test_in_prose_and_comments_is_found(self):
        files = {"a.md": "a ratio of .62\n", "core/a.hpp": "int a;  // at least -.5\nfloat b = .5F;\n"}
        self.assertEqual(findings_in(files, documents.missing_zeros),
                         ["a.md:1: no leading zero: .62", "core/a.hpp:1: no leading zero: -.5"])

    def test_is_not_a_version_a_range_an_ending_or_code(self):
        files = {"a.md": "version 1.2.3, 0.5, `x = .5`, file.1, 0..9, e.g. .hpp\n"}
        self.assertEqual(findings_in(files, documents.missing_zeros), [])


class LongFile(unittest.TestCase):
    def test_is_found_and_one_of_400_lines_is_none(self):
        files = {"core/a.hpp": "//\n" * 400, "core/b.hpp": "//\n" * 401, "host_tests/guards/c.py": "#\n" * 402}
        self.assertEqual(findings_in(files, documents.long_files),
                         ["core/b.hpp:401: 401 lines; a source file has at most 400",
                          "host_tests/guards/c.py:401: 402 lines; a source file has at most 400"])


class PoorOpening(unittest.TestCase):
    def test_of_a_comment_is_found(self):
        for words in ("Of the two", "What is left", "the same for b", "As above", "so it is", "That is", "by axis",
                      "over the base", "to nobody", "whose bias", "Which of them", "who knows"):
            found = findings_in({"core/a.hpp": f"/// {words}\n"}, documents.poor_openings)
            self.assertEqual(found, [f"core/a.hpp:1: a comment starts with a noun or a verb: {words}"])

    def test_of_a_file_is_found(self):
        self.assertEqual(findings_in({"core/a.hpp": "/// @file\n/// What a file holds.\n"}, documents.poor_openings),
                         ["core/a.hpp:2: a comment starts with a noun or a verb: What a file holds."])

    def test_inside_a_comment_is_left_alone(self):
        files = {"core/a.hpp": "/// Rate of the axis.\n/// So far in SI units.\nint of;  // Offset\n"
                               "int a;  ///< mean of the two,\n        ///< over the base\n"}
        self.assertEqual(findings_in(files, documents.poor_openings), [])

    def test_behind_a_member_is_found_also_below_another_comment(self):
        files = {"core/a.hpp": "int a;  ///< rate\nint b;  ///< of a sample\n/// As above.\nint c;\n"}
        self.assertEqual(findings_in(files, documents.poor_openings),
                         [f"core/a.hpp:{line}: a comment starts with a noun or a verb: {words}"
                          for line, words in ((2, "of a sample"), (3, "As above."))])


class JoinedColumns(unittest.TestCase):
    def test_are_found_whichever_of_two_fields_is_padded(self):
        for fields in ("{:<8}{}", "{}{:>8.2f}", "{:>8}{:>8}"):
            found = findings_in({"host_tools/a.cpp": f'print("{fields}");\n'}, documents.joined_columns)
            self.assertEqual(found, [f'host_tools/a.cpp:1: no blank between two columns: print("{fields}");'])

    def test_are_not_two_with_a_blank_or_two_without_padding(self):
        files = {"host_tools/a.cpp": 'print("{:<7} {:>7} {}{:016x}");\n'}
        self.assertEqual(findings_in(files, documents.joined_columns), [])


class LongLine(unittest.TestCase):
    def test_of_prose_is_found(self):
        self.assertEqual(findings_in({"a.md": "word " * 25 + "\n" + "word " * 26 + "words\n"}, documents.long_lines),
                         ["a.md:2: 135 characters; a line of prose has at most 130"])

    def test_is_no_row_of_a_table_and_no_code(self):
        row, code = "| " + "a " * 70 + "|\n", "    " + "b " * 70 + "\n"
        self.assertEqual(findings_in({"a.md": row + code + "```\n" + code.strip() + "\n```\n"}, documents.long_lines), [])


class LongTestName(unittest.TestCase):
    def test_is_found_with_its_suite(self):
        suite, name = "S" * 20, "N" * 40
        files = {"host_tests/a.cpp": f"\nTEST({suite}, {name}) {{}}\nTEST_F({suite}, {name[1:]}) {{}}\n"}
        self.assertEqual(findings_in(files, documents.long_test_names),
                         [f"host_tests/a.cpp:2: 61 characters; a test's name has at most 60: {suite}.{name}"])


class HoleOfTheBoard(unittest.TestCase):
    EXPLAINED = "/// 1, the clock.\n// FILL IN\nint a;\n// FILLED IN\n"

    def found(self, board, port="| 1 clock |\n"):
        return findings_in({documents.BOARD: board, documents.PORT: port}, documents.board_holes)

    def test_with_its_comment_and_row_is_none(self):
        self.assertEqual(self.found(self.EXPLAINED), [])

    def test_without_a_comment_of_its_own_is_found(self):
        for board in (self.EXPLAINED.partition("\n")[2], self.EXPLAINED + "// FILL IN\n// FILLED IN\n"):
            self.assertIn("comments and holes are", self.found(board)[0])

    def test_without_a_row_in_the_page_is_found(self):
        self.assertEqual(self.found(self.EXPLAINED, port=""),
                         [f"{documents.BOARD}:1: comments and holes are 1(); {documents.PORT} explains "])

    def test_that_is_left_open_is_found(self):
        self.assertEqual(len(self.found(self.EXPLAINED.replace("// FILLED IN\n", ""))), 1)

    def test_of_too_many_lines_is_found(self):
        self.assertEqual(self.found(self.EXPLAINED.replace("int a;\n", "int a;\n" * 81)),
                         [f"{documents.BOARD}:1: 81 lines to fill in, 80 are promised"])


if __name__ == "__main__":
    unittest.main()
