#!/usr/bin/env python3
"""Runs programs on processors that QEMU emulates: compares their bits, counts their instructions.

usage: emulated_processor.py bits IMAGES PROGRAM...
           PROGRAM of this machine and IMAGES/mcu-*/.../zerorate-NAME.elf must print the same, where
           NAME is the first part of PROGRAM's name, up to the first dash
       emulated_processor.py counts IMAGES FILE [--write]
           FILE holds the table of instructions: writes it, or fails where one has grown by more than 3 %
       emulated_processor.py board IMAGES EXAMPLES
           the template of a board, its holes filled in (images/board.cpp), must publish what its chip plays; EXAMPLES is
           the folder of receive_rate.py, which reads the messages. The port to the STM32F405 must say that its chip is missing
"""

import argparse
import math
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

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
    "force_step_still": ("the same with an accelerometer and three inputs, still", 1),
    "force_step_moving": ("the same with an accelerometer and three inputs, moving", 1),
}
# The promises of the project.
MOST = {
    ("kalman_step", "cortex-m4f"): 330,
    ("averaged_sample_of_three_axes", "cortex-m4f"): 52,
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

Of a sample through `GyroNode::step`, the room for [references of the heading](../design/references.md) takes 106 on a
Cortex-M4F at rest and 134 in motion, also where none ever comes: 35 and 45 an axis. A node whose
`NodeCapacity::takes_references` is false is without.

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


def run(board, image, *options, serial="null"):
    """What an image prints. A program that does not end, or ends with an error, ends the test."""
    command = ["qemu-system-arm", "-M", board, "-display", "none", "-monitor", "none", "-serial", serial,
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


def unstuff(piece):
    """A frame from between two zeros of a serial line (COBS; docs/reference/rate-frame.md)."""
    frame = b""
    while piece:
        length, block, piece = piece[0], piece[1:piece[0]], piece[piece[0]:]
        frame += block + (b"\0" if length < 255 and piece else b"")
    return frame


# As images/board.cpp plays it: LSB and standard deviation of a sample, and what the axes show beside their noise.
LSB_DPS, NOISE_DPS = 0.00875, 0.00875 * math.sqrt(10)
BIAS_DPS, TURN_DPS = [100 * LSB_DPS, -40 * LSB_DPS, 20 * LSB_DPS], 1143 * LSB_DPS
SAMPLE_S = 64 / 6667
SAMPLES, DRIVE_S, END_S = 7292, (3125 * SAMPLE_S, 5208 * SAMPLE_S), 7292 * SAMPLE_S
CALIBRATED = 0x001


def check_board(images, examples):
    sys.path.append(str(examples))
    from receive_rate import decode
    for processor in ("cortex-m4f", "cortex-m7"):
        with tempfile.TemporaryDirectory() as folder:
            line = pathlib.Path(folder) / "line"
            said = run(PROCESSORS[processor][0], image(images, processor, "board"), "-icount", "shift=5,sleep=off",
                       serial=f"file:{line}")
            messages = [decode(unstuff(piece)) for piece in line.read_bytes().split(b"\0")[:-1]]
        complaints = list(board_complaints(messages))
        if numbers(said) != {"saves": 1}:
            complaints.append(f"not saved at the end of the one stop: {said}")
        if complaints:
            sys.exit(f"{processor}: " + "\n".join(complaints[:20]))
        print(f"{processor}: {len(messages)} messages of the template say what its chip plays")


def board_complaints(messages):
    """What is wrong with the messages of a stop, a drive and a stop."""
    if None in messages or [message["sequence"] for message in messages] != list(range(len(messages))):
        yield "damaged or lost messages"
        return
    if not SAMPLES - 20 <= len(messages) <= SAMPLES:
        yield f"{len(messages)} messages"
    for before, message in zip(messages, messages[1:]):
        if abs(message["time_s"] - before["time_s"] - SAMPLE_S) > 20e-6:
            yield f"{before['time_s']} s: the next sample is stamped {message['time_s']} s"
    # Nothing is known before the second second, and for some seconds after the last pulse nothing is believed.
    spans = {"still": [(4.0, DRIVE_S[0]), (DRIVE_S[1] + 10.0, END_S)], "moving": [(DRIVE_S[0] + 0.2, DRIVE_S[1])]}
    for motion, times in spans.items():
        for begin, end in times:
            part = [message for message in messages if begin < message["time_s"] < end]
            wrong = [message for message in part if (message["motion"], message["health"]) != (motion, CALIBRATED)]
            if wrong:
                yield f"{wrong[0]['time_s']} s: {motion} expected: {wrong[0]}"
            yield from rate_complaints(part, [0, 0, TURN_DPS if motion == "moving" else 0])


def rate_complaints(part, turn_dps):
    """Bias and mean rate within five standard deviations: that of the message, and that of a mean of white noise."""
    last = part[-1]
    for axis, bias_dps in enumerate(BIAS_DPS):
        if abs(last["bias_dps"][axis] - bias_dps) > 5 * last["sigma_dps"][axis]:
            yield f"{last['time_s']} s: bias {last['bias_dps'][axis]}, not {bias_dps} deg/s"
        mean = statistics.fmean(message["rate_dps"][axis] for message in part)
        largest_sigma = max(message["sigma_dps"][axis] for message in part)
        if abs(mean - turn_dps[axis]) > 5 * (NOISE_DPS / math.sqrt(len(part)) + largest_sigma):
            yield f"to {last['time_s']} s: mean rate {mean}, not {turn_dps[axis]} deg/s"


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
    board = commands.add_parser("board")
    board.add_argument("images", type=pathlib.Path)
    board.add_argument("examples", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.command == "bits":
        compare_bits(arguments.images, arguments.programs)
    elif arguments.command == "board":
        check_board(arguments.images, arguments.examples)
    elif arguments.write:
        arguments.file.write_text(page(measure(arguments.images)))
    else:
        check_counts(measure(arguments.images), arguments.file)


if __name__ == "__main__":
    main()
