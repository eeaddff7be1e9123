#!/usr/bin/env python3
"""The example for Arduino, built by Debian's arduino-builder on a core of the test (arduino/tiny), which runs it.

usage: arduino_test.py ZERORATE

Without arduino-builder the exit code is 77.
"""

import pathlib
import re
import shutil
import sys
import tempfile

from foreign_test import HERE, Failure, require, run


def sketch_built(work, libraries, board):
    """The program that arduino-builder makes of the example, and what it said."""
    folder = work / f"sketch-{board}"
    folder.mkdir()
    said = run("arduino-builder", "-compile", "-hardware", "/usr/share/arduino-builder", "-hardware", HERE / "arduino",
               "-tools", "/usr/bin", "-libraries", libraries, "-fqbn", f"tiny:pc:{board}", "-build-path", folder,
               "-ide-version", "10819", libraries / "zerorate/examples/heading/heading.ino", may_fail=True)
    return folder / "heading.ino.elf", said


def arduino(zerorate, work):
    """Debian's arduino-builder builds the example; on a core of the test it turns by 90 deg after micros() has wrapped."""
    libraries = work / "libraries"
    run(sys.executable, "-B", HERE.parents[1] / "toolchains/package/amalgamate.py", libraries / "zerorate")
    program, said = sketch_built(work, libraries, "cpp20")
    require(program.is_file() and "warning:" not in said, f"the example is not built: {said}")
    lines = run(program).splitlines()
    require(lines[0] == "let it lie still", f"before the first stop: {lines[0]}")
    heading, sigma = map(float, re.fullmatch(r"(\S+) deg \+- (\S+)", lines[-1]).groups())
    require(abs(heading - 90.0) < 2.0 * sigma + 0.2 and 0.0 < sigma < 1.0, f"turned by 90 deg: {lines[-1]}")
    print(f"arduino: 90 deg after the wrap of micros(): {lines[-1]}")
    errors = re.findall(r"error:.*", sketch_built(work, libraries, "cpp17")[1])
    require(errors and "C++20" in errors[0] and len(errors) <= 2, f"a core of C++17 is told by {len(errors)} errors: {errors[:3]}")
    model = run(zerorate, "export", "mpu6050", "--c", "--name", "mpu6050_model", "--sample-rate", "100")
    require(model == (libraries / "zerorate/examples/heading/mpu6050_model.h").read_text(), "the example's model is not the catalogue's")


def main():
    if not shutil.which("arduino-builder"):
        print("skipped: no arduino-builder")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        try:
            arduino(sys.argv[1], pathlib.Path(folder))
        except Failure as failure:
            sys.exit(f"arduino: {failure}")


if __name__ == "__main__":
    main()
