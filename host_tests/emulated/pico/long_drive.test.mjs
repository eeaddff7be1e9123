import assert from 'node:assert/strict';
import { once } from 'node:events';
import test from 'node:test';
import { Worker, isMainThread, parentPort, workerData } from 'node:worker_threads';
import { createHash } from 'node:crypto';
import { statuses } from './frames.mjs';
import { LEARNING, drive } from './rig.mjs';

const DURATION_S = 600, SEED = 1;

// The bytes of whole rate frames (82 with stuffing) among all that was sent.
function rateFrames(sent) {
  const line = Buffer.from(sent);
  const pieces = [];
  for (let start = 0, end = line.indexOf(0); end >= 0; start = end + 1, end = line.indexOf(0, start)) {
    if (end + 1 - start === 82) pieces.push(line.subarray(start, end + 1));
  }
  return Buffer.concat(pieces);
}

if (isMainThread) {
  for (const name of [undefined, LEARNING]) test(`ten minutes of ${name ?? 'the Pico'} are the replay bit for bit, three times`, async () => {
    const runs = [];
    // Two at a time would be faster; the machine has other things to do.
    for (let i = 0; i < 3; i++) {
      const [run] = await once(new Worker(new URL(import.meta.url), { workerData: { name } }), 'message');
      runs.push(run);
    }
    const [first] = runs;
    assert.ok(first.isReplay, 'the bytes differ from those of the replay');
    assert.ok(first.stops >= 5, `${first.stops} stops`);
    assert.ok(first.fastestHz > 350, `${first.fastestHz} Hz`);
    const { pulses_lost, read_errors, frames_dropped, starts } = first.status;
    assert.deepEqual([pulses_lost, read_errors, frames_dropped, starts], [0, 0, 0, 1]);
    for (const run of runs) assert.deepEqual(run, first);
    console.log(first);
  });
} else {
  const { rig, events, expected } = drive(DURATION_S, SEED, workerData);
  const sent = rateFrames(rig.board.uart.sent);
  const pulses = events.filter((event) => event.isPulse).map((event) => event.time_us);
  const gaps = pulses.slice(1).map((time, i) => time - pulses[i]);
  parentPort.postMessage({
    isReplay: sent.equals(expected),
    bytes: sent.length,
    hash: createHash('sha256').update(Buffer.from(rig.board.uart.sent)).digest('hex'),
    instructions: rig.board.instructions,
    stackUsed: rig.board.stackUsed,
    stops: gaps.filter((gap) => gap > 2e6).length,
    pulses: pulses.length,
    fastestHz: 1e6 / Math.min(...gaps.slice(0, 100_000)),
    status: statuses(rig.frames).at(-1),
  });
}
