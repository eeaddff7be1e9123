"""Scripts that the build, the tests and the installation call.

The text files of the fuzzers' corpora: every input comes back from them byte for byte.
The number of cases that ./test gives: every case of a program counts, and none that did not pass is lost.
The packages by purpose: whoever wants the demonstration installs no browser, cross compiler or emulator.
The libraries of another architecture: of what was fetched, nothing but the packages that are named is unpacked.
The maintainer scripts of the Debian package: an upgrade restarts, a purge removes.
The citation: it has the version of the build.
"""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).parents[2]
FUZZ = REPOSITORY / "host_tests/fuzz"
EVERY_BYTE = bytes(range(256))


def run(command, first, second):
    subprocess.run([sys.executable, "-B", FUZZ / "corpus.py", command, first, second], check=True, timeout=50)


class Corpus(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def there_and_back(self, inputs):
        """The inputs after they were collected into a text and expanded from it, and the text."""
        (self.root / "found").mkdir()
        for number, data in enumerate(inputs):
            (self.root / "found" / str(number)).write_bytes(data)
        run("collect", self.root / "found", self.root / "text")
        run("expand", self.root / "text", self.root / "expanded")
        return ({path.read_bytes() for path in (self.root / "expanded").iterdir()},
                (self.root / "text").read_text(encoding="ascii"))


class RoundTrip(Corpus):
    def test_keeps_every_byte_alone_and_in_any_place(self):
        inputs = {EVERY_BYTE, EVERY_BYTE[::-1], b"", b"\\x41", b"\\", b"a \n b ", b"\r\n", b"\\n",
                  *(bytes([byte]) for byte in EVERY_BYTE), *(bytes([byte]) + b"1a" for byte in EVERY_BYTE)}
        expanded, text = self.there_and_back(inputs)
        self.assertEqual(expanded, inputs)
        self.assertEqual(len(text.splitlines()), len(inputs))

    def test_writes_lines_that_no_editor_changes(self):
        _, text = self.there_and_back([EVERY_BYTE, b"a ", b" "])
        self.assertTrue(text.replace("\n", "").isprintable())
        self.assertNotIn(" \n", text)

    def test_keeps_an_input_once(self):
        expanded, text = self.there_and_back([b"a", b"a"])
        self.assertEqual((expanded, text), ({b"a"}, "a\n"))


class OurCorpora(Corpus):
    def test_are_what_their_inputs_make(self):
        files = sorted((FUZZ / "corpus").glob("*.txt"))
        self.assertEqual({file.stem for file in files},
                         {file.stem.removesuffix("_fuzzer") for file in FUZZ.glob("*_fuzzer.cpp")})
        for file in files:
            run("expand", file, self.root / file.stem)
            run("collect", self.root / file.stem, self.root / "again.txt")
            self.assertEqual((self.root / "again.txt").read_bytes(), file.read_bytes(), file.name)


COUNT = pathlib.Path(__file__).parents[2] / "toolchains/count_cases.py"
PASSED = '<testcase name="Passes" status="run" result="completed"/>'
FAILED = ('<testcase name="Fails" status="run" result="completed" classname="A">'
          '<failure message="a_test.cpp:9&#x0A;no"/></testcase>')
SKIPPED = ('<testcase name="Skips" status="run" result="skipped">'
           '<skipped message="a_test.cpp:7&#x0A;no recordings"/></testcase>')


def counted(tests, programs, output=""):
    """What is printed for {test: status} of ctest, all with this output, and {program: cases of GoogleTest}."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        cases = "".join(f'<testcase name="{name}" status="{status}"><system-out>{output}</system-out></testcase>'
                        for name, status in tests.items())
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
        self.assertEqual(counted({"a": "fail"}, {"a": PASSED + FAILED + 2 * SKIPPED}), ["1 1 2", "2 x no recordings",
                                                                                "a: A.Fails", "    a_test.cpp:9", "    no"])

    def test_takes_a_test_of_another_kind_as_one(self):
        self.assertEqual(counted({"a": "run", "b": "fail", "c": "notrun"}, {}), ["1 1 1", "1 x c", "b"])

    def test_has_one_failure_for_a_program_that_ended_without_a_record(self):
        self.assertEqual(counted({"a": "fail"}, {}), ["0 1 0", "", "a"])

    def test_has_one_failure_for_a_program_that_failed_after_its_last_case(self):
        self.assertEqual(counted({"a": "fail"}, {"a": PASSED}), ["1 1 0", "", "a"])

    def test_shows_the_failing_lines_of_a_test_and_its_end(self):
        output = "\n".join(["begins", "FAILED: a check", *map(str, range(12))])
        self.assertEqual(counted({"a": "fail"}, {}, output),
                         ["0 1 0", "", "a", "    FAILED: a check", *(f"    {line}" for line in range(2, 12))])

    def test_ignores_the_record_of_a_program_that_did_not_run(self):
        self.assertEqual(counted({"a": "notrun"}, {"a": PASSED}), ["0 0 1", "1 x a"])


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


class Sysroot(unittest.TestCase):
    def test_holds_nothing_but_the_packages_that_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            stand_ins = {"apt-get": 'for name in "$@"; do case $name in lib*) touch "${name}_2_arm64.deb";; esac; done',
                         "dpkg-deb": 'echo "${2##*/}" >>"$3/unpacked"'}
            for name, text in stand_ins.items():
                program = root / "bin" / name
                program.parent.mkdir(exist_ok=True)
                program.write_text(f"#!/bin/sh\n{text}\n")
                program.chmod(0o755)
            for made in ("sysroot.apt/ready", "sysroot.debs/libfirst_1_arm64.deb", "sysroot.debs/libstale_1_arm64.deb"):
                (root / made).parent.mkdir(exist_ok=True)
                (root / made).touch()
            for names in (["libfirst", "libsecond"], ["libthird"]):
                subprocess.run([REPOSITORY / "toolchains/fetch-sysroot.sh", "arm64", root / "sysroot", "", *names],
                               check=True, env={"PATH": f"{root / 'bin'}:/usr/bin:/bin"})
            self.assertEqual((root / "sysroot/unpacked").read_text().split(),
                             ["libfirst_2_arm64.deb", "libsecond_2_arm64.deb", "libthird_2_arm64.deb"])
            self.assertFalse((root / "sysroot.debs").exists())


class Help(unittest.TestCase):
    def test_says_what_is_installed(self):
        for command, section in ((("demo", "--help"), "demo"), (("test", "--help"), "all")):
            words = help_of(*command).split()
            self.assertEqual([name for name in packages(section) if name not in words], [])


class MaintainerScripts(unittest.TestCase):
    """Scripts of the package in a root of their own; what they call only writes down that it was called."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for path in ("bin", "run/systemd/system", "var/lib/zerorate", "etc/zerorate"):
            (self.root / path).mkdir(parents=True)
        for name in ("systemctl", "deb-systemd-helper", "deb-systemd-invoke", "adduser", "addgroup", "deluser", "udevadm", "getent"):
            stub = self.root / "bin" / name
            stub.write_text(f'#!/bin/sh\necho "{name} $*" >> "{self.root}/calls"\n')
            stub.chmod(0o755)

    def calls(self, script, *arguments):
        (self.root / "calls").write_text("")
        path = f"{self.root / 'bin'}:/usr/bin:/bin"
        subprocess.run([REPOSITORY / "toolchains/debian" / script, *arguments], check=True,
                       env={"PATH": path, "DPKG_ROOT": str(self.root)}, timeout=50)
        return (self.root / "calls").read_text().splitlines()

    def test_an_upgrade_restarts_the_node_and_an_installation_does_not(self):
        restart = "deb-systemd-invoke try-restart zerorated.service"
        self.assertIn(restart, self.calls("postinst", "configure", "0.1.0"))
        self.assertNotIn(restart, self.calls("postinst", "configure", ""))

    def test_a_purge_leaves_neither_state_nor_user(self):
        self.assertEqual(self.calls("prerm", "remove"), ["deb-systemd-invoke stop zerorated.service"])
        self.assertEqual(self.calls("postrm", "remove"),
                         ["systemctl --system daemon-reload", "deb-systemd-helper mask zerorated.service"])
        self.assertTrue((self.root / "var/lib/zerorate").exists())
        self.assertIn("deluser --quiet --system zerorate", self.calls("postrm", "purge"))
        self.assertFalse((self.root / "var/lib/zerorate").exists())
        self.assertFalse((self.root / "etc/zerorate").exists())


class Citation(unittest.TestCase):
    def test_has_the_version_of_the_build(self):
        built = re.search(r"project\(zerorate VERSION (\S+)", (REPOSITORY / "CMakeLists.txt").read_text(encoding="utf-8"))
        cited = re.search(r"^version: (\S+)$", (REPOSITORY / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual(cited[1], built[1])


if __name__ == "__main__":
    unittest.main()
