#!/usr/bin/env python3
"""The manual pages and the tutorial say what the programs and the reference say.

usage: man_pages_test.py REPOSITORY ZERORATE ZERORATED [unittest arguments]
"""

import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

REPOSITORY = pathlib.Path(sys.argv.pop(1))
ZERORATE, ZERORATED = sys.argv.pop(1), sys.argv.pop(1)


def page(name):
    return (REPOSITORY / "docs/man" / name).read_text(encoding="utf-8").replace("\\-", "-")


def options(text):
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text))


def help_of(*command):
    return subprocess.run([*command, "--help"], capture_output=True, text=True, timeout=20, check=True).stdout


def commands_of(text):
    _, _, commands = text.partition("Subcommands:")
    return re.findall(r"^  (\w+)  ", commands, re.MULTILINE)


def help_of_all(*command):
    """The help of a command and of the commands within it."""
    text = help_of(*command)
    return "\n".join([text, *(help_of(*command, within) for within in commands_of(text))])


class ManualPages(unittest.TestCase):
    def test_zerorate_1_has_every_command_with_its_options(self):
        sections = dict(re.findall(r"^\.SS (\w+)\n(.*?)(?=^\.S[SH])", page("zerorate.1"), re.MULTILINE | re.DOTALL))
        commands = commands_of(help_of(ZERORATE))
        self.assertEqual(sorted(sections), sorted(commands))
        for command in commands:
            text = help_of_all(ZERORATE, command)
            self.assertEqual(options(sections[command]) | {"--help"}, options(text), command)
            examples = re.findall(r"^  (zerorate .*)$", text, re.MULTILINE)
            for example in examples:
                self.assertIn(example, sections[command])

    def test_zerorate_1_lists_the_commands_within_model(self):
        for command in commands_of(help_of(ZERORATE, "model")):
            self.assertIn(f"\n.B model {command}\n", page("zerorate.1"))

    def test_zerorated_8_has_every_option(self):
        self.assertEqual(options(page("zerorated.8")), options(help_of(ZERORATED)))

    def test_zerorated_toml_5_has_every_key_of_the_reference(self):
        reference = (REPOSITORY / "docs/reference/zerorated.md").read_text(encoding="utf-8")
        table = reference[reference.index("| key |"):reference.index("A sink never delays")]
        documented, table_name = set(), ""
        for row in table.splitlines()[2:]:
            first = row.split("|")[1].strip() if row.startswith("|") else ""
            if first.startswith("**"):
                table_name = first.strip("*")
            documented |= {(table_name, key) for key in re.findall(r"`(\w+)`", first)}
        described, table_name = set(), ""
        for line in page("zerorated.toml.5").splitlines():
            if match := re.fullmatch(r"\.SS \[+(\w+)\]+", line):
                table_name = match[1]
            if match := re.fullmatch(r"\.B ([a-z0-9_, ]+)", line):
                described |= {(table_name, key) for key in match[1].split(", ")}
        self.assertEqual(described, documented)

    @unittest.skipUnless(shutil.which("groff"), "no groff")
    def test_every_page_is_good_roff(self):
        for file in (REPOSITORY / "docs/man").iterdir():
            run = subprocess.run(["groff", "-man", "-Tutf8", "-ww", file], capture_output=True, text=True, timeout=20,
                                 check=True)
            self.assertEqual(run.stderr, "", file)


class InstallPage(unittest.TestCase):
    def test_configuration_is_one_that_zerorated_takes(self):
        text = (REPOSITORY / "docs/how-to/install-zerorated.md").read_text(encoding="utf-8")
        [block] = re.findall(r"^(    schema = .*?\n)(?=\S)", text, re.DOTALL | re.MULTILINE)
        with tempfile.TemporaryDirectory(prefix="zerorate-") as folder:
            file = pathlib.Path(folder) / "zerorated.toml"
            file.write_text(re.sub(r"^    ", "", block, flags=re.MULTILINE), encoding="utf-8")
            run = subprocess.run([ZERORATED, "--config", file, "--check-config"], capture_output=True, text=True, timeout=20,
                                 check=False)
            self.assertEqual(run.returncode, 0, run.stderr)


class Tutorial(unittest.TestCase):
    """Every command of a page in its order; the lines that it shows are among those that were printed."""

    def test_commands_of_the_first_replay_print_what_it_shows(self):
        self.assertGreater(self.shown_lines_of("docs/tutorial/first-replay.md"), 15)

    def test_commands_of_why_a_gyro_drifts_print_what_it_shows(self):
        self.assertEqual(self.shown_lines_of("docs/design/why-a-gyro-drifts.md"), 4)

    def test_commands_of_tuning_print_what_it_shows(self):
        self.assertEqual(self.shown_lines_of("docs/how-to/tune-the-stops.md"), 8)

    def test_commands_of_the_scenarios_print_what_it_shows(self):
        self.assertEqual(self.shown_lines_of("docs/reference/scenarios.md"), 4)

    def shown_lines_of(self, page):
        text = (REPOSITORY / page).read_text(encoding="utf-8")
        printed, shown = [], 0
        with tempfile.TemporaryDirectory(prefix="zerorate-") as folder:
            for block in re.findall(r"^```\n(.*?)^```$", text, re.DOTALL | re.MULTILINE):
                lines = block.splitlines()
                if lines[0].startswith("zerorate "):
                    printed = [line for command in lines for line in self.lines_of(command, folder)]
                    continue
                shown += len(lines)
                for line in lines:
                    self.assertIn(line, printed)
        return shown

    def lines_of(self, command, folder):
        run = subprocess.run([ZERORATE, *shlex.split(command)[1:]], cwd=folder, capture_output=True, text=True,
                             timeout=120, check=False)
        self.assertEqual(run.returncode, 0, f"{command}\n{run.stdout}{run.stderr}")
        return run.stdout.splitlines()


if __name__ == "__main__":
    unittest.main()
