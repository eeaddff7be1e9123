// A harness that passes everything proves nothing: each of these images has one mistake that works in
// plain rp2040js, or nearly always on silicon, and must be noticed here.

import assert from 'node:assert/strict';
import test from 'node:test';
import { Violation } from './board.mjs';
import { rates } from './frames.mjs';
import { Rig } from './rig.mjs';

const WFI = 0xbf30;

// What is wrong with an image, as one word or one violation; nothing if all is well.
function complaintAbout(name) {
  try {
    const rig = new Rig({ name });
    rig.measureForEver([10, 20, 30]);
    rig.board.run(1e6);
    rig.board.run(3.0042e6); // a millisecond after a sample, whose message is being sent
    // The end of a stop, which is saved within a tick: a page each time that an edge wakes the main loop.
    while (rig.board.now_us < 3.8e6) {
      rig.pulse();
      rig.board.run(rig.board.now_us + 400);
    }
    rig.board.run(3.9e6);
    if (rig.board.uart.overflowed > 0) return 'UART0: FIFO overflowed';
    if (rates(rig.frames).length < 70) return 'too few messages';
    return latencyOfAnEdgeBeforeSleep(rig) > 1000 ? 'an edge was slept through' : undefined;
  } catch (error) {
    if (error instanceof Violation) return error.message;
    throw error;
  }
}

// From a data-ready edge that comes after the last look for work and before the processor sleeps.
function latencyOfAnEdgeBeforeSleep(rig) {
  const { board, chip } = rig;
  const { mcu } = board;
  chip.measure = () => {}; // no conversions but ours
  board.run(board.now_us + 15_000);
  let edge_us;
  board.beforeInstruction = (pc) => {
    if (edge_us !== undefined || mcu.readUint16(pc) !== WFI) return;
    edge_us = board.now_us;
    delete chip.measure;
    chip.measure([1, 2, 3], 0);
  };
  board.run(board.now_us + 30_000, () => edge_us !== undefined && !chip.pin.rawInputValue);
  return board.now_us - edge_us;
}

test('the image that is shipped gives no cause for complaint', () => {
  assert.equal(complaintAbout('zerorate-pico'), undefined);
});

for (const [name, complaint] of [
  ['no-reset-release', /in reset/],
  ['no-peripheral-clock', /clk_peri does not run/],
  ['no-timer-tick', /TIMER: read without a tick/],
  ['wrong-pin-mux', /SPI0: GPIO19 is not connected/],
  ['spi-not-enabled', /SPI0: data written while disabled/],
  ['no-fifo-wait', /UART0: FIFO overflowed/],
  ['lost-wake-up', /an edge was slept through/],
  ['flash-routine-in-flash', /undefined instruction/],
  ['interrupts-from-flash', /undefined instruction/],
  ['no-write-enable', /flash: not write enabled/],
]) {
  test(`the mutant ${name} is noticed`, () => {
    assert.match(complaintAbout(`mutant-${name}`) ?? 'nothing', complaint);
  });
}

test('the mutant no-spi-pause, on a chip that needs pauses, is noticed', () => {
  const rig = new Rig({ name: 'mutant-no-spi-pause', bus: 'words', chip: 'adis16470' });
  try {
    rig.measureForEver([10, 20, 30], { period_us: 10_000 });
    assert.throws(() => rig.board.run(1e6), /SPI0: selected again within 16 us/);
  } finally {
    rig.chip.close();
  }
});
