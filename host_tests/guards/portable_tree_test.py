"""The tree names no machine and no registry, and the guard finds both where they are planted."""

import json
import pathlib
import tempfile
import unittest

import portable_tree

REPOSITORY = pathlib.Path(__file__).parents[2]


def findings_in(name, text):
    """The guard's findings in a tree that holds one file."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return portable_tree.findings(pathlib.Path(folder))


class OurTree(unittest.TestCase):
    def test_is_tied_to_no_machine(self):
        self.assertEqual(portable_tree.findings(REPOSITORY), [])


class PlantedTie(unittest.TestCase):
    # Put together at run time: written out, they would be findings of the test above.
    def test_path_into_a_home_scratch_or_work_folder_is_found(self):
        for folder in ("home", "root", "work", "tmp", "Users"):
            found = findings_in("docs/a.md", f"first line\nsee /{folder}/someone/notes\n")
            self.assertEqual(len(found), 1, folder)
            self.assertTrue(found[0].startswith("docs/a.md:2: path of one machine"), found[0])

    def test_registry_host_is_found(self):
        for host in (("registry", "npmjs", "org"), ("deb", "debian", "org"), ("pypi", "org")):
            found = findings_in("a.sh", f"fetch https://{'.'.join(host)}/x\n")
            self.assertEqual(len(found), 1, host)
            self.assertIn("host of a package registry", found[0])

    def test_resolved_address_in_a_lock_file_is_found(self):
        lock = {"packages": {"": {"name": "a"}, "node_modules/b": {"version": "1.0.0", "resolved": "somewhere"}}}
        self.assertEqual(findings_in("tools/package-lock.json", json.dumps(lock)),
                         ["tools/package-lock.json: resolved address of node_modules/b: "
                          "see npm's --omit-lockfile-registry-resolved"])


class PortableText(unittest.TestCase):
    def test_is_not_complained_about(self):
        for text in ("#!/usr/bin/env bash", "../shared/data", "build/host-release", "/dev/spidev0.0", "a/work/b",
                     "/usr/share/common-licenses/Apache-2.0", "https://www.st.com/resource/en/datasheet/lsm6dso.pdf"):
            self.assertEqual(findings_in("a.txt", text + "\n"), [], text)


if __name__ == "__main__":
    unittest.main()
