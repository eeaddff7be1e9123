// A board with its gyro, and scenarios that happen to both.

import { spawnSync } from 'node:child_process';
import path from 'node:path';
import { Board } from './board.mjs';
import { framesIn } from './frames.mjs';
import { Lsm6dso, SimulatedChip } from './gyros.mjs';
import { I2cPort, SpiPort, framesOnSpi, registersOnSpi, wordsOnSpi } from './ports.mjs';

const SMALL = 'zerorate-pico';
export const LEARNING = 'zerorate-pico-learning';
export const image = (name = SMALL) => path.join(process.env.PICO_IMAGES, name);
const ODOMETER_PIN = 15;
const PULSE_US = 50;

// bus: 'spi', 'i2c', or 'frames' or 'words' on SPI; chip: of hal/sim by its name, or the LSM6DSO of this folder
export class Rig {
  constructor({ name = SMALL, bus = 'spi', identity, state, chip } = {}) {
    this.board = new Board(image(name), state);
    this.chip = chip ? new SimulatedChip(this.board, chip) : new Lsm6dso(this.board, { identity });
    if (bus === 'i2c') this.port = new I2cPort(this.board, this.chip, { address: chip ? 0x68 : 0x6a });
    else this.port = new SpiPort(this.board, { spi: registersOnSpi, frames: framesOnSpi, words: wordsOnSpi }[bus](this.chip));
  }
  get frames() { return framesIn(this.board.uart.sent); }

  pulse() {
    const pin = this.board.mcu.gpio[ODOMETER_PIN];
    pin.setInputValue(true);
    this.board.at(this.board.now_us + PULSE_US, () => pin.setInputValue(false));
  }
  // Conversions of the same numbers at a constant rate, for ever.
  measureForEver(rates, { from_us = 200_000, period_us = 9600, temperature = 0 } = {}) {
    let time = from_us;
    const next = () => {
      this.chip.measure(rates, temperature);
      time += period_us;
      this.board.at(time, next);
    };
    this.board.at(time, next);
  }
  // Schedules one event after the other: a list of a hundred thousand would slow the emulator down.
  play(events, onSample = () => {}) {
    let index = 0;
    const next = () => {
      const event = events[index++];
      if (event.isPulse) this.pulse();
      else {
        onSample(this.board);
        this.chip.measure(event.rates, event.temperature);
      }
      if (index < events.length) this.board.at(events[index].time_us, next);
    };
    this.board.at(events[0].time_us, next);
  }
}

function run(program, input, ...operands) {
  const done = spawnSync(program, operands, { input, maxBuffer: 1 << 30 });
  if (done.status !== 0) throw new Error(`${program} ${operands}: ${done.stderr}`);
  return done.stdout;
}
export const driveText = (duration_s, seed) =>
  run(process.env.PICO_SCENARIO, '', 'drive', String(duration_s), String(seed));
// With the model of the image.
export const replayed = (text, name = SMALL) =>
  run(name === LEARNING ? process.env.PICO_SCENARIO_LEARNING : process.env.PICO_SCENARIO, text, 'replay');

export function parseScenario(text) {
  return text.toString('latin1').trimEnd().split('\n').map((line) => {
    const [kind, time, x, y, z, temperature] = line.split(' ');
    return { isPulse: kind === 'p', time_us: Number(time),
      rates: [x, y, z].map(Number), temperature: Number(temperature) };
  });
}

// Runs a drive on a new board. Gives what a test compares: rate frames, their replay, and figures.
export function drive(duration_s, seed, options = {}) {
  const text = driveText(duration_s, seed);
  const events = parseScenario(text);
  const rig = new Rig(options);
  rig.play(events, options.onSample);
  rig.board.run(events.at(-1).time_us + 100_000);
  return { rig, events, expected: replayed(text, options.name) };
}
