import assert from 'node:assert/strict';
import test from 'node:test';
import { provenStack, worstStack } from './stack.mjs';

test('the bound of the stack is reached, and not exceeded', () => {
  const name = 'mutant-moving-average-published';
  assert.equal(worstStack(name), provenStack(name));
});

test('the image that is shipped has the same bound and stays below it', () => {
  assert.equal(provenStack('zerorate-pico'), provenStack('mutant-moving-average-published'));
  assert.ok(worstStack('zerorate-pico') < provenStack('zerorate-pico'));
});
