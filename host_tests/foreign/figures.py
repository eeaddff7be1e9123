#!/usr/bin/env python3
"""The figures of docs/reference/c-interface.md: instructions, stack and size of the C interface, memory, and compilers tried.

usage: figures.py PAGE --repository FOLDER --build FOLDER --work FOLDER [--write]

Measures them as figures.c does, on the recording and the projects of foreign_test.py, and compares them with PAGE: none may
differ by more than 3 %. With --write the tables of PAGE are made anew. Without recordings the exit code is 77.
"""

import argparse
import pathlib
import re
import shutil
import sys

import foreign_test
from foreign_test import ARM_LINK, CORTEX, RISCV, Failure, Workshop, cxx_headers, require, run

SLACK = 0.03
# Heading of a column -> processor and optimisation.
COLUMNS = {"M0+ -O2": ("m0plus", "-O2"), "M0+ -Os": ("m0plus", "-Os"), "M4F -O2": ("m4f", "-O2"), "M4F -Os": ("m4f", "-Os"),
           "M4F -O2 -fpeel-loops": ("m4f", "-O2 -fpeel-loops"), "M7 -O2": ("m7", "-O2"), "M7 -Os": ("m7", "-Os")}
# As figures.c tells them -> as the page names them.
FUNCTIONS = {"zerorate_init": "`zerorate_init()`", "zerorate_pulse": "`zerorate_pulse()`",
             "zerorate_sample, moving or settling": "`zerorate_sample()`, moving or settling",
             "zerorate_sample, still": "`zerorate_sample()`, still",
             "zerorate_predict_heading, 6000 samples": "`zerorate_predict_heading()`, 6000 samples",
             "zerorate_save": "`zerorate_save()`"}
WRAPPED = ("zerorate_pulse", "zerorate_sample", "zerorate_predict_heading", "zerorate_save")
FIGURE = re.compile(r"^(zerorate_.+?) ([0-9a-f]{8}) ([0-9a-f]{8}) ([0-9a-f]{8}) ([0-9a-f]{8}) \n", re.MULTILINE)
# -icount shift=10, and SysTick on the 25 MHz of the mps2 boards.
INSTRUCTIONS_OF_A_PERIOD = 40 / 1024


def name_of_init(shop):
    """Name of zerorate_init() in the library, which contains its sizes."""
    source = shop.work / "name_of_init.c"
    source.write_text("#include <zerorate.h>\n#undef bool\nNAME zerorate_init\n")
    printed = run("gcc", "-E", "-P", f"-I{shop.repository}/firmware/c_api/include", source)
    return re.search(r"NAME (\w+)", printed).group(1)


def build(shop, processor, optimisation):
    """The folder of an image that measures itself."""
    wraps = " ".join(f"-Wl,--wrap={name}" for name in (name_of_init(shop), *WRAPPED))
    return shop.make(f"{processor}{optimisation.replace(' ', '')}", f"ZERORATE={shop.repository}", "CROSS=arm-none-eabi-",
                     f"CPU={CORTEX[processor][0]} -DZERORATE_FIGURES", f"OPTIMISATION={optimisation}", f"LINK={ARM_LINK} {wraps}")


def size_of(folder, prefix, flags):
    """Bytes of all functions of the headers and what they need, without memcpy and memset."""
    wanted = run(f"{prefix}nm", "--defined-only", "--extern-only", folder / "zerorate.o")
    functions = re.findall(r" T (zerorate_\w+)$", wanted, re.MULTILINE)
    require(len(functions) == 14, f"functions of the headers: {functions}")
    roots = [f"-Wl,-u,{name}" for name in functions] + [f"-Wl,--defsym={name}=0" for name in ("memcpy", "memset", "memmove")]
    run(f"{prefix}gcc", *flags.split(), folder / "zerorate.o", folder / "assert.o", "-nostdlib", *roots,
        "-Wl,--gc-sections", f"-Wl,-e,{functions[0]}", "-lgcc", "-o", folder / "library.elf")
    return bytes_of(prefix, folder / "library.elf")


def bytes_of(prefix, file):
    """Code, constants and initial values of a program or an object."""
    text, data = run(f"{prefix}size", file).splitlines()[1].split()[:2]
    return int(text) + int(data)


def measure(shop, processor, optimisation):
    """Row -> the figures of a column."""
    folder = build(shop, processor, optimisation)
    printed = run("qemu-system-arm", "-M", CORTEX[processor][1], "-display", "none", "-monitor", "none", "-serial", "null",
                  "-semihosting-config", "enable=on,target=native", "-icount", "shift=10", "-kernel", folder / "firmware")
    shop.compare(f"{processor} {optimisation}", FIGURE.sub("", printed))
    column = {}
    for name, *fields in FIGURE.findall(printed):
        calls, mean, most, stack = (int(field, 16) for field in fields)
        counts = [round(periods * INSTRUCTIONS_OF_A_PERIOD) for periods in ((mean, most) if calls > 1 else (mean,))]
        column[FUNCTIONS[name]] = [*counts, stack]
    require(column.keys() == set(FUNCTIONS.values()), f"figures of {list(column)}")
    return column | {"program, all functions, bytes": [size_of(folder, "arm-none-eabi-", CORTEX[processor][0])]}


# Size of an instance -> the definitions that differ from zerorate.h.
SMALL = ("-DZERORATE_DECAYING_MODES=6", "-DZERORATE_ROTATING_MODES=0", "-DZERORATE_TEMPERATURE=0", "-DZERORATE_HELD_TICKS=8",
         "-DZERORATE_HAS_MOVING_AVERAGE=0", "-DZERORATE_HAS_CALIBRATION_MEAN=0", "-DZERORATE_TAKES_REFERENCES=0")
SIZES = {"as in `zerorate.h`": (), "4 hypotheses": ("-DZERORATE_HYPOTHESES=4",), "1 hypothesis": ("-DZERORATE_HYPOTHESES=1",),
         "12 hypotheses, small": SMALL, "4 hypotheses, small": (*SMALL, "-DZERORATE_HYPOTHESES=4"),
         "1 hypothesis, small": (*SMALL, "-DZERORATE_HYPOTHESES=1"),
         "1 hypothesis, small, one axis": (*SMALL, "-DZERORATE_HYPOTHESES=1", "-DZERORATE_AXES=1")}
# Bytes of an instance that are promised.
MOST_BYTES = {"12 hypotheses, small": 7168, "1 hypothesis, small": 2896}
# Instructions of the longest call of zerorate_sample() and zerorate_pulse() that are promised.
MOST_INSTRUCTIONS = {"M0+ -O2": 150_000, "M4F -O2": 12_000, "M7 -O2": 12_000}


def memory(shop, definitions):
    """Bytes of an instance and of a record; the library checks them when it is compiled."""
    program = shop.work / "memory.c"
    program.write_text('#include <stdio.h>\n#include <zerorate.h>\n'
                       'int main(void) { return printf("%d %d", (int)sizeof(zerorate_node), ZERORATE_SNAPSHOT_BYTES) < 0; }\n')
    run("gcc", *definitions, f"-I{shop.repository}/firmware/c_api/include", program, "-o", shop.work / "memory")
    run("g++", "-std=c++20", "-fsyntax-only", *definitions, f"-I{shop.repository}",
        shop.repository / "firmware/c_api/zerorate.cpp")
    return [int(word) for word in run(shop.work / "memory").split()]


def other_processors(shop):
    """Processor -> bytes of the library with 12 hypotheses and with one, at -Os."""
    rows = {}
    for architecture, (abi, _) in RISCV.items():
        flags = f"-march={architecture} -mabi={abi}"
        rows[f"RISC-V {architecture}"] = [
            size_of(compiled(shop, "riscv64-unknown-elf-", flags, count), "riscv64-unknown-elf-", flags)
            for count in (12, 1)]
    # Debian's libgcc for the lx106 lacks the software floating point, which is in that chip's ROM.
    rows["Xtensa lx106, the object alone"] = [
        bytes_of("xtensa-lx106-elf-", compiled(shop, "xtensa-lx106-elf-", "-mlongcalls", count) / "zerorate.o") for count in (12, 1)]
    return rows


def compiled(shop, prefix, flags, hypotheses):
    """The folder of the library's objects for a processor."""
    name = f"size-{prefix}{flags.replace(' ', '')}-{hypotheses}"
    folder = shutil.copytree(foreign_test.HERE / "makefile", shop.work / name)
    run("make", "--no-print-directory", f"ZERORATE={shop.repository}", f"CROSS={prefix}", "OPTIMISATION=-Os",
        f"CPU={flags} -DZERORATE_HYPOTHESES={hypotheses} {cxx_headers()}", "zerorate.o", "assert.o", folder=folder,
        environment=shop.environment)
    return folder


def check_promises(columns, sizes):
    """No call is longer, and no instance larger, than the page promises."""
    for heading, most in MOST_INSTRUCTIONS.items():
        for row, figures in columns[heading].items():
            if "sample()`," in row or "pulse()" in row:
                require(figures[-2] <= most, f"{heading}: {row} takes {figures[-2]} instructions, {most} are promised")
    for name, most in MOST_BYTES.items():
        require(sizes[name][0] <= most, f"{name}: {sizes[name][0]} bytes, {most} are promised")


def cell(figures):
    *counts, last = (f"{figure:,}" for figure in figures)
    return f"{' / '.join(counts)}; {last}" if counts else last


def tables(shop):
    """The tables of the page, each beginning with its heading."""
    columns = {heading: measure(shop, *what) for heading, what in COLUMNS.items()}
    sizes = {name: memory(shop, definitions) for name, definitions in SIZES.items()}
    check_promises(columns, sizes)
    rows = next(iter(columns.values()))
    yield "".join([f"| function: instructions, mean / most; stack in bytes | {' | '.join(columns)} |\n",
                   f"|---|{'---|' * len(columns)}\n",
                   *(f"| {row} | {' | '.join(cell(column[row]) for column in columns.values())} |\n" for row in rows)])
    yield "".join(["| size | instance (`sizeof(zerorate_node)`) | record of `zerorate_save()` (`ZERORATE_SNAPSHOT_BYTES`) |\n",
                   "|---|---|---|\n", *(f"| {count} | {instance:,} | {record:,} |\n" for count, (instance, record) in sizes.items())])
    yield "".join(["| all functions at -Os, bytes | 12 hypotheses | 1 hypothesis |\n|---|---|---|\n",
                   *(f"| {name} | {full:,} | {small:,} |\n" for name, (full, small) in other_processors(shop).items())])
    if not all(map(shutil.which, foreign_test.COMPILERS)):
        return
    yield "".join(["| compiler of a host | version |\n|---|---|\n",
                   *(f"| `{name}` | {run(name, '-dumpfullversion', '-dumpversion').split()[0]} |\n"
                     for name in foreign_test.COMPILERS)])


def place_of(table, page):
    """Where the page has the table of the same heading."""
    found = re.search(re.escape(table.partition("\n")[0]) + r"\n(?:\|.*\n)+", page)
    require(found, f"the page has no table {table.partition(chr(10))[0]}")
    return found


def disagreements(table, documented):
    """Lines of a documented table whose words differ, or whose figures differ by more than SLACK."""
    measured, told = table.splitlines(), documented.splitlines()
    require(len(measured) == len(told), f"{len(told)} rows, measured {len(measured)}:\n{documented}")
    number = re.compile(r"(?<![\w.])\d[\d,]*(?![\w.])")
    for now, page in zip(measured, told):
        pairs = [[int(word.replace(",", "")) for word in words] for words in zip(number.findall(now), number.findall(page))]
        if number.sub("", now) != number.sub("", page) or any(abs(a - b) > SLACK * b for a, b in pairs):
            yield f"page: {page}\nnow:  {now}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=pathlib.Path)
    for name in ("repository", "build", "work"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    arguments.way = "figures"
    try:
        shop = Workshop(arguments)
        if not shop.has_recordings:
            print("skipped: no recordings")
            sys.exit(77)
        page = arguments.page.read_text()
        complaints = []
        for table in tables(shop):
            place = place_of(table, page)
            complaints += disagreements(table, place[0])
            page = page.replace(place[0], table)
    except Failure as failure:
        sys.exit(f"figures: {failure}")
    if arguments.write:
        arguments.page.write_text(page)
    elif complaints:
        sys.exit("\n".join(complaints))


if __name__ == "__main__":
    main()
