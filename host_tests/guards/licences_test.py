"""Every file has a licence and a holder, and the text of each licence is there (REUSE 3.0)."""

import pathlib
import shutil
import subprocess
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
LINE = "SPDX-License-" + "Identifier: "  # in two parts, so that it is none of this file


def lint(root):
    return subprocess.run(["reuse", "--root", root, "lint"], capture_output=True, text=True, timeout=120)


@unittest.skipUnless(shutil.which("reuse"), "no reuse here (Debian: reuse)")
class Licences(unittest.TestCase):
    def test_every_file_has_one(self):
        result = lint(REPOSITORY)
        self.assertEqual(result.returncode, 0, result.stdout)

    def planted(self, name, text):
        """Result for a small tree in which src/* is covered, with one more file."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for sub in (".reuse", "LICENSES", "src"):
                (root / sub).mkdir()
            shutil.copy(REPOSITORY / "LICENSES/Apache-2.0.txt", root / "LICENSES")
            stanza = (REPOSITORY / ".reuse/dep5").read_text(encoding="utf-8").split("\n\n")
            (root / ".reuse/dep5").write_text("\n\n".join(stanza[:2]).replace("Files: *", "Files: src/*"), encoding="utf-8")
            (root / name).write_text(text, encoding="utf-8")
            return lint(root).returncode

    def test_a_file_without_one_is_found(self):
        self.assertEqual(self.planted("src/a.c", "int a;\n"), 0)
        self.assertNotEqual(self.planted("a.c", "int a;\n"), 0)

    def test_a_licence_without_its_text_is_found(self):
        self.assertNotEqual(self.planted("src/a.c", f"// {LINE}MIT\n"), 0)


if __name__ == "__main__":
    unittest.main()
