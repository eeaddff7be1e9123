"""The packages by purpose: whoever wants the demonstration installs no browser, cross compiler or emulator."""

import pathlib
import re
import subprocess
import unittest

REPOSITORY = pathlib.Path(__file__).parents[2]
INSTALLER = REPOSITORY / "toolchains/install-packages.sh"
LIST = REPOSITORY / "toolchains/debian-packages.txt"
HEAVY = re.compile(r"chromium|qemu|arm|aarch64|clang|doxygen|gtest|cppcheck")


def packages(section):
    """The names that the installer gives for a section and those above it."""
    run = subprocess.run([INSTALLER, "--list", section], check=True, capture_output=True, text=True)
    return run.stdout.split()


def help_of(*command):
    return subprocess.run([REPOSITORY / command[0], *command[1:]], check=True, capture_output=True, text=True).stdout


class Sections(unittest.TestCase):
    def test_nest(self):
        demo, test, everything = map(packages, ("demo", "test", "all"))
        self.assertIn("cmake", demo)
        self.assertEqual(test[:len(demo)], demo)
        self.assertEqual(everything[:len(test)], test)
        self.assertLess(len(demo), len(test))
        self.assertLess(len(test), len(everything))

    def test_name_no_package_twice(self):
        self.assertEqual(sorted(packages("all")), sorted(set(packages("all"))))

    def test_hold_every_package_of_the_list(self):
        named = re.findall(r"^([a-z][\w.+-]*)", LIST.read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual(packages("all"), named)

    def test_unknown_is_refused(self):
        run = subprocess.run([INSTALLER, "--list", "everything"], capture_output=True, text=True)
        self.assertEqual((run.returncode, run.stdout), (2, ""))


class Demonstration(unittest.TestCase):
    def test_needs_no_browser_cross_compiler_or_emulator(self):
        self.assertEqual([name for name in packages("demo") if HEAVY.search(name)], [])
        self.assertTrue([name for name in packages("all") if HEAVY.search(name)])


class QuickTests(unittest.TestCase):
    def test_need_no_browser_emulator_or_second_compiler(self):
        self.assertEqual([name for name in packages("test") if re.search("chromium|qemu|clang$|clang-tidy", name)], [])


class Help(unittest.TestCase):
    def test_says_what_is_installed(self):
        for command, section in ((("demo", "--help"), "demo"), (("test", "--help"), "all")):
            words = help_of(*command).split()
            self.assertEqual([name for name in packages(section) if name not in words], [])


if __name__ == "__main__":
    unittest.main()
