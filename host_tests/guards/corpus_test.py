"""The text files of the fuzzers' corpora: every input comes back from them byte for byte."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

FUZZ = pathlib.Path(__file__).parents[1] / "fuzz"
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


if __name__ == "__main__":
    unittest.main()
