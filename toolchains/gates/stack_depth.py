#!/usr/bin/env python3
"""Proves how deep the stack of an image for a Cortex-M0+ can become, and refuses more than it reserves.

usage: stack_depth.py --objdump OBJDUMP --nm NM [--interrupts NAME,NAME...]... IMAGE

Follows every instruction of the linked image from start() on, libgcc and assembly included: pushes, moves
of the stack pointer, calls, the jump tables of a switch. Recursion, calls through pointers and a stack
pointer that depends on data cannot be followed and are refused. Each --interrupts names handlers of one
priority, one of which may interrupt the program and, once, the handlers of the priorities named before.
The image reserves what lies between its symbols stack_limit and stack_top.
"""

import argparse
import re
import subprocess
import sys
from functools import cached_property

# Registers that the processor saves, and what aligns them (ARMv6-M Architecture Reference Manual, B1.5.6).
EXCEPTION_FRAME = 32 + 4

INSTRUCTION = re.compile(r"^ *([0-9a-f]+):\t[0-9a-f ]+?\s*\t(\S+)\s*(.*)$")
LABEL = re.compile(r"^([0-9a-f]+) <(.+)>:$")
BRANCH_TARGET = re.compile(r"^([0-9a-f]+) <")
INDEXED = re.compile(r"^\[(r\d+), (r\d+)\]$")
ON_STACK = re.compile(r"^\[sp(?:, #(\d+))?\]$")
CONTENTS = re.compile(r"^ ([0-9a-f]+) ((?:[0-9a-f]+ ){1,4}) ")
CONDITIONAL = re.compile(r"^b(eq|ne|cs|cc|hs|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)(\.n|\.w)?$")


class Unprovable(Exception):
    """What this program cannot follow."""


class Image:
    def __init__(self, objdump, path):
        listing = subprocess.run([objdump, "-d", "-j", ".text", "-j", ".data", path], check=True,
                                 capture_output=True, text=True).stdout
        self.names, self.code = {}, {}
        previous = None
        for line in listing.splitlines():
            if label := LABEL.match(line):
                self.names[int(label[1], 16)] = label[2]
                continue
            found = INSTRUCTION.match(line)
            if not found:
                continue
            address = int(found[1], 16)
            operands = re.split(r"\s*[;@]", found[3])[0].strip()
            if found[2] == ".word":
                continue
            self.code[address] = (found[2], operands, found[3])
            if previous is not None and previous not in self.next_of:
                self.next_of[previous] = address
            previous = address
        self.words = dict(self.contents(objdump, path))

    @staticmethod
    def contents(objdump, path):
        """(address, word) of code and constants."""
        listing = subprocess.run([objdump, "-s", "-j", ".text", "-j", ".rodata", "-j", ".data", path], check=True,
                                 capture_output=True, text=True).stdout
        for line in listing.splitlines():
            if row := CONTENTS.match(line):
                for i, word in enumerate(word for word in row[2].split() if len(word) == 8):
                    yield int(row[1], 16) + 4 * i, int.from_bytes(bytes.fromhex(word), "little")

    @cached_property
    def next_of(self):
        return {}

    def address_of(self, name):
        for address, known in self.names.items():
            if known == name:
                return address
        raise Unprovable(f"no function {name}")

    def function_end(self, entry):
        return min((address for address in self.names if address > entry), default=max(self.code) + 1)

    def jump_table(self, entry, table):
        """Branches of a switch: words that follow each other as long as they lead into the function."""
        end = self.function_end(entry)
        while entry <= (target := self.words.get(table, 0) & ~1) < end:
            yield target
            table += 4


def registers_in(operands):
    """How many registers a list like {r4, r5-r7, lr} holds."""
    count = 0
    for part in operands.strip("{} ").split(","):
        first, _, last = part.strip().partition("-")
        count += int(last[1:]) - int(first[1:]) + 1 if last else 1
    return count


class JumpTable(int):
    """Address of a table that one word was taken from."""


class Depths:
    """The deepest stack below each function's entry, and by which call."""

    def __init__(self, image):
        self.image = image
        self.known = {}
        self.open = []

    def of(self, address):
        if address in self.open:
            names = " -> ".join(self.image.names.get(a, hex(a)) for a in [*self.open, address])
            raise Unprovable(f"recursion: {names}")
        if address not in self.known:
            self.open.append(address)
            self.known[address] = self.follow(address)
            self.open.pop()
        return self.known[address]

    def path(self, address):
        """(function, its own part of the deepest stack) down the deepest chain of calls."""
        while address is not None:
            depth, at, callee = self.of(address)
            yield self.image.names.get(address, hex(address)), at if callee is not None else depth
            address = callee

    def follow(self, entry):
        """(deepest, depth at the call that leads there, the function called) of one function."""
        deepest = (0, 0, None)
        depths = {}
        waiting = [(entry, 0, {})]
        while waiting:
            address, depth, constants = waiting.pop()
            while True:
                if address in depths:
                    if depths[address] != depth:
                        raise self.unprovable(entry, address, "two depths of the stack meet")
                    break
                depths[address] = depth
                mnemonic, operands, _ = self.image.code[address]
                callee, targets, goes_on = self.flow(entry, address, mnemonic, operands, constants)
                depth = self.moved(entry, address, depth, constants)
                if depth > deepest[0]:
                    deepest = (depth, depth, None)
                if callee is not None:
                    below = self.of(callee)[0]
                    if depth + below > deepest[0]:
                        deepest = (depth + below, depth, callee)
                for target in targets:
                    waiting.append((target, depth, dict(constants)))
                if not goes_on:
                    break
                address = self.image.next_of.get(address)
                # A call that does not return ends the function, with what fills up the gap after it.
                if address is None or (address in self.image.names and mnemonic in ("bl", "nop")):
                    break
        return deepest

    def unprovable(self, entry, address, why):
        return Unprovable(f"{self.image.names.get(entry, hex(entry))} at {address:#x}: {why}")

    def moved(self, entry, address, depth, constants):
        """The depth after an instruction; keeps account of constants in registers."""
        mnemonic, operands, text = self.image.code[address]
        parts = [part.strip() for part in operands.split(",")]
        if mnemonic == "push":
            return depth + 4 * registers_in(operands)
        if mnemonic == "pop":
            return depth - 4 * registers_in(operands)
        if mnemonic in ("sub", "add") and parts[0] == "sp":
            by = int(parts[-1][1:]) if parts[-1].startswith("#") else constants.get(parts[-1])
            if by is None:
                raise self.unprovable(entry, address, f"{mnemonic} {operands}")
            by = by - (1 << 32) if by >= 1 << 31 else by
            return depth + by if mnemonic == "sub" else depth - by
        if mnemonic == "bl":
            for register in ("r0", "r1", "r2", "r3", "ip"):  # the callee's to change
                constants.pop(register, None)
            return depth
        if mnemonic in ("mov", "msr") and parts[0] in ("sp", "MSP"):
            raise self.unprovable(entry, address, f"{mnemonic} {operands}")
        self.learn(mnemonic, parts, text, constants, depth)
        return depth

    def learn(self, mnemonic, parts, text, constants, depth):
        target, value = parts[0], None
        on_stack = ON_STACK.match(", ".join(parts[1:]))
        place = depth - int(on_stack[1] or 0) if on_stack else None  # a word by its distance from the entry's stack
        if mnemonic == "str" and on_stack:
            target, value = place, constants.get(target)
        elif mnemonic == "ldr" and on_stack:
            value = constants.get(place)
        elif mnemonic == "ldr" and (indexed := INDEXED.match(", ".join(parts[1:]))):
            base = constants.get(indexed[1])
            value = None if base is None else JumpTable(base)
        elif mnemonic == "ldr" and (literal := re.search(r"[@;] \(([0-9a-f]+)", text)):
            value = self.image.words.get(int(literal[1], 16))
        elif mnemonic == "movs" and parts[-1].startswith("#"):
            value = int(parts[-1][1:])
        elif mnemonic == "lsls" and len(parts) == 3 and parts[2].startswith("#") and parts[1] in constants:
            value = constants[parts[1]] << int(parts[2][1:]) & 0xFFFFFFFF
        elif mnemonic in ("negs", "rsbs") and parts[1] in constants:
            value = -constants[parts[1]] & 0xFFFFFFFF
        elif mnemonic == "adds" and parts[-1].startswith("#") and parts[0] in constants and len(parts) == 2:
            value = constants[parts[0]] + int(parts[-1][1:]) & 0xFFFFFFFF
        elif mnemonic == "mov" and len(parts) == 2 and parts[1] in constants:
            value = constants[parts[1]]
        if value is None:
            constants.pop(target, None)
        else:
            constants[target] = value

    def flow(self, entry, address, mnemonic, operands, constants):
        """(function called, branches within the function, whether the next instruction follows)."""
        target = BRANCH_TARGET.match(operands)
        target = int(target[1], 16) if target else None
        if mnemonic == "bl":  # GCC's far jump within a function, too
            return (target, [], True) if target in self.image.names else (None, [target], False)
        if CONDITIONAL.match(mnemonic):
            return None, [target], True
        if mnemonic in ("b.n", "b", "b.w"):
            is_other = target in self.image.names and target != entry
            return (target, [], False) if is_other else (None, [target], False)
        if mnemonic == "bx" and operands != "lr":
            callee = constants.get(operands)
            if callee is None:
                raise self.unprovable(entry, address, f"bx {operands}")
            return callee & ~1, [], False
        if mnemonic == "mov" and operands.startswith("pc"):
            table = constants.get(operands.split(",")[1].strip())
            branches = list(self.image.jump_table(entry, table)) if isinstance(table, JumpTable) else []
            if not branches:
                raise self.unprovable(entry, address, f"mov {operands}")
            return None, branches, False
        if mnemonic == "blx":
            raise self.unprovable(entry, address, f"blx {operands}")
        ends = mnemonic in ("bx", "udf", "bkpt") or mnemonic == "pop" and "pc" in operands
        return None, [], not ends


def reserved(nm, path):
    listing = subprocess.run([nm, path], check=True, capture_output=True, text=True).stdout
    symbols = {line.split()[-1]: int(line.split()[0], 16) for line in listing.splitlines() if line[0] != " "}
    return symbols["stack_top"] - symbols["stack_limit"]


def main():
    parser = argparse.ArgumentParser(description="Bounds the stack of an image.")
    parser.add_argument("--objdump", required=True)
    parser.add_argument("--nm", required=True)
    parser.add_argument("--interrupts", action="append", default=[], metavar="NAME,NAME...")
    parser.add_argument("--paths", action="store_true", help="show the deepest chains of calls")
    parser.add_argument("image")
    arguments = parser.parse_args()

    image = Image(arguments.objdump, arguments.image)
    depths = Depths(image)
    total, roots = 0, []
    try:
        for names in ["start", *arguments.interrupts]:
            root = max((image.address_of(name) for name in names.split(",")), key=lambda a: depths.of(a)[0])
            total += depths.of(root)[0] + (EXCEPTION_FRAME if roots else 0)
            roots.append(root)
    except Unprovable as why:
        sys.exit(f"{arguments.image}: stack: {why}")
    most = reserved(arguments.nm, arguments.image)
    parts = " + ".join(f"{image.names[root]} {depths.of(root)[0]}" for root in roots)
    print(f"stack: {total} bytes at most, {most} reserved: {parts}, {EXCEPTION_FRAME} a preemption")
    if arguments.paths:
        for root in roots:
            for name, depth in depths.path(root):
                print(f"  {depth:5} {name}")
    if total > most:
        sys.exit(f"{arguments.image}: stack: {total} bytes do not fit into {most}")


if __name__ == "__main__":
    main()
