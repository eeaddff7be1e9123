#!/usr/bin/env python3
"""Turns a corpus of the fuzzers into a text file and back.

usage: corpus.py expand FILE FOLDER     the folder holds the inputs of the file and nothing else
       corpus.py collect FOLDER FILE    the file holds the inputs of the folder

One line is one input, with the escapes of C for what cannot be printed. Lines are in the order of the inputs' SHA-1,
which is also the name that libFuzzer gives to an input.
"""

import hashlib
import pathlib
import shutil
import sys


def name(data):
    return hashlib.sha1(data).hexdigest()


def line(data):
    """An input as a line; a space at its end is written so that no editor removes it."""
    text = data.decode("latin-1").encode("unicode_escape").decode("ascii")
    return text[:-1] + "\\x20" if text.endswith(" ") else text


def data(text):
    """The input of a line."""
    return text.encode("ascii").decode("unicode_escape").encode("latin-1")


def expand(file, folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for text in file.read_text(encoding="ascii").split("\n")[:-1]:
        (folder / name(data(text))).write_bytes(data(text))


def collect(folder, file):
    inputs = {name(found): found for found in (path.read_bytes() for path in folder.iterdir())}
    file.write_text("".join(line(found) + "\n" for _, found in sorted(inputs.items())), encoding="ascii")


def main():
    if len(sys.argv) != 4 or sys.argv[1] not in ("expand", "collect"):
        sys.exit(__doc__)
    {"expand": expand, "collect": collect}[sys.argv[1]](pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]))


if __name__ == "__main__":
    main()
