// The depth that the stack really reaches when interrupts come at the worst instruction, and the bound
// that toolchains/gates/stack_depth.py proves for the same image.

import { spawnSync } from 'node:child_process';
import { Rig, image } from './rig.mjs';

const SET_PENDING = 0xe000e200; // NVIC_ISPR (ARMv6-M, B3.4.5)
const FIRST_INTERRUPT = 16;
const LOW_PRIORITY = 1 << 0 | 1 << 20; // timer_0, uart0
const HIGH_PRIORITY = 1 << 13;         // io_bank0

// Bytes that no call, nested interrupts included, can exceed.
export function provenStack(name = 'zerorate-pico') {
  const tool = (program) => [`--${program}`, `arm-none-eabi-${program}`];
  const interrupts = ['handle_timer_0,handle_uart0', 'handle_io_bank0'].flatMap((names) => ['--interrupts', names]);
  const done = spawnSync('python3', ['-B', process.env.PICO_STACK_GATE, ...tool('objdump'), ...tool('nm'),
    ...interrupts, `${image(name)}.elf`], { encoding: 'utf8' });
  return Number(/^stack: (\d+) bytes at most/.exec(done.stdout)[1]);
}

// Bytes that the image uses at most in some seconds of standstill and a pulse, while every new depth of the
// program is interrupted by both handlers of low priority, and every new depth of these by the third.
export function worstStack(name = 'zerorate-pico', until_us = 5e6) {
  const rig = new Rig({ name });
  const { board } = rig;
  const { core } = board.mcu;
  const deepest = { program: Infinity, handler: Infinity };
  const open = [];
  const { exceptionEntry, exceptionReturn } = core;
  core.exceptionEntry = (number) => { exceptionEntry(number); open.push(number - FIRST_INTERRUPT); };
  core.exceptionReturn = (code) => { exceptionReturn(code); open.pop(); };
  const pend = (interrupts) => board.mcu.writeUint32(SET_PENDING, interrupts);
  board.beforeInstruction = () => {
    const level = ['program', 'handler'][open.length];
    if (level === undefined || !(core.SP < deepest[level])) return;
    deepest[level] = core.SP;
    pend(level === 'program' ? LOW_PRIORITY : HIGH_PRIORITY);
  };
  rig.measureForEver([100, -200, 300]);
  board.run(until_us - 1e6);
  rig.pulse();
  board.run(until_us);
  return board.stackUsed;
}
