// A chip of hal/sim behind the emulated pins: another process, asked byte by byte (pico_chip.cpp).

import { spawn, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';

const PULSE_US = 100;

export class SimulatedChip {
  constructor(board, name, { dataReadyPin = 20 } = {}) {
    Object.assign(this, { board, following: 0 });
    this.pin = board.mcu.gpio[dataReadyPin];
    this.folder = fs.mkdtempSync(path.join(os.tmpdir(), 'pico-chip-'));
    const pipes = ['requests', 'replies'].map((end) => path.join(this.folder, end));
    if (spawnSync('mkfifo', pipes).status !== 0) throw new Error(`no pipes in ${this.folder}`);
    this.process = spawn(process.env.PICO_CHIP, [name, ...pipes], { stdio: ['ignore', 'ignore', 'inherit'] });
    [this.requests, this.replies] = [fs.openSync(pipes[0], 'w'), fs.openSync(pipes[1], 'r')];
    this.line = Buffer.alloc(64);
  }
  close() {
    for (const end of [this.requests, this.replies]) fs.closeSync(end);
    fs.rmSync(this.folder, { recursive: true });
  }

  ask(kind, ...numbers) {
    const time_ns = Math.round(this.board.mcu.clock.nanos);
    fs.writeSync(this.requests, `${[kind, time_ns, ...numbers].join(' ')}\n`);
    const length = fs.readSync(this.replies, this.line);
    if (length === 0) throw new Error(`the simulated chip ended at ${kind} ${numbers}`);
    const [value, next, level, hadEdge] = this.line.toString('latin1', 0, length).split(' ').map(Number);
    this.following = next;
    this.driveInterrupt(level === 1, hadEdge === 1);
    return value;
  }
  // An edge without a level that stays is a pulse.
  driveInterrupt(level, hadEdge) {
    this.level = level;
    if (hadEdge || level) this.pin.setInputValue(true);
    if (level || !this.pin.rawInputValue) return;
    this.board.at(this.board.now_us + PULSE_US, () => this.pin.setInputValue(this.level));
  }
  // Rates in deg/s, temperature in degC.
  measure(rates, temperature) { this.ask('m', ...rates, temperature); }
  upset(address, bits) { this.ask('u', address, bits); }

  // Of a chip of registers.
  read(address) { return this.ask('r', address); }
  write(address, value) { this.ask('w', address, value); }
  next() { return this.following; }

  // Of a chip of frames.
  reply() { return this.ask('p'); }
  exchangeFrame(command) { this.ask('f', command); }
}
