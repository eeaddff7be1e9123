// The images for the other gyros, each with its own chip of hal/sim on the emulated pins; with PICO_RELATIVES those for the
// relatives by table of these chips.

import assert from 'node:assert/strict';
import test from 'node:test';
import { rates, statuses } from './frames.mjs';
import { Rig } from './rig.mjs';

const RAD = Math.PI / 180;
const CALIBRATED = 1, INCONSISTENT = 16;
const MEASURED_DPS = [0.7, -1.3, 2.1];

// Of the data sheets: period, LSB, and a register whose bits set full scale or rate.
const CHIPS = [
  { name: 'icm42688', bus: 'spi', period_us: 10_000, lsb_dps: 1 / 131.072, upset: [0x4f, 0x20] },
  { name: 'icm42688', bus: 'i2c', period_us: 10_000, lsb_dps: 1 / 131.072, upset: [0x4f, 0x20] },
  { name: 'bmi088', bus: 'spi', period_us: 10_000, lsb_dps: 1 / 131.072, upset: [0x0f, 0x01] },
  { name: 'bmi088', bus: 'i2c', period_us: 10_000, lsb_dps: 1 / 131.072, upset: [0x0f, 0x01] },
  { name: 'mpu6500', bus: 'spi', period_us: 10_000, lsb_dps: 1 / 131, upset: [0x1b, 0x08] },
  { name: 'mpu6050', bus: 'i2c', period_us: 10_000, lsb_dps: 1 / 131, upset: [0x1b, 0x08] },
  { name: 'mpu6050', bus: 'i2c', period_us: 10_000, lsb_dps: 1 / 131, option: '-no-odometer' },
  { name: 'bmi160', bus: 'spi', period_us: 10_000, lsb_dps: 1 / 131.072, upset: [0x43, 0x01] },
  { name: 'icm20948', bus: 'spi', period_us: 8000, lsb_dps: 1 / 131.072, upset: [0x81, 0x02] },
  { name: 'icm20948', bus: 'i2c', period_us: 8000, lsb_dps: 1 / 131.072, upset: [0x81, 0x02] },
  { name: 'icm45686', bus: 'spi', period_us: 10_000, lsb_dps: 1 / 131.072, upset: [0x81, 0x02] },
  { name: 'icm45686', bus: 'i2c', period_us: 10_000, lsb_dps: 1 / 131.072, upset: [0x1c, 0x10] },
  { name: 'adxrs453', bus: 'frames', period_us: 5000, lsb_dps: 1 / 80, isOneAxis: true },
  { name: 'adis16470', bus: 'words', period_us: 10_000, lsb_dps: 1 / 10 },
  { name: 'l3gd20h', bus: 'spi', period_us: 10_000, lsb_dps: 0.00875, upset: [0x23, 0x10] },
];
const RELATIVES = [
  ...['lsm6dsl', 'lsm6ds3tr-c', 'lsm6dsox', 'lsm6dsr'].map(
    (name) => ({ name, bus: 'spi', period_us: 9600, lsb_dps: 0.00875, upset: [0x11, 0x04] })),
  ...['icm42605', 'iim42652'].map(
    (name) => ({ name, bus: 'spi', period_us: 10_000, lsb_dps: 1 / 131.072, upset: [0x4f, 0x20] })),
  ...['icm20602', 'icm20689', 'mpu6886'].map(
    (name) => ({ name, bus: 'spi', period_us: 10_000, lsb_dps: 1 / 131, upset: [0x1b, 0x08] })),
  ...[['l3gd20', 10_526], ['l3g4200d', 10_000]].map(
    ([name, period_us]) => ({ name, bus: 'spi', period_us, lsb_dps: 0.00875, upset: [0x23, 0x10] })),
  ...[['adis16475-1', 160], ['adis16475-2', 40], ['adis16475-3', 10]].map(
    ([name, lsbs]) => ({ name, bus: 'words', period_us: 10_000, lsb_dps: 1 / lsbs })),
];

function withRig({ name, bus, period_us, option = '' }, action) {
  const rig = new Rig({ name: `zerorate-pico-${name}${bus === 'i2c' ? '-i2c' : ''}${option}`, bus, chip: name });
  try {
    rig.measureForEver(MEASURED_DPS, { period_us, temperature: 31 });
    action(rig);
  } finally {
    rig.chip.close();
  }
}

for (const chip of process.env.PICO_RELATIVES ? RELATIVES : CHIPS) {
  const { name, bus, period_us, lsb_dps, isOneAxis = false, option = '' } = chip;

  test(`${name}${option} on ${bus}: what the chip measures is published, every sample once`, () => withRig(chip, (rig) => {
    rig.board.run(5e6);
    const messages = rates(rig.frames).filter(({ time_ns }) => time_ns > 1e9);
    assert.ok(Math.abs(messages.length - 4e6 / period_us) <= 2, `${messages.length} messages`);
    for (const [i, message] of messages.slice(1).entries()) {
      assert.equal(message.number, messages[i].number + 1);
      const passed_us = Number(message.time_ns - messages[i].time_ns) / 1000;
      assert.ok(Math.abs(passed_us - period_us) < 0.55 * period_us, `${passed_us} us between two samples`);
    }
    const last = messages.at(-1);
    assert.deepEqual([last.motion, last.health], ['still', CALIBRATED]);
    last.axes.forEach((axis, i) => {
      const given = MEASURED_DPS[isOneAxis ? 2 : i];
      assert.ok(Math.abs(axis.measured / RAD - given) <= 0.501 * lsb_dps, `axis ${i}: ${axis.measured / RAD} deg/s`);
      assert.equal(axis.corrected, 0);
    });
    const status = statuses(rig.frames).at(-1);
    assert.equal(status.starts, 1);
    assert.equal(status.start_errors + status.read_errors + status.frames_dropped + status.overruns, 0);
    assert.equal(rig.board.watchdogBites, 0);
  }));

  if (!chip.upset) continue;
  test(`${name} on ${bus}: settings that an upset changed are noticed and set again`, () => withRig(chip, (rig) => {
    rig.board.at(4e6, () => rig.chip.upset(...chip.upset));
    rig.board.run(9e6);
    const status = statuses(rig.frames).at(-1);
    assert.equal(status.configurations_lost, 1);
    assert.equal(status.starts, 2);
    const last = rates(rig.frames).at(-1);
    // Samples of the wrong scale may have come before, which no model of the bias expects.
    assert.equal(last.health & ~INCONSISTENT, CALIBRATED);
    assert.ok(Math.abs(last.axes[0].measured / RAD - MEASURED_DPS[0]) <= 0.501 * lsb_dps);
  }));
}

// The pin of the odometer is open in both: without one, the calm of the gyro tells driving from rest.
const OPTIONS = [{ option: '', moves: false }, { option: '-no-odometer', moves: true }];
for (const { option, moves } of process.env.PICO_RELATIVES ? [] : OPTIONS) {
  test(`mpu6050${option} that shakes straight on without a pulse ${moves ? 'moves' : 'does not move'}`, () => {
    const rig = new Rig({ name: `zerorate-pico-mpu6050-i2c${option}`, bus: 'i2c', chip: 'mpu6050' });
    try {
      const noise = (i) => (i < 1500 ? 0.05 : 4) * Math.sin(1.7 * i * i);
      rig.play(Array.from({ length: 1800 }, (_, i) => (
        { time_us: 200_000 + 10_000 * i, rates: MEASURED_DPS.map((dps) => dps + noise(i)), temperature: 31 })));
      rig.board.run(18e6);
      const last = rates(rig.frames).at(-1);
      assert.equal(last.motion === 'moving', moves);
      assert.ok(Math.abs(last.axes[2].bias / RAD - MEASURED_DPS[2]) < 0.1, `bias ${last.axes[2].bias / RAD} deg/s`);
    } finally {
      rig.chip.close();
    }
  });
}
