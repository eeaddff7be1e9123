import assert from 'node:assert/strict';
import { once } from 'node:events';
import test from 'node:test';
import { Worker, isMainThread, parentPort, workerData } from 'node:worker_threads';
import { createHash } from 'node:crypto';
import { rates, statuses } from './frames.mjs';
import { LEARNING, drive, driveText, replayed } from './rig.mjs';

const DURATION_S = 600, SEED = 1;

// The bytes of whole rate frames (122 with stuffing) among all that was sent.
function rateFrames(sent) {
  const line = Buffer.from(sent);
  const pieces = [];
  for (let start = 0, end = line.indexOf(0); end >= 0; start = end + 1, end = line.indexOf(0, start)) {
    if (end + 1 - start === 122) pieces.push(line.subarray(start, end + 1));
  }
  return Buffer.concat(pieces);
}

// The scenario as the node saw it, and what it did not see: an erasure of the flash, before a record is written at the end
// of a stop, takes 45 ms. Of the samples of that time the newest is read afterwards, and has the stamp of the reading.
function seen(text, stamps_us) {
  const stamps = new Set(stamps_us);
  const events = text.toString('latin1').trimEnd().split('\n').map((line) => line.split(' '));
  const times = new Set(events.filter(([kind]) => kind === 's').map(([, time]) => Number(time)));
  const late = stamps_us.filter((stamp) => !times.has(stamp));
  let read_late = 0, lost = 0;
  const kept = events.filter((event, i) => {
    if (event[0] === 'p' || stamps.has(Number(event[1]))) return true;
    const isNewest = read_late < late.length && !(Number(events[i + 1]?.[1]) < late[read_late]);
    if (isNewest) event[1] = String(late[read_late++]);
    else lost++;
    return isNewest;
  });
  return { text: kept.map((event) => event.join(' ')).join('\n') + '\n', read_late, lost };
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
    assert.equal(first.read_late, first.erasures);
    assert.ok(first.lost <= 4 * first.erasures, `${first.lost} samples lost by ${first.erasures} erasures`);
    assert.ok(first.erasures <= DURATION_S / 60, `${first.erasures} erasures`);
    assert.ok(first.stops >= 5, `${first.stops} stops`);
    assert.ok(first.fastestHz > 350, `${first.fastestHz} Hz`);
    const { pulses_lost, read_errors, frames_dropped, starts } = first.status;
    assert.deepEqual([pulses_lost, read_errors, frames_dropped, starts], [0, 0, 0, 1]);
    for (const run of runs) assert.deepEqual(run, first);
    console.log(first);
  });
} else {
  const { rig, events } = drive(DURATION_S, SEED, workerData);
  const stamps_us = rates(rig.frames).map((frame) => Number(frame.time_ns / 1000n));
  const { text, read_late, lost } = seen(driveText(DURATION_S, SEED), stamps_us);
  const sent = rateFrames(rig.board.uart.sent);
  const pulses = events.filter((event) => event.isPulse).map((event) => event.time_us);
  const gaps = pulses.slice(1).map((time, i) => time - pulses[i]);
  parentPort.postMessage({
    isReplay: sent.equals(replayed(text, workerData.name)),
    erasures: rig.board.flash.erasures,
    read_late,
    lost,
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
