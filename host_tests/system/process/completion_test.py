#!/usr/bin/env python3
"""Completion in bash and zsh offers what the program knows.

usage: completion_test.py REPOSITORY ZERORATE [unittest arguments]
"""

import pathlib
import shutil
import subprocess
import sys
import unittest

FOLDER = pathlib.Path(sys.argv.pop(1)) / "host_tools/cli/completion"
ZERORATE = sys.argv.pop(1)

# The shells call the function with the words of the line in variables, and take the candidates.
BASH = """source {folder}/zerorate.bash
COMP_WORDS=({words}); COMP_CWORD=$(( ${{#COMP_WORDS[@]}} - 1 ))
_zerorate
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
ZSH = """compadd() {{ shift; print -l -- "$@" }}
_files() {{ print files }}
words=({words}); CURRENT=$#words
fpath=({folder} $fpath)
autoload -Uz _zerorate
_zerorate
"""


class Completion:
    def offers(self, *words):
        """Candidates for the last of the words, as the shell would filter them."""
        line = " ".join(f"'{word}'" for word in (ZERORATE, *words))
        text = self.script.format(folder=FOLDER, words=line)
        done = subprocess.run([self.shell, *self.options, "-c", text], capture_output=True, text=True, timeout=60, check=True)
        self.assertEqual(done.stderr, "")
        return [word for word in done.stdout.split() if word.startswith(words[-1])]

    def test_offers_commands(self):
        self.assertEqual(self.offers("rep"), ["replay"])
        self.assertTrue({"diagnose", "export", "fleet"} <= set(self.offers("")))
        self.assertEqual(self.offers("fleet", "re"), ["report"])

    def test_offers_the_options_of_a_command(self):
        self.assertEqual(self.offers("replay", "drive.csv", "--still-f"), ["--still-from"])
        self.assertEqual(self.offers("export", "--receiv"), ["--receivers"])
        self.assertIn("--output", self.offers("export", "--o"))

    def test_offers_the_values_of_an_option(self):
        self.assertEqual(self.offers("replay", "--still-from", "gy"), ["gyro"])
        self.assertEqual(self.offers("replay", "--model", "lsm6dsv"), ["lsm6dsv16x"])

    def test_leaves_files_to_the_shell(self):
        self.assertIn(self.offers("replay", "f"), ([], ["files"]))


@unittest.skipUnless(shutil.which("bash"), "no bash")
class InBash(Completion, unittest.TestCase):
    shell, options, script = "bash", ("--norc",), BASH


@unittest.skipUnless(shutil.which("zsh"), "no zsh")
class InZsh(Completion, unittest.TestCase):
    shell, options, script = "zsh", ("-f",), ZSH


if __name__ == "__main__":
    unittest.main()
