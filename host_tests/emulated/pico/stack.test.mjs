import assert from 'node:assert/strict';
import test from 'node:test';
import { provenStack, worstStack } from './stack.mjs';

for (const name of ['zerorate-pico', 'zerorate-pico-learning', 'mutant-moving-average-published']) {
  test(`the bound of the stack is reached, and not exceeded: ${name}`, () => {
    assert.equal(worstStack(name), provenStack(name));
  });
}
