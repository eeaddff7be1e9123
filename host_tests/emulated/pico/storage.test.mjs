// What the node learnt outlives its power, wherever the power is cut.

import assert from 'node:assert/strict';
import test from 'node:test';
import { rates, statuses } from './frames.mjs';
import { Rig } from './rig.mjs';

const RAD_PER_LSB = 0.00875 * Math.PI / 180;
const TURN_ON_RAD_S = 0.1 * Math.PI / 180;
const RECORD_PAGES = 2, PAGE = 256;

// Four seconds of standstill, then the vehicle drives off. The state of the flash after every step of
// the save that follows, and what the node knew.
function learnAndDriveOff(raw, state) {
  const rig = new Rig({ state });
  const steps = [];
  rig.board.flash.onStep = () => steps.push(rig.board.flash.state);
  rig.measureForEver([raw, raw, raw]);
  for (let i = 0; i < 20; i++) rig.board.at(4.2e6 + 4000 * i, () => rig.pulse());
  rig.board.run(5.5e6);  // the samples of a second finish what the stop taught
  const { bias } = rates(rig.frames).at(-1).axes[1];
  assert.ok(Math.abs(bias - raw * RAD_PER_LSB) < TURN_ON_RAD_S);
  return { rig, steps, state: rig.board.flash.state, bias };
}
// The first message of a node whose gyro does not measure yet: what it knows from before.
function firstMessage(state) {
  const rig = new Rig({ state });
  const steps = [];
  rig.board.flash.onStep = () => steps.push(rig.board.flash.state);
  rig.board.run(0.33e6); // an erasure takes 45 ms
  return { message: rates(rig.frames)[0], steps };
}
const knows = ({ message }, bias) =>
  (message.health & 1) === 1 && Math.abs(message.axes[1].bias - bias) < 0.02 * TURN_ON_RAD_S;

test('a node that starts for the first time knows nothing', () => {
  assert.equal(firstMessage().message.health & 1, 0);
});

test('the end of a stop is saved; the next start goes on with it, less certain by the turn-on', () => {
  const first = learnAndDriveOff(100);
  assert.equal(first.steps.length, RECORD_PAGES * PAGE, 'two pages, and nothing to erase');
  const known = firstMessage(first.state);
  assert.ok(knows(known, first.bias));
  const { sigma } = known.message.axes[1];
  assert.ok(sigma > TURN_ON_RAD_S && sigma < 1.1 * TURN_ON_RAD_S, `${sigma}`);
  const after = rates(first.rig.frames).filter(
    ({ time_ns }) => time_ns > 4.25e9 && time_ns < 4.5e9);
  assert.ok(after.length > 20 && after.every(({ motion }) => motion === 'moving'));
  const status = statuses(first.rig.frames).at(-1);
  assert.deepEqual([status.pulses_lost, status.read_errors], [0, 0]);
});

/// Verifies SR-SNAP-09.
test('a power cut at any step of a save leaves the state before it or the new one', () => {
  const first = learnAndDriveOff(100);
  const second = learnAndDriveOff(110, first.state);
  assert.equal(second.steps.length, RECORD_PAGES * PAGE);
  let old = 0, renewed = 0;
  second.steps.forEach((state, i) => {
    const known = firstMessage(state);
    if (knows(known, first.bias)) old++;
    else if (knows(known, second.bias)) renewed++;
    else assert.fail(`after step ${i} both are lost`);
  });
  assert.ok(old > 0 && renewed > 0, `${old} old, ${renewed} new`);
});

test('a power cut while a sector is erased costs nothing, and the sectors are used in turn', () => {
  let last = learnAndDriveOff(100);
  const erasures = [];
  for (let save = 1; save < 9; save++) {
    const before = last;
    last = learnAndDriveOff(100 + save, before.state);
    if (last.rig.board.flash.erasures === 0) continue;
    erasures.push(save);
    // Erased at the start, before there is anything to miss: the first two steps.
    for (const state of last.steps.slice(0, 2)) assert.ok(knows(firstMessage(state), before.bias));
  }
  assert.deepEqual(erasures, [8], 'eight records fit in');
  assert.ok(knows(firstMessage(last.state), last.bias));
});
