#!/usr/bin/env python3
"""Refuses an image for a microcontroller that contains what must not be flashed.

usage: image_gate.py --nm NM --size SIZE IMAGE

Reads the image's symbols (defined or not) and compares them with FORBIDDEN. Prints the size of the
image, or one line for each finding, and exits with 1 where there is one.
"""

import argparse
import re
import subprocess
import sys

# Why a symbol is refused -> what it is called. Names are those of the Itanium C++ ABI, of the Arm
# run-time ABI (IHI 0043, section 4.1) and of newlib.
FORBIDDEN = {
    "heap": r"(malloc|calloc|realloc|free|memalign|aligned_alloc|posix_memalign|_?_?sbrk)(_r)?"
            r"|_(malloc|calloc|realloc|free|memalign|sbrk)_r"
            r"|_Zn[wa].*|_Zd[la].*",
    "exception": r"__cxa_(throw|rethrow|allocate_exception|free_exception|begin_catch|end_catch"
                 r"|get_globals.*)|__gxx_personality.*|_Unwind_.*|__aeabi_unwind_cpp_pr[012]|_ZSt\d+__throw_.*",
    "run-time type information": r"_ZT[IS].*|__dynamic_cast",
    "static with a guard or a destructor": r"__cxa_(guard_.*|atexit|pure_virtual)|__aeabi_atexit|atexit",
    "input and output": r"_?v?(f|s|sn|as|d)?i?(printf|scanf)(_r)?|puts|putchar|f(open|write|read|puts)|_write(_r)?",
    "way out of the program": r"abort|_?_?exit|_Exit|raise|__assert(_func)?",
    "double precision": r"__aeabi_c?d[a-z0-9]+|__aeabi_u?[fil]{1,2}2d"
                        r"|__(add|sub|mul|div|neg|eq|ne|lt|le|gt|ge|unord|cmp)df[23]"
                        r"|__(fix(uns)?df[sd]i|float(un)?[sd]idf|extendsfdf2|truncdfsf2)",
}


def symbols(nm, image):
    """The names of all symbols of an object file or image."""
    listing = subprocess.run([nm, "--format=posix", image], check=True, capture_output=True, text=True)
    return [line.split()[0] for line in listing.stdout.splitlines() if line.strip()]


def findings(names):
    """(why, symbol) of every forbidden symbol, in alphabetical order."""
    rules = [(why, re.compile(pattern)) for why, pattern in FORBIDDEN.items()]
    return sorted({(why, name) for name in names for why, rule in rules if rule.fullmatch(name)})


def main():
    parser = argparse.ArgumentParser(description="Checks an image for a microcontroller.")
    parser.add_argument("--nm", required=True)
    parser.add_argument("--size", required=True)
    parser.add_argument("image")
    arguments = parser.parse_args()

    names = symbols(arguments.nm, arguments.image)
    if not names:
        sys.exit(f"{arguments.image}: image gate: no symbols; a stripped image cannot be checked")
    found = findings(names)
    for why, name in found:
        print(f"{arguments.image}: image gate: {why}: {name}")
    if found:
        sys.exit(1)
    print(subprocess.run([arguments.size, arguments.image], check=True, capture_output=True, text=True).stdout, end="")


if __name__ == "__main__":
    main()
