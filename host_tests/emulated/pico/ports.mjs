// The two ports of a gyro, which look at how the firmware uses the pins.

import { I2CMode } from 'rp2040js';
import { GPIOPinState } from './board.mjs';

// What a transaction's bytes mean to a chip of registers: the address with bit 7 set to read, then data.
export function registersOnSpi(chip) {
  let address = -1, isRead = false;
  return {
    select() { address = -1; },
    exchange(byte) {
      if (address < 0) {
        address = byte & 0x7f;
        isRead = (byte & 0x80) !== 0;
        return 0xff;
      }
      const value = isRead ? chip.read(address) : chip.write(address, byte);
      address = chip.next(address);
      return value ?? 0xff;
    },
  };
}

// And to a chip of 32-bit frames: the reply is on the wire before the command is known.
export function framesOnSpi(chip) {
  let command = 0, reply = 0, count = 0;
  return {
    select() { command = count = 0; },
    exchange(byte) {
      if (count === 0) reply = chip.reply();
      command = (command << 8 | byte) >>> 0;
      const value = reply >>> 24 - 8 * count & 0xff;
      if (++count === 4) chip.exchangeFrame(command);
      return count > 4 ? 0xff : value;
    },
  };
}

// To a chip of 16-bit words too; several follow each other under one selection.
export function wordsOnSpi(chip) {
  let word = 0, reply = 0, isSecond = false;
  return {
    highest_hz: 1e6,
    pause_us: 16,
    select() {
      isSecond = false;
      chip.select();
    },
    exchange(byte) {
      if (!isSecond) reply = chip.reply();
      word = (word << 8 | byte) & 0xffff;
      if (isSecond) chip.exchangeFrame(word);
      isSecond = !isSecond;
      return isSecond ? reply >>> 8 : reply & 0xff;
    },
  };
}

// SPI 0 of the chip at these pins. faults.isStalled: no clock comes any more.
export class SpiPort {
  constructor(board, device, { miso = 16, select = 17, clock = 18, mosi = 19 } = {}) {
    const { mcu } = board;
    const spi = mcu.spi[0];
    const { highest_hz = 10e6, pause_us = 0 } = device;
    this.isStalled = false;
    let isSelected = false, released_us = -Infinity;
    mcu.gpio[select].addListener((state) => {
      if (isSelected) released_us = board.now_us;
      isSelected = state === GPIOPinState.Low;
      if (!isSelected) return;
      if (board.now_us - released_us < pause_us) board.violation(`SPI0: selected again within ${pause_us} us`);
      device.select();
    });
    const check = () => {
      if (!spi.enabled) board.violation('SPI0: data written while disabled');
      if (!(mcu.clocks.periFreq > 0)) board.violation('SPI0: clk_peri does not run');
      for (const pin of [miso, clock, mosi]) {
        if (mcu.gpio[pin].functionSelect !== 1) board.violation(`SPI0: GPIO${pin} is not connected`);
      }
      if (!mcu.gpio[miso].inputEnable) board.violation('SPI0: the input of MISO is off');
      if (spi.dataBits !== 8) board.violation('SPI0: not 8 bits');
      if (spi.clockFrequency > highest_hz) board.violation(`SPI0: faster than ${highest_hz} Hz`);
      const polarity = !!(spi.control0 & 0x40), phase = !!(spi.control0 & 0x80);
      if (polarity !== phase) board.violation('SPI0: the chip has mode 0 and 3 only');
    };
    let answer = 0xff;
    const done = mcu.clock.createAlarm(() => spi.completeTransmit(answer));
    spi.onTransmit = (byte) => {
      check();
      answer = isSelected ? device.exchange(byte) : 0xff;
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
    const ENABLE = 0x6c;
    const write = i2c.writeUint32.bind(i2c);
    i2c.writeUint32 = (offset, value) => {
      if (offset === ENABLE && value === 0 && this.isWaiting) { // it gives its START up, and empties its FIFOs
        this.isWaiting = i2c.busy = false;
        i2c.state = 0;
        i2c.txFIFO.reset();
        i2c.rxFIFO.reset();
      }
      if (offset !== SDA_HOLD) write(offset, value);
    };
    this.clocksUntilLetGo = 0;
    this.isWaiting = false; // for the data line, which must be high for a START
    this.dataPin = mcu.gpio[data];
    for (const pin of [data, clock]) mcu.gpio[pin].setInputValue(true);
    mcu.gpio[clock].addListener((state, before) => {
      if (before !== GPIOPinState.Low || state === GPIOPinState.Low || this.clocksUntilLetGo === 0) return;
      if (--this.clocksUntilLetGo === 0) this.dataPin.setInputValue(true);
    });
    let register = 0, isFirst = true;
    const after = (bits, action) => mcu.clock.createAlarm(action).schedule(bits * BIT_NS);
    i2c.onStart = () => {
      this.isWaiting = this.clocksUntilLetGo > 0;
      if (this.isWaiting) return;
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
  // The chip was cut off while it sent: it holds the data line low, until so many clocks have come.
  holdData(clocks) {
    this.clocksUntilLetGo = clocks;
    this.dataPin.setInputValue(false);
  }
}
