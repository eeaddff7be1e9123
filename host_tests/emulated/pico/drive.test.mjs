import assert from 'node:assert/strict';
import test from 'node:test';
import { rates, statuses } from './frames.mjs';
import { LEARNING, drive } from './rig.mjs';

const DURATION_S = 40, SEED = 3;
const frameBytes = (rig) => Buffer.concat(rates(rig.frames).map((message) => message.frame));
const pulsesOf = (events) => events.filter((event) => event.isPulse).length;

for (const name of [undefined, LEARNING]) test(`what ${name ?? 'the Pico'} sends over a drive is the replay of the drive, bit for bit`, () => {
  const { rig, events, expected } = drive(DURATION_S, SEED, { name });
  assert.ok(pulsesOf(events) > 1000, 'the vehicle drives');
  const messages = rates(rig.frames);
  assert.deepEqual(new Set(messages.map((message) => message.motion)),
    new Set(['moving', 'settling', 'still']));
  // Status reports stand between the rate frames: take each of the others as it left the pin.
  const line = Buffer.from(rig.board.uart.sent);
  const sent = [];
  for (let start = 0, end = line.indexOf(0); end >= 0; start = end + 1, end = line.indexOf(0, start)) {
    if (end + 1 - start === 122) sent.push(line.subarray(start, end + 1));
  }
  assert.ok(Buffer.concat(sent).equals(expected), 'the bytes differ from those of the replay');
  assert.ok(rig.board.flash.pages > 0, 'the state is saved on the way');
  const status = statuses(rig.frames).at(-1);
  assert.equal(status.pulses_lost + status.read_errors + status.frames_dropped, 0);
  assert.equal(rig.board.uart.overflowed, 0);
});

test('two more runs give the same bytes after the same number of instructions', () => {
  const [first, second] = [drive(DURATION_S, SEED), drive(DURATION_S, SEED)];
  assert.ok(frameBytes(first.rig).equals(frameBytes(second.rig)));
  assert.equal(first.rig.board.instructions, second.rig.board.instructions);
  assert.ok(Buffer.from(first.rig.board.uart.sent).equals(Buffer.from(second.rig.board.uart.sent)));
});
