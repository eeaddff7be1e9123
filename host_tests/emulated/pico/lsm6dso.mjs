// The gyro of an LSM6DSO at the level of its registers (ST DS12140), fed with raw conversions; and
// its two ports, which look at how the firmware uses the pins.

import { I2CMode } from 'rp2040js';
import { GPIOPinState } from './board.mjs';

const INT1_CTRL = 0x0d, WHO_AM_I = 0x0f, CTRL2_G = 0x11, CTRL3_C = 0x12, CTRL9_XL = 0x18;
const STATUS_REG = 0x1e, OUT_TEMP_L = 0x20, OUTX_L_G = 0x22, OUTZ_H_G = 0x27;
const GDA = 0x02, TDA = 0x04, DRDY_G = 0x02, BDU = 0x40, IF_INC = 0x04, SW_RESET = 0x01;
const RESET_TIME_US = 50;

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

// SPI 0 of the chip at these pins. faults.isStalled: no clock comes any more.
export class SpiPort {
  constructor(board, chip, { miso = 16, select = 17, clock = 18, mosi = 19 } = {}) {
    const { mcu } = board;
    const spi = mcu.spi[0];
    this.isStalled = false;
    let isSelected = false, address = -1, isRead = false;
    mcu.gpio[select].addListener((state) => {
      isSelected = state === GPIOPinState.Low;
      address = -1;
    });
    const exchange = (byte) => {
      if (!isSelected) return 0xff;
      if (address < 0) {
        address = byte & 0x7f;
        isRead = (byte & 0x80) !== 0;
        return 0xff;
      }
      const at = address;
      address = chip.next(at);
      if (isRead) return chip.read(at);
      chip.write(at, byte);
      return 0xff;
    };
    const check = () => {
      if (!spi.enabled) board.violation('SPI0: data written while disabled');
      if (!(mcu.clocks.periFreq > 0)) board.violation('SPI0: clk_peri does not run');
      for (const pin of [miso, clock, mosi]) {
        if (mcu.gpio[pin].functionSelect !== 1) board.violation(`SPI0: GPIO${pin} is not connected`);
      }
      if (!mcu.gpio[miso].inputEnable) board.violation('SPI0: the input of MISO is off');
      if (spi.dataBits !== 8) board.violation('SPI0: not 8 bits');
      if (spi.clockFrequency > 10e6) board.violation('SPI0: faster than 10 MHz');
      const polarity = !!(spi.control0 & 0x40), phase = !!(spi.control0 & 0x80);
      if (polarity !== phase) board.violation('SPI0: the chip has mode 0 and 3 only');
    };
    let answer = 0xff;
    const done = mcu.clock.createAlarm(() => spi.completeTransmit(answer));
    spi.onTransmit = (byte) => {
      check();
      answer = exchange(byte);
      if (!this.isStalled) done.schedule(8e9 / spi.clockFrequency);
    };
  }
}

// I2C 0 with the chip as the only device.
export class I2cPort {
  constructor(board, chip, { address = 0x6a, data = 4, clock = 5 } = {}) {
    const { mcu } = board;
    const i2c = mcu.i2c[0];
    const BIT_NS = 1e9 / 400e3;
    const SDA_HOLD = 0x7c; // of no consequence here, and unknown to rp2040js
    const write = i2c.writeUint32.bind(i2c);
    i2c.writeUint32 = (offset, value) => { if (offset !== SDA_HOLD) write(offset, value); };
    let register = 0, isFirst = true;
    const after = (bits, action) => mcu.clock.createAlarm(action).schedule(bits * BIT_NS);
    i2c.onStart = () => {
      for (const pin of [data, clock]) {
        const gpio = mcu.gpio[pin];
        if (gpio.functionSelect !== 3) board.violation(`I2C0: GPIO${pin} is not connected`);
        if (!gpio.pullupEnabled) board.violation(`I2C0: GPIO${pin} has no pull-up`);
      }
      after(1, () => i2c.completeStart());
    };
    i2c.onConnect = (target, mode) => {
      if (mode === I2CMode.Write) isFirst = true;
      after(9, () => i2c.completeConnect(target === address));
    };
    i2c.onWriteByte = (byte) => {
      if (isFirst) {
        register = byte & 0x7f;
      } else {
        chip.write(register, byte);
        register = chip.next(register);
      }
      isFirst = false;
      after(9, () => i2c.completeWrite(true));
    };
    i2c.onReadByte = () => {
      const value = chip.read(register);
      register = chip.next(register);
      after(9, () => i2c.completeRead(value));
    };
    i2c.onStop = () => after(1, () => i2c.completeStop());
  }
}
