"""The memory of clang-tidy's results: what has not changed costs nothing, and what changed is looked at again."""

import collections
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).parents[2]
TIDY = REPOSITORY / "toolchains/tidy.py"
CLEAN, UNTIDY = "inline int* nowhere() { return nullptr; }\n", "inline int* nowhere() { return 0; }\n"


class Project(unittest.TestCase):
    """A project of one source file and its header, in a folder of its own with an empty memory."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(os.path.realpath(folder.name)) / "first"
        self.memory = self.root.parent / "memory"
        self.make(self.root)

    def make(self, root, flags=""):
        self.write(root, "core/a.hpp", "#pragma once\n" + CLEAN)
        self.write(root, "core/a.cpp", '#include "core/a.hpp"\n')
        self.write(root, ".clang-tidy", "Checks: '-*,modernize-use-nullptr'\nWarningsAsErrors: '*'\n")
        entry = {"directory": str(root), "file": f"{root}/core/a.cpp",
                 "command": f"c++ -std=c++20 {flags} -I{root} -o a.o -c {root}/core/a.cpp"}
        self.write(root, "compile_commands.json", json.dumps([entry]))

    def write(self, root, name, text):
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def tidy(self, root=None, file="core/a.cpp"):
        """(exit code, last line) of a run over a file, or over several."""
        files = [file] if isinstance(file, str) else file
        root = root or self.root
        run = subprocess.run([sys.executable, "-B", TIDY, "--root", root, root, *files], capture_output=True,
                             text=True, env={**os.environ, "XDG_CACHE_HOME": str(self.memory)}, timeout=50)
        return run.returncode, run.stdout.splitlines()[-1]

    def assert_checked(self, outcome):
        self.assertEqual(outcome, (0, "1 files: 0 unchanged since they were clean, 0 with findings"))

    def assert_remembered(self, outcome):
        self.assertEqual(outcome, (0, "1 files: 1 unchanged since they were clean, 0 with findings"))

    def assert_refused(self, outcome):
        self.assertEqual(outcome, (1, "1 files: 0 unchanged since they were clean, 1 with findings"))


class PrecompiledHeader(Project):
    def test_of_the_build_hides_no_missing_include(self):
        self.make(self.root, flags="-Winvalid-pch -include /build/cmake_pch.hxx")
        self.assert_checked(self.tidy())
        self.write(self.root, "core/a.cpp", '#include "core/a.hpp"\nstd::size_t size = 0;\n')
        self.assert_refused(self.tidy())


class HeaderWithoutANeighbour(Project):
    def test_borrows_the_flags_of_a_source_file_and_not_of_the_precompiled_header(self):
        database = json.loads((self.root / "compile_commands.json").read_text(encoding="utf-8"))
        made = f"{self.root}/build/cmake_pch.hxx.cxx"
        database.insert(0, {"directory": str(self.root), "file": made,
                            "command": f"c++ -x c++-header -include build/cmake_pch.hxx -o a.gch -c {made}"})
        self.write(self.root, "compile_commands.json", json.dumps(database))
        self.write(self.root, "hal/b.hpp", '#pragma once\n#include "core/a.hpp"\n')
        self.assert_checked(self.tidy(file="hal/b.hpp"))


class SourcesOfOneTarget(Project):
    """Sources of host_tools that are read together."""

    SOURCES = ("host_tools/lib/a.cpp", "host_tools/lib/b.cpp")

    def setUp(self):
        super().setUp()
        self.write(self.root, ".clang-tidy", (REPOSITORY / ".clang-tidy").read_text(encoding="utf-8"))
        for source in self.SOURCES:
            self.write(self.root, source, "")
        entries = [{"directory": str(self.root), "file": f"{self.root}/{source}",
                    "command": f"c++ -std=c++20 -I{self.root} -o CMakeFiles/lib.dir/{source}.o -c {self.root}/{source}"}
                   for source in self.SOURCES]
        self.write(self.root, "compile_commands.json", json.dumps(entries))

    def outcome(self):
        return self.tidy(file=self.SOURCES)

    def test_answer_for_each_other(self):
        self.assertEqual(self.outcome(), (0, "2 files: 0 unchanged since they were clean, 0 with findings"))
        self.assertEqual(self.outcome(), (0, "2 files: 2 unchanged since they were clean, 0 with findings"))

    def test_are_refused_for_what_stands_in_one(self):
        offenders = {
            "a null pointer": UNTIDY,
            "an unused parameter": "int f(int unused) { return 1; }\n",
            "a name": "class wrong_name {};\n",
            "a copy": "#include <vector>\nvoid g(std::vector<int>);\n"
                      "void f(const std::vector<std::vector<int>>& all) { for (auto one : all) { g(one); } }\n",
        }
        for name, offender in offenders.items():
            for source in self.SOURCES:
                with self.subTest(name, source=source):
                    self.write(self.root, source, offender)
                    self.assertEqual(self.outcome(), (1, "2 files: 0 unchanged since they were clean, 2 with findings"))
                    self.write(self.root, source, "")


def types_of_two_sources(root):
    """Names of types that two sources of one folder of host_tools define: {(folder, name): sources}."""
    sources = collections.defaultdict(list)
    for path in sorted((root / "host_tools").rglob("*.cpp")):
        for name in re.findall(r"^(?:struct|class|enum(?: class)?) (\w+)[^;]*\{$", path.read_text(), re.MULTILINE):
            sources[path.parent.relative_to(root).as_posix(), name].append(path.name)
    return {key: files for key, files in sources.items() if len(files) > 1}


class SourcesOfOneFolder(unittest.TestCase):
    """The same name in two anonymous namespaces compiles file by file, and not where the files are read together."""

    def test_share_no_name_of_a_type(self):
        self.assertEqual(types_of_two_sources(REPOSITORY), {})

    def test_that_share_one_are_found(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "host_tools/lib").mkdir(parents=True)
            for name in ("a.cpp", "b.cpp"):
                (root / "host_tools/lib" / name).write_text("namespace {\nstruct Block {\n};\n}\n", encoding="utf-8")
            self.assertEqual(types_of_two_sources(root), {("host_tools/lib", "Block"): ["a.cpp", "b.cpp"]})


class HeadersOfOneFolder(Project):
    HEADERS = ("core/a.hpp", "core/b.hpp")

    def test_are_analysed_together(self):
        self.write(self.root, ".clang-tidy", "Checks: '-*,clang-analyzer-core.*'\nWarningsAsErrors: '*'\n")
        self.write(self.root, "core/b.hpp", "#pragma once\ninline int one() { return 1; }\n")
        self.assertEqual(self.tidy(file=self.HEADERS), (0, "2 files: 0 unchanged since they were clean, 0 with findings"))
        self.write(self.root, "core/b.hpp", "#pragma once\ninline int none() { int* at = nullptr; return *at; }\n")
        self.assertEqual(self.tidy(file=self.HEADERS), (1, "2 files: 0 unchanged since they were clean, 2 with findings"))


class OurConfiguration(Project):
    def test_refuses_untidy_code(self):
        self.write(self.root, ".clang-tidy", (REPOSITORY / ".clang-tidy").read_text(encoding="utf-8"))
        self.write(self.root, "core/a.hpp", "#pragma once\n" + UNTIDY)
        self.assert_refused(self.tidy())


class Memory(Project):
    def test_serves_what_has_not_changed(self):
        self.assert_checked(self.tidy())
        self.assert_remembered(self.tidy())

    def test_serves_another_clone(self):
        self.assert_checked(self.tidy())
        self.make(self.root.parent / "second")
        self.assert_remembered(self.tidy(self.root.parent / "second"))

    def test_never_holds_a_finding(self):
        self.write(self.root, "core/a.hpp", "#pragma once\n" + UNTIDY)
        self.assert_refused(self.tidy())
        self.assert_refused(self.tidy())

    def test_notices_a_changed_header_and_knows_the_old_one_again(self):
        self.assert_checked(self.tidy())
        self.write(self.root, "core/a.hpp", "#pragma once\n" + UNTIDY)
        self.assert_refused(self.tidy())
        self.write(self.root, "core/a.hpp", "#pragma once\n" + CLEAN)
        self.assert_remembered(self.tidy())

    def test_notices_that_a_silencing_comment_went(self):
        self.write(self.root, "core/a.hpp", "#pragma once\n" + UNTIDY.rstrip() + "  // NOLINT\n")
        self.assert_checked(self.tidy())
        self.write(self.root, "core/a.hpp", "#pragma once\n" + UNTIDY)
        self.assert_refused(self.tidy())

    def test_notices_another_configuration(self):
        self.assert_checked(self.tidy())
        self.write(self.root, ".clang-tidy", "Checks: '-*,modernize-use-nullptr,misc-*'\nWarningsAsErrors: '*'\n")
        self.assert_checked(self.tidy())

    def test_notices_other_flags(self):
        self.assert_checked(self.tidy())
        self.make(self.root, "-DSOMETHING")
        self.assert_checked(self.tidy())


if __name__ == "__main__":
    unittest.main()
