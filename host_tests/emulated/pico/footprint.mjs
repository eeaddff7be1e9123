// How much of a Pico the node needs: measured on the image that is shipped, in the emulated chip.
// `node footprint.mjs FILE` writes docs/reference/footprint.md; footprint.test.mjs holds it to that.

import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { pathToFileURL } from 'node:url';
import { rates } from './frames.mjs';
import { LEARNING, Rig, drive, image } from './rig.mjs';

const DURATION_S = 40, SEED = 3;

// The depth that the stack really reaches when interrupts come at the worst instruction, and the bound
// that toolchains/gates/stack_depth.py proves for the same image.

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

// Every new depth of the program is interrupted by both handlers of low priority, and every new depth of these
// by the third.
function interruptAtWorst(board) {
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
}

// Bytes that the image uses at most in two runs of some seconds of standstill and a pulse: of a new board, and of one
// that finds what the first had saved.
export function worstStack(name = 'zerorate-pico') {
  const stackOf = (state) => {
    const rig = new Rig({ name, state });
    interruptAtWorst(rig.board);
    rig.measureForEver([100, -200, 300]);
    rig.board.run(4e6);
    rig.pulse();
    rig.board.run(5e6);
    return { used: rig.board.stackUsed, state: rig.board.flash.state };
  };
  const first = stackOf();
  return Math.max(first.used, stackOf(first.state).used);
}

// Instructions from one conversion of the gyro to the next: everything the processor does meanwhile,
// interrupts and waiting for the bus included. By the state that the message said.
function instructionsBySample(rig, events, counts) {
  const motionAt = new Map(rates(rig.frames).map(({ time_ns, motion }) => [Number(time_ns / 1000n), motion]));
  const byMotion = { moving: [], still: [] };
  const samples = events.filter(({ isPulse }) => !isPulse);
  for (let i = 0; i + 1 < counts.length; i++) {
    byMotion[motionAt.get(samples[i].time_us)]?.push(counts[i + 1] - counts[i]);
  }
  return byMotion;
}
const mean = (numbers) => Math.round(numbers.reduce((sum, n) => sum + n, 0) / numbers.length);

// Symbols whose calls are counted, by what matches the mangled name -> row of the table.
const COUNTED = new Map([
  [/^__aeabi_fmul$/, 'product (`__aeabi_fmul`)'],
  [/^__aeabi_fadd$/, 'sum (`__aeabi_fadd`)'],
  [/^__aeabi_fsub$/, 'difference (`__aeabi_fsub`)'],
  [/^__aeabi_fdiv$/, 'quotient (`__aeabi_fdiv`)'],
]);

// Mean instructions of a call of each, with all that it calls and without interrupts: from its first
// instruction to the one that it returns to, over seconds of standstill.
function instructionsByCall(name) {
  const rig = new Rig({ name });
  const { board } = rig;
  const { core } = board.mcu;
  const entries = new Map();
  for (const [pattern, name] of COUNTED) {
    const symbol = [...board.symbols].find(([mangled]) => pattern.test(mangled));
    entries.set(symbol[1].address & ~1, name);
  }
  const totals = new Map([...COUNTED.values()].map((name) => [name, { calls: 0, instructions: 0 }]));
  const open = [];
  let handlers = 0, inHandlers = 0;
  const enter = core.exceptionEntry, leave = core.exceptionReturn;
  core.exceptionEntry = (number) => { enter(number); handlers++; };
  core.exceptionReturn = (code) => { leave(code); handlers--; };
  rig.measureForEver([100, -200, 300]);
  board.run(3e6);
  board.beforeInstruction = (pc) => {
    if (handlers > 0) {
      inHandlers++;
      return;
    }
    const now = board.instructions - inHandlers;
    while (open.length > 0 && open.at(-1).until === pc && core.SP === open.at(-1).stack) {
      const { name, since } = open.pop();
      totals.get(name).calls++;
      totals.get(name).instructions += now - since;
    }
    const name = entries.get(pc);
    if (name) open.push({ name, since: now, until: core.LR & ~1, stack: core.SP });
  };
  board.run(7e6);
  return new Map([...totals].map(([name, { calls, instructions }]) =>
    [`instructions: ${name}`, Math.round(instructions / calls)]));
}

function measureImage(name) {
  const counts = [];
  const { rig, events } = drive(DURATION_S, SEED, {
    name, onSample: (board) => counts.push(board.instructions),
  });
  const { moving, still } = instructionsBySample(rig, events, counts);
  const address = (name) => rig.board.symbols.get(name).address;
  const statics = address('bss_end') - address('data_start');
  const stack = address('stack_top') - address('stack_limit');
  return new Map([
    ['flash, bytes', fs.statSync(`${image(name)}.bin`).size],
    ['static RAM, bytes', statics],
    ['stack reserved, bytes', stack],
    ['stack at most, proved, bytes', provenStack(name)],
    ['stack used in this drive, bytes', rig.board.stackUsed],
    ['stack reached with interrupts at the worst instruction, bytes', worstStack(name)],
    ['RAM with stack, bytes', statics + stack],
    ['instructions per sample period, moving, mean', mean(moving)],
    ['instructions per sample period, still, mean', mean(still)],
    ['instructions per sample period, largest', Math.max(...moving, ...still)],
    ...instructionsByCall(name),
  ]);
}

// Figures by row: of the small image, and of the one that learns.
export function measure() {
  const [small, learning] = [undefined, LEARNING].map(measureImage);
  return new Map([...small].map(([row, value]) => [row, [value, learning.get(row)]]));
}

// The table of footprint.md, as it is written and read.
export const format = (figures) => `# Footprint of the node on a Pico

Three axes, the Kalman predictor, six flicker decades, 104 Hz into ticks of 0.5 s, driver, framing: in
\`zerorate-pico.uf2\` with one hypothesis, in \`zerorate-pico-learning.uf2\` with the twelve from which the node learns its
noise model. Measured in the emulated chip over a simulated drive of ${DURATION_S} s by
\`cmake --build --preset host-release --target footprint\` (the images with
\`-DZERORATE_TEST_IMAGES=ON\`, as the tests build them); a test fails when a figure has grown by more than 3 %.

| figure | \`zerorate-pico\` | \`zerorate-pico-learning\` |
|---|---|---|
${[...figures].map(([row, values]) => `| ${row} | ${values.join(' | ')} |`).join('\n')}

The images may take 60 and 76 KiB of flash, and 8 and 24 KiB of RAM. A sample period, 9.6 ms, has 1.2 million cycles at
125 MHz; an instruction of the Cortex-M0+ takes one or two, and more where it waits for the flash, which the emulator
does not model. The proved bound of the stack follows every call of the linked image (\`toolchains/gates/stack_depth.py\`),
and it is reached: with an interrupt of each priority at every new depth of the stack, the image uses exactly as much
(\`footprint.test.mjs\`). The largest sample period is one in which a stop ends
and what was learnt is written to the flash. Counts of single calls are means over four seconds of standstill, with all
that is called and without interrupts; what a tick of the predictors takes is in [instructions](instructions.md).
`;
export const parse = (text) => new Map(
  [...text.matchAll(/^\| (.+) \| (\d+) \| (\d+) \|$/gm)].map(([, row, ...values]) => [row, values.map(Number)]));

if (process.argv[2] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  fs.writeFileSync(process.argv[2], format(measure()));
}
