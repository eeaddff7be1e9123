// The gyros behind the emulated pins.

import { spawn, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';

const INT1_CTRL = 0x0d, WHO_AM_I = 0x0f, CTRL2_G = 0x11, CTRL3_C = 0x12, CTRL9_XL = 0x18;
const STATUS_REG = 0x1e, OUT_TEMP_L = 0x20, OUTX_L_G = 0x22, OUTZ_H_G = 0x27;
const GDA = 0x02, TDA = 0x04, DRDY_G = 0x02, BDU = 0x40, IF_INC = 0x04, SW_RESET = 0x01;
const RESET_TIME_US = 50;

// The gyro of an LSM6DSO at the level of its registers (ST DS12140), fed with raw conversions. It owes
// nothing to the simulated chip that the driver was written against.
export class Lsm6dso {
  constructor(board, { dataReadyPin = 20, identity = 0x6c } = {}) {
    Object.assign(this, { board, identity });
    this.pin = board.mcu.gpio[dataReadyPin];
    this.pinIsConnected = true;
    this.reset();
  }
  reset() {
    this.registers = new Uint8Array(128);
    this.registers[0x02] = 0x3f;
    this.registers[WHO_AM_I] = this.identity;
    this.registers[CTRL3_C] = IF_INC;
    this.registers[CTRL9_XL] = 0xe0;
    this.held = new Map(); // low byte's address -> value that block data update keeps
    this.driveInt1();
  }
  get isPowered() { return this.registers[CTRL2_G] >> 4 !== 0; }

  // One conversion: three rates and a temperature, each 16 bits.
  measure(rates, temperature) {
    if (!this.isPowered || this.isResetting) return;
    [temperature, ...rates].forEach((raw, i) => {
      this.registers[OUT_TEMP_L + 2 * i] = raw & 0xff;
      this.registers[OUT_TEMP_L + 2 * i + 1] = (raw >> 8) & 0xff;
    });
    this.registers[STATUS_REG] = GDA | TDA;
    this.driveInt1();
  }
  driveInt1() {
    const isReady = this.registers[STATUS_REG] & GDA && this.registers[INT1_CTRL] & DRDY_G;
    if (this.pinIsConnected) this.pin.setInputValue(!!isReady);
  }

  read(address) {
    if (address >= OUT_TEMP_L && address <= OUTZ_H_G) return this.readOutput(address);
    const resetting = address === CTRL3_C && this.isResetting ? SW_RESET : 0;
    return this.registers[address] | resetting;
  }
  readOutput(address) {
    const low = address & ~1;
    if (address === low) {
      if (this.registers[CTRL3_C] & BDU) this.held.set(low, this.registers[low + 1]);
      return this.registers[low];
    }
    const high = this.held.get(low) ?? this.registers[address];
    this.held.delete(low);
    this.registers[STATUS_REG] &= low < OUTX_L_G ? ~TDA : ~GDA;
    this.driveInt1();
    return high;
  }
  write(address, value) {
    const readOnly = address === WHO_AM_I || (address >= STATUS_REG && address <= OUTZ_H_G);
    if (readOnly || this.isResetting) return;
    if (address === CTRL3_C && value & SW_RESET) {
      this.reset();
      this.isResetting = true;
      this.board.at(this.board.now_us + RESET_TIME_US, () => { this.isResetting = false; });
      return;
    }
    this.registers[address] = value;
    this.driveInt1();
  }
  next(address) { return this.registers[CTRL3_C] & IF_INC ? (address + 1) & 0x7f : address; }
}

const PULSE_US = 100;

// A chip of hal/sim behind the emulated pins: another process, asked byte by byte (pico_chip.cpp).
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
  // An edge without a level that stays is a pulse; one of a line that is high already follows a short low.
  driveInterrupt(level, hadEdge) {
    this.level = level;
    if (hadEdge && this.pin.rawInputValue) this.pin.setInputValue(false);
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

  // Of a chip of frames, or of words.
  select() { this.ask('s'); }
  reply() { return this.ask('p'); }
  exchangeFrame(command) { this.ask('f', command); }
}
