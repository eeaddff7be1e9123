#!/usr/bin/env python3
"""Runs programs on processors that QEMU emulates: compares their bits, counts their instructions.

usage: emulated_processor.py bits IMAGES PROGRAM...
           PROGRAM of this machine and IMAGES/mcu-*/.../zerorate-NAME.elf must print the same, where
           NAME is the first part of PROGRAM's name, up to the first dash
       emulated_processor.py counts IMAGES FILE [--write]
           FILE holds the table of instructions: writes it, or fails where one has grown by more than 3 %
"""

import argparse
import pathlib
import re
import subprocess
import sys

FOLDER = "host_tests/emulated/mps2/images"
GROWTH = 1.03

# Preset -> board of QEMU, and the period of its processor's clock.
PROCESSORS = {
    "cortex-m4f": ("mps2-an386", 40.0),
    "cortex-m7": ("mps2-an500", 40.0),
    "cortex-m0plus": ("microbit", 62.5),
}
NANOSECONDS_AN_INSTRUCTION = 1024  # -icount shift=10

# Line of zerorate-counts -> what it is, and how many samples and axes share it.
FIGURES = {
    "kalman_step": ("Kalman predictor: predict and update, an axis of three", 3),
    "kalman_gap": ("Kalman predictor: a gap of 6000 ticks, an axis of three", 3),
    "kalman_predict": ("Kalman predictor: bias and interval 6000 ticks ahead, an axis of three", 3),
    "bank_step": ("twelve hypotheses: predict and update, an axis of three", 3),
    "bank_gap": ("twelve hypotheses: a gap of 6000 ticks, an axis of three", 3),
    "bank_predict": ("twelve hypotheses: bias and interval 6000 ticks ahead, an axis of three", 3),
    "moving_average_step": ("moving average: predict and update, one axis", 1),
    "moving_average_gap": ("moving average: a gap, one axis", 1),
    "moving_average_predict": ("moving average: bias and interval 6000 ticks ahead, one axis", 1),
    "calibration_mean_step": ("calibration mean: predict and update, one axis", 1),
    "calibration_mean_gap": ("calibration mean: a gap, one axis", 1),
    "calibration_mean_predict": ("calibration mean: bias and interval 6000 ticks ahead, one axis", 1),
    "span_of_a_gap": ("what a gap of 6000 ticks does to the noise, once for all axes", 1),
    "averaged_sample_of_three_axes": (
        "a sample of 104 Hz averaged to 10 Hz and filtered by Kalman, an axis of three, mean", 3),
    "node_step_still": ("a sample through `GyroNode::step`, still: three axes, all predictors, mean", 1),
    "node_step_moving": ("the same, moving", 1),
}
# The promises of the project.
MOST = {
    ("kalman_step", "cortex-m4f"): 220,
    ("averaged_sample_of_three_axes", "cortex-m4f"): 42,
    ("kalman_step", "cortex-m0plus"): 5600,
}

# Of the step of the Kalman predictor, three axes: see PAGE.
BOUND_M4F = round((285 + 2 * 49 + 3 + 40) / 3)
BOUND_M0 = round((104 * 49 + 180 * 40 + 201) / 3)

PAGE = """# Instructions

Six flicker decades, ticks of 0.1 s, single precision, GCC at -O2, no fused multiply-add. Counted one by one in
QEMU (`-icount`, boards `mps2-an386`, `mps2-an500` and `microbit`, whose Cortex-M0 runs what an M0+ runs) by
`cmake --build --preset host-release --target instructions`; a test fails when a figure has grown by more than 3 %.

| figure | {processors} |
|---|{lines}
{rows}

## How far from the bound

Predict and update of three axes are 104 multiplications, 180 additions and one division. The covariance, which the
axes share, takes 180 of these operations: 36 for the row sums, 14 for other sums, 24 for the cross covariances, 48 for
what the covariance of the drifts forgets and gains, 58 for the measurement. Each mean takes 35. With each number of state
(49) read and written once, and the references (3) and coefficients (40) read once,
{bound_m4f} instructions an axis are the lower bound of this algorithm on a Cortex-M4F without fused operations. The code
takes {m4f}, {m4f_ratio} times that: the rest are the checks, the calls, what the loops over the covariance load again, and
the report of each axis.

On a Cortex-M0+ a product takes 49 instructions on average, a sum 40 (`firmware/boards/common/soft_float.S`; libgcc's
take 118 and 68) and the division 201 ([footprint](footprint.md)), together {bound_m0:,} an axis; the code takes {m0:,},
{m0_ratio} times that. How few a product or a sum could do with on 32-bit registers is not known to us; of the 49, four
are multiplications.

For contrast, a dense filter of six states (one fewer) takes 1969 + 413 on the M4F and 63,485 + 17,500 on the M0+.
"""


def run(board, image, *options):
    """What an image prints. A program that does not end, or ends with an error, ends the test."""
    command = ["qemu-system-arm", "-M", board, "-display", "none", "-monitor", "none", "-serial", "null",
               "-semihosting-config", "enable=on,target=native", *options, "-kernel", str(image)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)
    text = done.stdout + done.stderr
    if done.returncode != 0:
        sys.exit(f"{image} on {board}: exit code {done.returncode}\n{text}")
    return text


def numbers(text):
    return {name: int(number) for name, number in re.findall(r"^(\w+) (\d+)$", text, re.MULTILINE)}


def image(images, processor, name):
    return images / f"mcu-{processor}" / FOLDER / f"zerorate-{name}.elf"


def compare_bits(images, programs):
    answers = {}
    for program in programs:
        answers[program.name] = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    name = programs[0].name.split("-")[0]
    for processor, (board, _) in PROCESSORS.items():
        answers[processor] = run(board, image(images, processor, name))
    first, *others = answers.values()
    if not numbers(first):
        sys.exit("no digests")
    wrong = [who for who, answer in answers.items() if numbers(answer) != numbers(first)]
    for who, answer in answers.items():
        print(f"{who}:", " ".join(answer.split()))
    if wrong:
        sys.exit(f"other bits than {programs[0].name}: {', '.join(wrong)}")
    print(f"{len(answers)} agree in {len(numbers(first))} sections")


def measure(images):
    """(line, processor) -> instructions."""
    counts = {}
    for processor, (board, period_ns) in PROCESSORS.items():
        periods = numbers(run(board, image(images, processor, "counts"), "-icount", "shift=10"))
        if periods.keys() != FIGURES.keys():
            sys.exit(f"{processor}: {periods.keys() ^ FIGURES.keys()}")
        for line, (_, share) in FIGURES.items():
            instructions = periods[line] / 100 * period_ns / NANOSECONDS_AN_INSTRUCTION / share
            counts[line, processor] = round(instructions, 1) if instructions < 100 else round(instructions)
    return counts


def page(counts):
    rows = "\n".join(
        f"| {words} | " + " | ".join(f"{counts[line, processor]:g}" for processor in PROCESSORS) + " |"
        for line, (words, _) in FIGURES.items())
    m4f, m0 = counts["kalman_step", "cortex-m4f"], counts["kalman_step", "cortex-m0plus"]
    return PAGE.format(processors=" | ".join(PROCESSORS), lines="---|" * len(PROCESSORS), rows=rows,
                       bound_m4f=BOUND_M4F, m4f=m4f, m4f_ratio=f"{m4f / BOUND_M4F:.2f}",
                       bound_m0=BOUND_M0, m0=m0, m0_ratio=f"{m0 / BOUND_M0:.2f}")


def documented(text):
    """What page() wrote."""
    counts = {}
    for line, (words, _) in FIGURES.items():
        row = re.search(rf"^\| {re.escape(words)} \| (.*) \|$", text, re.MULTILINE)
        if not row:
            sys.exit(f"no row: {words}")
        for processor, figure in zip(PROCESSORS, row[1].split(" | "), strict=True):
            counts[line, processor] = float(figure)
    return counts


def check_counts(counts, file):
    known = documented(file.read_text())
    complaints = [f"{line} on {processor}: {known[line, processor]:g}, now {count:g}"
                  for (line, processor), count in counts.items()
                  if count > GROWTH * known[line, processor] + 1]
    complaints += [f"{line} on {processor}: {counts[line, processor]:g}, promised {most}"
                   for (line, processor), most in MOST.items() if counts[line, processor] > most]
    for (line, processor), count in counts.items():
        print(f"{line} {processor} {count:g}")
    if complaints:
        sys.exit("grown:\n" + "\n".join(complaints))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    bits = commands.add_parser("bits")
    bits.add_argument("images", type=pathlib.Path)
    bits.add_argument("programs", type=pathlib.Path, nargs="+")
    counts = commands.add_parser("counts")
    counts.add_argument("images", type=pathlib.Path)
    counts.add_argument("file", type=pathlib.Path)
    counts.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    if arguments.command == "bits":
        compare_bits(arguments.images, arguments.programs)
    elif arguments.write:
        arguments.file.write_text(page(measure(arguments.images)))
    else:
        check_counts(measure(arguments.images), arguments.file)


if __name__ == "__main__":
    main()
