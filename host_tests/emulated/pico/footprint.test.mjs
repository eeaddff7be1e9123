import assert from 'node:assert/strict';
import fs from 'node:fs';
import test from 'node:test';
import { format, measure, parse } from './footprint.mjs';

const GROWTH = 1.03;

test('no figure of footprint.md has grown by more than three per cent', () => {
  const documented = parse(fs.readFileSync(process.env.PICO_FOOTPRINT, 'utf8'));
  const measured = measure();
  assert.deepEqual([...documented.keys()], [...measured.keys()]);
  for (const [name, value] of measured) {
    assert.ok(value <= GROWTH * documented.get(name), `${name}: ${documented.get(name)}, now ${value}`);
  }
});

test('the image keeps the promises of the project', () => {
  const figures = parse(fs.readFileSync(process.env.PICO_FOOTPRINT, 'utf8'));
  assert.ok(figures.get('flash, bytes') <= 40 * 1024);
  assert.ok(figures.get('RAM with stack, bytes') <= 8 * 1024);
  assert.ok(figures.get('stack at most, proved, bytes') <= figures.get('stack reserved, bytes'));
});

test('what is written is read back', () => {
  const figures = new Map([['flash, bytes', 1], ['other', 23]]);
  assert.deepEqual(parse(format(figures)), figures);
});
