// A PL011 that takes its time. The one of rp2040js sends at once, is never full and interrupts
// whenever something is written. Arm DDI 0183, chapters 2 and 3; RP2040 datasheet, section 4.2.

const FIFO_BYTES = 32;
const TRANSMIT_INTERRUPT = 1 << 5;

export class Pl011 {
  constructor(board, interrupt) {
    Object.assign(this, { board, interrupt, name: 'UART0', rawWriteValue: 0 });
    this.registers = { ibrd: 0, fbrd: 0, lcr: 0, cr: 0x300, imsc: 0 };
    this.raw = 0;         // raw interrupt status
    this.fifo = [];       // bytes that wait; the first is being shifted out
    this.received = [];
    this.sent = [];       // every byte that left the pin
    this.overflowed = 0;  // bytes written to a full FIFO: lost
    this.slowdown = 1;    // a fault: the line is this much slower than its baud rate
    this.shifter = board.mcu.clock.createAlarm(() => this.byteSent());
  }

  get isEnabled() { return (this.registers.cr & 0x101) === 0x101; }
  get baudRate() {
    const { ibrd, fbrd } = this.registers;
    return this.board.mcu.clocks.periFreq / (16 * (ibrd + fbrd / 64));
  }
  // IFLS is left at its reset value: half full.
  get mark() { return FIFO_BYTES / 2; }

  transmit(byte) {
    const { board } = this;
    if (!this.isEnabled) board.violation('UART0: data written while disabled');
    if (!(board.mcu.clocks.periFreq > 0)) board.violation('UART0: clk_peri does not run');
    if (board.mcu.gpio[0].functionSelect !== 2) board.violation('UART0: GPIO0 is not connected');
    if ((this.registers.lcr & 0x70) !== 0x70) board.violation('UART0: not 8 bits with FIFOs');
    if (this.fifo.length > FIFO_BYTES) { // 32 and the shift register
      this.overflowed++;
      return;
    }
    this.fifo.push(byte);
    if (this.fifo.length > this.mark) this.setRaw(this.raw & ~TRANSMIT_INTERRUPT);
    if (this.fifo.length === 1) this.shiftNext();
  }
  shiftNext() { this.shifter.schedule(10e9 * this.slowdown / this.baudRate); }
  byteSent() {
    this.sent.push(this.fifo.shift());
    this.board.onByteSent?.();
    // The interrupt comes when the level falls through the mark, not while it is below.
    if (this.fifo.length === this.mark) this.setRaw(this.raw | TRANSMIT_INTERRUPT);
    if (this.fifo.length > 0) this.shiftNext();
  }
  receive(byte) { this.received.push(byte); }
  setRaw(raw) {
    this.raw = raw;
    this.board.mcu.setInterrupt(this.interrupt, (this.raw & this.registers.imsc) !== 0);
  }

  get flags() {
    return (this.fifo.length === 0 ? 0x80 : 0x08) | (this.fifo.length > FIFO_BYTES ? 0x20 : 0) |
           (this.received.length === 0 ? 0x10 : 0);
  }
  readUint32(offset) {
    switch (offset) {
      case 0x00: return this.received.shift() ?? 0;
      case 0x18: return this.flags;
      case 0x24: return this.registers.ibrd;
      case 0x28: return this.registers.fbrd;
      case 0x2c: return this.registers.lcr;
      case 0x30: return this.registers.cr;
      case 0x38: return this.registers.imsc;
      case 0x3c: return this.raw;
      case 0x40: return this.raw & this.registers.imsc;
    }
    this.board.violation(`UART0: read of register 0x${offset.toString(16)}`);
  }
  writeUint32(offset, value) {
    switch (offset) {
      case 0x00: return this.transmit(value & 0xff);
      case 0x24: this.registers.ibrd = value & 0xffff; return;
      case 0x28: this.registers.fbrd = value & 0x3f; return;
      case 0x2c: this.registers.lcr = value & 0xff; return;
      case 0x30: this.registers.cr = value; return;
      case 0x38: this.registers.imsc = value & 0x7ff; return this.setRaw(this.raw);
      case 0x44: return this.setRaw(this.raw & ~value);
    }
    this.board.violation(`UART0: write to register 0x${offset.toString(16)}`);
  }
  writeUint32Atomic(offset, value, kind) {
    const old = kind === 0 ? 0 : this.readUint32(offset);
    this.writeUint32(offset, [value, old ^ value, old | value, old & ~value][kind] >>> 0);
  }
  clkPeriChanged() {}
}
