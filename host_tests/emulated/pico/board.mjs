// A Raspberry Pi Pico in rp2040js that is as strict as silicon, and stricter: what would work by
// luck is a violation. Every difference to rp2040js has a mutant or a test that needs it.

import zlib from 'node:zlib';
import { GPIOPinState, RP2040 } from 'rp2040js';
import { FLASH, elfSymbols, uf2Blocks } from './image.mjs';
import { Flash } from './flash.mjs';
import { Pl011 } from './pl011.mjs';

export { GPIOPinState };
export class Violation extends Error {}

const RAM = 0x20000000;
const BOOT2_AT = 0x20041f00; // where the boot ROM copies it (datasheet, 2.8.1.3)
const UART0_INTERRUPT = 20;
// Peripheral -> its bit in RESETS (datasheet, 2.14.3).
const RESET_BITS = { 0x40014: 5, 0x4001c: 8, 0x40028: 12, 0x40034: 22, 0x4003c: 16, 0x40044: 3, 0x40054: 21 };
// Out of reset when boot2 runs: the flash and its pins.
const RESETS_AT_BOOT = 0x1ffffff & ~((1 << 6) | (1 << 9));

// CRC-32 of the boot ROM: most significant bit first, no final inversion.
function boot2Checksum(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte << 24;
    for (let i = 0; i < 8; i++) crc = crc & 0x80000000 ? (crc << 1) ^ 0x04c11db7 : crc << 1;
  }
  return crc >>> 0;
}

export class Board {
  // image: path without suffix; .uf2 is flashed, .elf names the functions
  // state: what an earlier run left in the flash
  constructor(image, state) {
    this.mcu = new RP2040();
    this.symbols = elfSymbols(`${image}.elf`);
    for (const [offset, bytes] of uf2Blocks(`${image}.uf2`)) this.mcu.flash.set(bytes, offset);
    this.instructions = 0;
    this.lowestStack = 0xffffffff;
    this.watchdogBites = 0;
    this.fault = this.symbols.get('fault').address & ~1;
    const strict = (name, text) => this.violation(`${name}: ${text}`);
    this.mcu.logger = { debug() {}, info() {}, warn: strict, error: strict };
    this.mcu.onBreak = () => this.violation('an undefined instruction, or one from a flash that is away');
    this.makeInterruptsReal();
    this.makeResetsReal();
    this.makeMemoryReal();
    this.makePinsReal();
    this.makeClocksReal();
    this.uart = new Pl011(this, UART0_INTERRUPT);
    this.mcu.uart[0] = this.mcu.peripherals[0x40034] = this.uart;
    this.flash = new Flash(this);
    this.guardResets();
    if (state) this.flash.state = state;
    this.boot();
  }

  violation(text) { throw new Violation(text); }

  // The NVIC latches a line that rises, forgets it when the handler is entered, and looks at the line
  // again when it returns (ARMv6-M, B3.4). rp2040js lets WFI sleep through what is pending already,
  // runs handlers inside masked sections, and never forgets what software made pending.
  makeInterruptsReal() {
    const { core } = this.mcu;
    let lines = 0;
    core.setInterrupt = (number, level) => {
      const bit = 1 << number;
      if (level && !(lines & bit)) {
        core.pendingInterrupts |= bit;
        core.interruptsUpdated = true;
      }
      lines = level ? lines | bit : lines & ~bit;
    };
    const enter = core.exceptionEntry.bind(core);
    core.exceptionEntry = (number) => {
      if (number >= 16) core.pendingInterrupts &= ~(1 << (number - 16));
      enter(number);
    };
    const leave = core.exceptionReturn.bind(core);
    core.exceptionReturn = (code) => {
      leave(code);
      core.pendingInterrupts |= lines;
      core.interruptsUpdated = true;
    };
  }

  makeResetsReal() {
    this.resets = this.mcu.peripherals[0x4000c];
    this.resets.reset = RESETS_AT_BOOT;
    Object.defineProperty(this.resets, 'reset_done', { get() { return ~this.reset & 0x1ffffff; } });
  }
  // A block in reset does not answer. rp2040js does not care.
  guardResets() {
    for (const [page, bit] of Object.entries(RESET_BITS)) {
      const block = this.mcu.peripherals[page];
      for (const access of ['readUint32', 'writeUint32Atomic']) {
        const original = block[access].bind(block);
        block[access] = (...operands) => {
          if (this.resets.reset & (1 << bit)) this.violation(`${block.name}: ${access} in reset`);
          return original(...operands);
        };
      }
    }
  }

  makeMemoryReal() {
    const { mcu } = this;
    for (const store of ['writeUint8', 'writeUint16', 'writeUint32']) {
      const original = mcu[store].bind(mcu);
      mcu[store] = (address, value) => {
        if (address >>> 0 < RAM && address >>> 24 !== 0x18) {
          this.violation(`store to 0x${(address >>> 0).toString(16)}`);
        }
        original(address, value);
      };
    }
  }

  // rp2040js latches an edge at every call, also where the level stays.
  makePinsReal() {
    for (const pin of this.mcu.gpio) {
      const set = pin.setInputValue.bind(pin);
      pin.setInputValue = (level) => { if (level !== pin.rawInputValue) set(level); };
      pin.refreshInput = () => {};
    }
  }

  // From reset the ring oscillator runs the processor, clk_peri stands, and the timer has no tick.
  makeClocksReal() {
    const { mcu } = this;
    mcu.clkSys = mcu.roscFreq;
    const watchdog = mcu.peripherals[0x40058];
    watchdog.tickEnable = false;
    watchdog.onWatchdogTrigger = () => { // the chip would restart; here its run ends
      this.watchdogBites++;
      watchdog.alarm.enable = false;
    };
    const timer = mcu.peripherals[0x40054];
    const read = timer.readUint32.bind(timer);
    timer.readUint32 = (offset) => {
      if (!watchdog.tickEnable) this.violation('TIMER: read without a tick');
      return read(offset);
    };
  }

  // What the boot ROM does with a good image.
  boot() {
    const { flash, flashView, sram, core } = this.mcu;
    const boot2 = flash.subarray(0, 252);
    if (boot2Checksum(boot2) !== flashView.getUint32(252, true)) {
      this.violation('the boot ROM refuses the second stage: wrong checksum');
    }
    sram.set(boot2, BOOT2_AT - RAM);
    core.SP = 0x20042000;
    core.LR = 0;
    core.PC = BOOT2_AT;
  }

  get now_us() { return this.mcu.clock.nanos / 1000; }
  at(time_us, action) {
    this.mcu.clock.createAlarm(action).schedule(Math.max(0, (time_us - this.now_us) * 1000));
  }

  // Runs until a time, or until stop() says so.
  run(until_us, stop = () => false) {
    const { mcu } = this;
    const { core, clock } = mcu;
    const until = until_us * 1000;
    const thread_stack = this.symbols.get('stack_top').address;
    while (clock.nanos < until && !stop()) {
      if (core.waiting) {
        if (core.pendingInterrupts & core.enabledInterrupts) {
          core.waiting = false;
          core.interruptsUpdated = true;
          continue;
        }
        if (!clock.nextAlarm) this.violation('WFI, and nothing will ever wake it');
        clock.tick(Math.min(clock.nanosToNextAlarm, until - clock.nanos));
        continue;
      }
      this.beforeInstruction?.(core.PC & ~1);
      const cycles = core.executeInstruction();
      this.instructions++;
      clock.tick(cycles * 1e9 / mcu.clkSys);
      const sp = core.registers[13];
      if (sp < this.lowestStack && sp <= thread_stack) this.lowestStack = sp;
      if ((core.registers[15] & ~1) === this.fault) this.violation('the firmware ended in fault()');
    }
  }
  get stackUsed() { return this.symbols.get('stack_top').address - this.lowestStack; }
}

export const crc32 = (bytes) => zlib.crc32(bytes);
