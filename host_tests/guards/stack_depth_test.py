#!/usr/bin/env python3
"""Tests toolchains/gates/stack_depth.py on small programs whose depth is known, and on such as it must refuse."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

GATE = pathlib.Path(__file__).resolve().parents[2] / "toolchains/gates/stack_depth.py"

PROLOGUE = """
    .syntax unified
    .cpu cortex-m0plus
    .thumb
    .macro function name
    .global \\name
    .type \\name, %function
    .thumb_func
\\name:
    .endm
"""
# 12 by start, 8 by middle, 4000 and 4 by leaf; a far jump that looks like a call, a tail call, a loop.
PROGRAM = """
    function start
    push {r4, r5, lr}
    bl   middle
1:  b    1b
    function middle
    push {r4, lr}
    cmp  r0, #0
    beq  2f
    bl   leaf
2:  bl   3f
    nop
3:  pop  {r4}
    pop  {r1}
    mov  lr, r1
    b    sibling
    function sibling
    sub  sp, #8
    add  sp, #8
    bx   lr
    function leaf
    push {lr}
    ldr  r3, =-4000
    add  sp, r3
    movs r3, #250
    lsls r3, r3, #4
    add  sp, r3
    pop  {pc}
    .ltorg
    function handler
    sub  sp, #16
    add  sp, #16
    bx   lr
"""
# 4 by start, and 40 by the second branch, which only a table leads to.
SWITCH = """
    function start
    push {lr}
    cmp  r0, #1
    bhi  2f
    ldr  r3, =table
    lsls r0, r0, #2
    ldr  r3, [r3, r0]
    mov  pc, r3
1:  pop  {pc}
2:  pop  {pc}
3:  sub  sp, #40
    add  sp, #40
    pop  {pc}
    .ltorg
    .section .rodata
    .balign 4
table:
"""


class StackDepth(unittest.TestCase):
    def gate(self, program, reserved, *options):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "program.s")
            image = pathlib.Path(folder, "program.elf")
            source.write_text(PROLOGUE + program)
            subprocess.run(["arm-none-eabi-gcc", "-nostdlib", "-Wl,-Ttext=0x1000", "-Wl,--defsym=stack_limit=0x20000000",
                            f"-Wl,--defsym=stack_top=0x20000000+{reserved}", "-Wl,-estart", source, "-o", image],
                           check=True)
            return subprocess.run([sys.executable, "-B", GATE, "--objdump", "arm-none-eabi-objdump", "--nm",
                                   "arm-none-eabi-nm", *options, image], capture_output=True, text=True)

    def test_adds_up_the_deepest_chain_of_calls(self):
        done = self.gate(PROGRAM, 4024)
        self.assertIn("stack: 4024 bytes at most, 4024 reserved", done.stdout)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_adds_an_interrupt_and_what_the_processor_saves(self):
        done = self.gate(PROGRAM, 5000, "--interrupts", "handler")
        self.assertIn(f"stack: {4024 + 36 + 16} bytes at most", done.stdout)

    def test_refuses_one_byte_too_many(self):
        done = self.gate(PROGRAM, 4023)
        self.assertEqual(done.returncode, 1)
        self.assertIn("4024 bytes do not fit into 4023", done.stderr)

    def test_follows_the_branches_of_a_switch(self):
        program = f"{SWITCH}    .word 1b, 3b\n"
        done = self.gate(program, 100)
        self.assertIn("stack: 44 bytes at most", done.stdout)

    def test_follows_a_switch_whose_table_is_kept_on_the_stack(self):
        spilled = SWITCH.replace("push {lr}", "push {r1, lr}").replace("pop  {pc}", "pop  {r1, pc}").replace(
            "    lsls r0", "    str  r3, [sp]\n    movs r3, #0\n    ldr  r3, [sp]\n    lsls r0")
        done = self.gate(f"{spilled}    .word 1b, 3b\n", 100)
        self.assertIn("stack: 48 bytes at most", done.stdout)
        lost = spilled.replace("movs r3, #0", "str  r0, [sp]")
        self.assertIn("mov pc, r3", self.gate(f"{lost}    .word 1b, 3b\n", 100).stderr)

    def test_refuses_a_jump_without_a_table(self):
        done = self.gate("function start\n mov pc, r3\n", 100)
        self.assertIn("mov pc, r3", done.stderr)

    def test_refuses_recursion(self):
        done = self.gate("function start\n push {lr}\n bl again\n function again\n push {lr}\n bl start\n pop {pc}\n", 100)
        self.assertIn("recursion: start -> again -> start", done.stderr)

    def test_refuses_a_call_through_a_pointer(self):
        done = self.gate("function start\n push {lr}\n blx r3\n pop {pc}\n", 100)
        self.assertIn("blx r3", done.stderr)

    def test_refuses_a_stack_that_depends_on_data(self):
        done = self.gate("function start\n add sp, r0\n bx lr\n", 100)
        self.assertIn("add sp, r0", done.stderr)


if __name__ == "__main__":
    unittest.main()
