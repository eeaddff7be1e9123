import assert from 'node:assert/strict';
import fs from 'node:fs';
import test from 'node:test';
import { Board } from './board.mjs';
import { rates, statuses } from './frames.mjs';
import { Rig, image } from './rig.mjs';

for (const [name, bus] of [['zerorate-pico', 'spi'], ['zerorate-pico-i2c', 'i2c']]) {
  test(`${name}.uf2 boots through boot2 and publishes what its gyro measures`, () => {
    const rig = new Rig({ name, bus });
    rig.measureForEver([100, -200, 300]);
    rig.board.run(4e6);
    const messages = rates(rig.frames);
    // 3.8 s of conversions every 9.6 ms.
    assert.ok(messages.length >= 390 && messages.length <= 397, `${messages.length} messages`);
    messages.forEach((message, i) => assert.equal(message.number, i));
    const last = messages.at(-1);
    assert.equal(last.motion, 'still');
    assert.equal(last.health, 1, 'calibrated, and nothing else');
    last.axes.forEach((axis, i) => {
      const measured = [100, -200, 300][i] * 0.00875 * Math.PI / 180;
      assert.ok(Math.abs(axis.measured - measured) < 1e-6 * Math.abs(measured));
      assert.equal(axis.bias, axis.measured);
      assert.equal(axis.corrected, 0);
    });
    const status = statuses(rig.frames).at(-1);
    assert.equal(status.starts, 1);
    assert.equal(status.start_errors + status.read_errors + status.frames_dropped, 0);
    assert.equal(rig.board.uart.overflowed, 0);
    assert.equal(rig.board.watchdogBites, 0);
  });
}

for (const [name, bus, error] of [
  ['zerorate-pico-icm42688', 'spi', { code: 1, reg: 0x75 }],
  ['zerorate-pico-icm42688-i2c', 'i2c', { code: 0, bus: 0 }],
  ['zerorate-pico-bmi088', 'spi', { code: 1, reg: 0x00 }],
  ['zerorate-pico-bmi088-i2c', 'i2c', { code: 0, bus: 0 }],
  ['zerorate-pico-bmi160', 'spi', { code: 1, reg: 0x00 }],
  ['zerorate-pico-icm20948', 'spi', { code: 1, reg: 0x00 }],
  ['zerorate-pico-icm20948-i2c', 'i2c', { code: 0, bus: 0 }],
  ['zerorate-pico-icm45686', 'spi', { code: 1, reg: 0x72 }],
  ['zerorate-pico-icm45686-i2c', 'i2c', { code: 0, bus: 0 }],
  ['zerorate-pico-adxrs453', 'spi', {}],
  ['zerorate-pico-mpu6500', 'spi', { code: 1, reg: 0x75 }],
  ['zerorate-pico-adis16470', 'spi', { code: 1, reg: 0x72 }],
  ['zerorate-pico-mpu6050-i2c', 'i2c', { code: 0, bus: 0 }],
]) {
  test(`${name}.uf2 boots, finds another chip than its own, and says so`, () => {
    const rig = new Rig({ name, bus });
    rig.measureForEver([100, -200, 300]);
    rig.board.run(2.2e6);
    const status = statuses(rig.frames).at(-1);
    assert.equal(status.starts, 0);
    assert.ok(status.start_errors > 3, `${status.start_errors}`);
    for (const [key, value] of Object.entries(error)) assert.equal(status.last_error[key], value, key);
    const messages = rates(rig.frames);
    assert.ok(messages.length >= 8 && messages.every(({ health }) => health === 64), 'sensor fault');
    assert.equal(rig.board.watchdogBites, 0);
  });
}

/// Verifies SR-TIME-07.
test('every message leaves within a sample period of its sample', () => {
  const rig = new Rig();
  rig.measureForEver([1, 2, 3]);
  let worst_us = 0, count = 0;
  rig.board.onByteSent = () => {
    if (rig.board.uart.sent.at(-1) !== 0) return;
    const last = rates(rig.frames).at(-1);
    if (!last || last.number < count) return;
    count = last.number + 1;
    worst_us = Math.max(worst_us, rig.board.now_us - Number(last.time_ns) / 1000);
  };
  rig.board.run(1.2e6);
  assert.ok(count > 90);
  assert.ok(worst_us < 9600, `${worst_us} us`);
});

test('typing t gives lines for people, typing b frames again', () => {
  const rig = new Rig();
  rig.measureForEver([100, -200, 300]);
  rig.board.run(4e6);  // calibrated
  rig.board.uart.sent.length = 0;
  rig.board.uart.receive('t'.charCodeAt(0));
  rig.board.run(5e6);
  const lines = Buffer.from(rig.board.uart.sent).toString('latin1').split('\r\n').slice(2, -1);
  assert.ok(lines.length > 80, `${lines.length} lines`);
  for (const line of lines) {
    assert.match(line, /^ +\d+\.\d{3} s {2}still {3}( [+-] {3}0\.00000){3} deg\/s$/);
  }
  rig.board.uart.sent.length = 0;
  rig.board.uart.receive('b'.charCodeAt(0));
  rig.board.run(5.5e6);
  assert.ok(rates(rig.frames).length > 40);
});

test('an image whose second boot stage has one wrong bit is refused', () => {
  const copy = `${image()}-spoilt-${process.pid}`;
  fs.copyFileSync(`${image()}.elf`, `${copy}.elf`);
  const uf2 = fs.readFileSync(`${image()}.uf2`);
  uf2[32 + 17] ^= 1;
  fs.writeFileSync(`${copy}.uf2`, uf2);
  try {
    assert.throws(() => new Board(copy), /wrong checksum/);
  } finally {
    for (const end of ['elf', 'uf2']) fs.rmSync(`${copy}.${end}`);
  }
});
