import assert from 'node:assert/strict';
import fs from 'node:fs';
import test from 'node:test';
import { format, measure, parse, provenStack, worstStack } from './footprint.mjs';

const GROWTH = 1.03;

test('no figure of footprint.md has grown by more than three per cent', () => {
  const documented = parse(fs.readFileSync(process.env.PICO_FOOTPRINT, 'utf8'));
  const measured = measure();
  assert.deepEqual([...documented.keys()], [...measured.keys()]);
  for (const [row, values] of measured) {
    values.forEach((value, i) => {
      const before = documented.get(row)[i];
      assert.ok(value <= GROWTH * before, `${row}: ${before}, now ${value}`);
    });
  }
});

/// Verifies SR-MEM-04.
test('the images keep the promises of the project', () => {
  const figures = parse(fs.readFileSync(process.env.PICO_FOOTPRINT, 'utf8'));
  const limits = [{ flash: 60 * 1024, ram: 8 * 1024 }, { flash: 76 * 1024, ram: 24 * 1024 }];
  limits.forEach(({ flash, ram }, i) => {
    assert.ok(figures.get('flash, bytes')[i] <= flash);
    assert.ok(figures.get('RAM with stack, bytes')[i] <= ram);
    assert.ok(figures.get('stack at most, proved, bytes')[i] <= figures.get('stack reserved, bytes')[i]);
  });
});

test('what is written is read back', () => {
  const figures = new Map([['flash, bytes', [1, 2]], ['other', [23, 4]]]);
  assert.deepEqual(parse(format(figures)), figures);
});

for (const name of ['zerorate-pico', 'zerorate-pico-learning']) {
  /// Verifies SR-MEM-03.
  test(`the bound of the stack is reached, and not exceeded: ${name}`, () => {
    assert.equal(worstStack(name), provenStack(name));
  });
}

// Its deepest call begins the node anew where a record with a right checksum holds impossible numbers.
/// Verifies SR-MEM-03.
test('the bound of the stack holds where the moving average is published', () => {
  const name = 'mutant-moving-average-published';
  assert.ok(worstStack(name) <= provenStack(name));
});
