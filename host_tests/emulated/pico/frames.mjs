// What came out of the serial line, read by nothing but docs/reference/rate-frame.md.

import { crc32 } from './board.mjs';

const MOTIONS = ['moving', 'settling', 'still'];

function unstuff(piece) {
  const bytes = [];
  for (let at = 0; at < piece.length;) {
    const length = piece[at];
    if (length === 0 || at + length > piece.length) return undefined;
    bytes.push(...piece.slice(at + 1, at + length));
    at += length;
    if (length < 255 && at < piece.length) bytes.push(0);
  }
  return Buffer.from(bytes);
}

function parse(frame) {
  if (!frame || frame.length < 8) return { kind: 'damaged' };
  const end = frame.length - 4;
  if (crc32(frame.subarray(0, end)) !== frame.readUInt32LE(end)) return { kind: 'damaged' };
  const magic = frame.toString('latin1', 0, 2);
  if (magic === 'ZR' && frame.length === 120 && frame[2] === 5) {
    const axis = (at) => ({
      measured: frame.readFloatLE(at), corrected: frame.readFloatLE(at + 4),
      bias: frame.readFloatLE(at + 8), sigma: frame.readFloatLE(at + 12),
    });
    return {
      kind: 'rate', number: frame.readUInt32LE(4), time_ns: frame.readBigInt64LE(8),
      motion: MOTIONS[frame[16]], health: frame.readUInt16LE(17), axes: [axis(20), axis(36), axis(52)],
      turn: [76, 84, 92].map((at) => ({ angle: frame.readFloatLE(at), sigma: frame.readFloatLE(at + 4) })), frame,
    };
  }
  if (magic === 'ZS' && frame.length === 56) {
    const names = ['samples', 'pulses', 'pulses_lost', 'odometer_errors', 'starts', 'start_errors',
      'read_errors', 'overruns', 'configurations_lost', 'silences', 'frames_dropped'];
    const counters = Object.fromEntries(names.map((name, i) => [name, frame.readUInt32LE(4 + 4 * i)]));
    return { kind: 'status', ...counters, last_error: { code: frame[48], bus: frame[49], reg: frame[50] } };
  }
  return { kind: 'unknown' };
}

// Every frame between two zeros.
export function framesIn(bytes) {
  const line = Buffer.from(bytes);
  const frames = [];
  let start = 0;
  for (let at = line.indexOf(0); at >= 0; at = line.indexOf(0, start)) {
    if (at > start) frames.push(parse(unstuff(line.subarray(start, at))));
    start = at + 1;
  }
  return frames;
}
export const rates = (frames) => frames.filter((frame) => frame.kind === 'rate');
export const statuses = (frames) => frames.filter((frame) => frame.kind === 'status');
