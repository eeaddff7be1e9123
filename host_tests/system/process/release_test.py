#!/usr/bin/env python3
"""./release as its user: what is made of a tag, and what is refused.

usage: release_test.py REPOSITORY [CASE...]

The commit that is checked out is cloned, tagged there, and released from the clone. `Release` makes the parts that need no
compiler, `WholeRelease` all of them, twice, which takes half an hour. Without git's folder the exit code is 77.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

QUICK = ("--only", "source", "library")
SHORT_S, LONG_S = 120, 3600
PROJECT = r"project\(zerorate VERSION (\S+)"


def done(*command, limit_s=SHORT_S):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=limit_s,
                          check=False)


def output(*command, limit_s=SHORT_S):
    run = done(*command, limit_s=limit_s)
    if run.returncode != 0:
        raise AssertionError(f"{command}: exit code {run.returncode}\n{run.stdout}{run.stderr}")
    return run.stdout


class Clones(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="zerorate-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        committed = output("git", "-C", REPOSITORY, "show", "HEAD:CMakeLists.txt")
        self.version = re.search(PROJECT, committed)[1]

    def clone(self, name, tag=None):
        """A clone with the release program of the work tree, and the tag where one is named."""
        folder = self.folder / name
        output("git", "clone", "--quiet", "--shared", REPOSITORY, folder)
        shutil.copy(REPOSITORY / "release", folder / "release")
        if tag is not None:
            output("git", "-C", folder, "tag", tag)
        return folder

    def released_twice(self, *options, limit_s=SHORT_S):
        """The folder of a release, which another clone, in a folder with another name, made with the same bytes."""
        sums = []
        for name in ("one", "in-a-longer-folder"):
            clone = self.clone(name, f"v{self.version}")
            output(clone / "release", *options, limit_s=limit_s)
            sums.append((clone / "build/release/SHA256SUMS").read_text())
        self.assertEqual(sums[0], sums[1])
        return self.folder / "one/build/release"


class Release(Clones):
    def test_has_the_same_bytes_from_two_clones(self):
        folder = self.released_twice(*QUICK)
        self.assertEqual({path.name for path in folder.iterdir()},
                         {"SHA256SUMS", f"zerorate-{self.version}.tar.gz", f"zerorate-{self.version}-library.zip"})
        self.assertIn("OK", output("sh", "-c", f"cd '{folder}' && sha256sum --check SHA256SUMS"))

    def test_library_is_that_of_the_version_for_every_manager(self):
        clone = self.clone("one", f"v{self.version}")
        output(clone / "release", *QUICK)
        with zipfile.ZipFile(clone / f"build/release/zerorate-{self.version}-library.zip") as archive:
            self.assertEqual({name.split("/")[0] for name in archive.namelist()}, {"zerorate"})
            self.assertIn(f"version={self.version}\n", archive.read("zerorate/library.properties").decode())
            self.assertEqual(json.loads(archive.read("zerorate/library.json"))["version"], self.version)
            for name in ("idf_component.yml", "zephyr/module.yml", "src/zerorate.cpp", "examples/heading/heading.ino"):
                self.assertTrue(archive.read(f"zerorate/{name}"), name)

    def test_is_of_the_tag_and_not_of_what_is_uncommitted(self):
        clone = self.clone("one", f"v{self.version}")
        (clone / "LICENSE").write_text("changed")
        output(clone / "release", *QUICK)
        with zipfile.ZipFile(clone / f"build/release/zerorate-{self.version}-library.zip") as archive:
            self.assertIn("Apache License", archive.read("zerorate/LICENSE").decode())

    def refusal(self, clone, *options):
        run = done(clone / "release", *options)
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        return run.stderr

    def test_refuses_what_is_no_tag_of_the_version(self):
        clone = self.clone("one")
        self.assertIn("--untagged", self.refusal(clone))
        self.assertIn("found no tag v9.9.9", self.refusal(clone, "v9.9.9"))
        output("git", "-C", clone, "tag", "v9.9.9")
        self.assertIn(f"found VERSION {self.version}; expected 9.9.9", self.refusal(clone, *QUICK))

    def test_refuses_a_folder_with_other_files(self):
        clone = self.clone("one")
        self.assertIn("expected an empty folder", self.refusal(clone, "--untagged", *QUICK, "--output", clone / "docs"))


class Version(unittest.TestCase):
    def test_is_one_in_all_files(self):
        stated = {
            "CMakeLists.txt": PROJECT,
            "CITATION.cff": r"^version: (\S+)",
            "host_tools/ros/package.xml": r"<version>(\S+)</version>",
            "firmware/c_api/include/zerorate.h": r'#define ZERORATE_VERSION "(\S+)"',
        }
        found = {re.search(rule, (REPOSITORY / name).read_text(encoding="utf-8"), re.MULTILINE)[1] for name, rule in stated.items()}
        self.assertEqual(len(found), 1, found)


class WholeRelease(Clones):
    def test_has_the_same_bytes_from_two_clones(self):
        folder = self.released_twice(limit_s=LONG_S)
        names = {path.name for path in folder.rglob("*")}
        for architecture in ("amd64", "arm64", "armhf"):
            self.assertIn(f"zerorate_{self.version}_{architecture}.deb", names)
        for processor in ("m0plus", "m4f", "m7"):
            self.assertIn(f"zerorate-{self.version}-cortex-{processor}.tar.gz", names)
        self.assertIn("zerorate-pico.uf2", names)
        self.assertIn(f"zerorate-{self.version}.spdx", names)
        self.assertEqual(len([name for name in names if name.endswith(".whl")]), 1)


if __name__ == "__main__":
    REPOSITORY = pathlib.Path(sys.argv[1])
    if not (REPOSITORY / ".git").exists():
        print("skipped: no git folder")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *(sys.argv[2:] or ["Release", "Version"])])
