// The flash of a Pico (Winbond W25Q16JV) behind its serial interface (RP2040 datasheet, 4.10), down to
// the byte: what is erased or programmed changes step by step, so that a test can cut the power at any.

import { BasePeripheral } from 'rp2040js';

const PAGE = 256, SECTOR = 4096;
const PROGRAM_US = 700, ERASE_US = 45_000;
const STATE_AT = 0x1fe000;
const FIFO_ENTRIES = 16;
const NOTHING = new Uint8Array(16 << 20).fill(0xde); // undefined as an instruction
const EIGHT_BITS = 7 << 16, MAPPED = (31 << 16) | 0x300;

// 2.19.6.2: of the pins of the flash only chip select, driven by its override.
class IoQspi extends BasePeripheral {
  constructor(mcu, onSelect) {
    super(mcu, 'IO_QSPI');
    this.onSelect = onSelect;
  }
  writeUint32(offset, value) {
    if (offset !== 0x0c) return super.writeUint32(offset, value);
    this.onSelect((value >> 8 & 3) === 2);
  }
}

class Ssi extends BasePeripheral {
  constructor(board, flash) {
    super(board.mcu, 'SSI');
    Object.assign(this, { board, flash, received: [], readyAt: 0 });
    this.registers = new Map([[0x00, 0], [0x04, 0], [0x08, 0], [0x10, 1], [0x14, 0], [0xf4, 0x03000218]]);
  }
  get isEnabled() { return this.registers.get(0x08) === 1; }
  get isMapped() { return this.isEnabled && this.registers.get(0x00) === MAPPED; }

  readUint32(offset) {
    const now = this.board.mcu.clock.nanos;
    if (offset === 0x28) return now < this.readyAt ? 0x07 : 0x06 | (this.received.length > 0 ? 0x08 : 0);
    if (offset === 0x60) {
      if (now < this.readyAt || this.received.length === 0) this.board.violation('SSI: read while nothing is there');
      return this.received.shift();
    }
    return this.registers.get(offset) ?? super.readUint32(offset);
  }
  writeUint32(offset, value) {
    if (offset === 0x60) return this.transfer(value & 0xff);
    if (!this.registers.has(offset)) return super.writeUint32(offset, value);
    if (offset !== 0x08 && offset !== 0x10 && this.isEnabled) this.board.violation('SSI: set up while enabled');
    if (offset === 0x08 && value === 0) this.received = [];
    this.registers.set(offset, value);
    this.flash.setMapped(this.isMapped);
  }
  transfer(byte) {
    const { mcu } = this.board;
    if (!this.isEnabled || this.registers.get(0x00) !== EIGHT_BITS) this.board.violation('SSI: not ready for bytes');
    if (this.received.length === FIFO_ENTRIES) this.board.violation('SSI: FIFO overflowed');
    this.received.push(this.flash.exchange(byte));
    this.readyAt = mcu.clock.nanos + 8e9 * this.registers.get(0x14) / mcu.clkSys;
  }
}

export class Flash {
  constructor(board) {
    this.board = board;
    const { mcu } = board;
    this.ssi = new Ssi(board, this);
    mcu.peripherals[0x18000] = this.ssi;
    mcu.peripherals[0x40018] = new IoQspi(mcu, (selected) => this.select(selected));
    this.bytes = mcu.flash;
    this.isWriteEnabled = this.isSelected = false;
    this.busyUntil = 0;
    this.command = [];
    this.erasures = this.pages = 0;
    this.onStep = () => {}; // after each byte programmed, and in the middle and at the end of an erasure
  }

  // The sectors in which the firmware keeps its state.
  get state() { return this.bytes.slice(STATE_AT, STATE_AT + 2 * SECTOR); }
  set state(bytes) { this.bytes.set(bytes, STATE_AT); }

  // While the flash takes commands it is no memory: whoever fetches from it finds nothing that runs.
  setMapped(isMapped) {
    const { mcu } = this.board;
    if (isMapped === (mcu.flash === this.bytes)) return;
    if (isMapped && this.isBusy) this.board.violation('flash: mapped while busy');
    mcu.flash = isMapped ? this.bytes : NOTHING;
    mcu.flashView = new DataView(mcu.flash.buffer, mcu.flash.byteOffset);
  }
  get isBusy() { return this.board.mcu.clock.nanos < this.busyUntil; }

  exchange(byte) {
    if (!this.isSelected) this.board.violation('flash: not selected');
    this.command.push(byte);
    const [code] = this.command;
    if (this.isBusy && code !== 0x05) this.board.violation(`flash: command ${code} while busy`);
    return code === 0x05 ? Number(this.isBusy) | this.isWriteEnabled << 1 : 0xff;
  }
  select(selected) {
    if (selected === this.isSelected) return;
    this.isSelected = selected;
    if (selected) this.command = [];
    else this.obey(...this.command);
  }
  obey(code, high, middle, low, ...data) {
    const at = high << 16 | middle << 8 | low;
    if (code === 0x06) this.isWriteEnabled = true;
    else if (code === 0x20) this.write(ERASE_US, () => this.eraseSector(at & -SECTOR));
    else if (code === 0x02) this.write(PROGRAM_US, () => this.programPage(at, data));
    else if (code !== 0x05) this.board.violation(`flash: command ${code}`);
  }
  write(duration_us, action) {
    if (!this.isWriteEnabled) this.board.violation('flash: not write enabled');
    this.isWriteEnabled = false;
    this.busyUntil = this.board.mcu.clock.nanos + duration_us * 1000;
    action();
  }
  eraseSector(at) {
    this.erasures++;
    for (let i = 0; i < SECTOR; i++) this.bytes[at + i] |= (i * 37) & 0xff; // somewhere on the way
    this.onStep();
    this.bytes.fill(0xff, at, at + SECTOR);
    this.onStep();
  }
  programPage(at, data) {
    this.pages++;
    if (data.length > PAGE) this.board.violation('flash: more than a page');
    data.forEach((byte, i) => {
      this.bytes[(at & -PAGE) | (at + i & PAGE - 1)] &= byte;
      this.onStep();
    });
  }
}
