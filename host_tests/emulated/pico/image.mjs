// The files that the build makes: what is flashed, and where its functions are.

import fs from 'node:fs';

export const FLASH = 0x10000000;

// A function of a file, computed once: a test starts the same image hundreds of times.
function once(read) {
  const known = new Map();
  return (file) => {
    if (!known.has(file)) known.set(file, read(file));
    return known.get(file);
  };
}

// [offset in the flash, bytes] of every block of a UF2 file.
export const uf2Blocks = once((file) => {
  const data = fs.readFileSync(file);
  const blocks = [];
  for (let at = 0; at < data.length; at += 512) {
    const words = [0, 4, 8, 12, 16, 20, 24, 28, 508].map((o) => data.readUInt32LE(at + o));
    const [magic0, magic1, flags, address, size, number, count, family, end] = words;
    if (magic0 !== 0x0a324655 || magic1 !== 0x9e5d5157 || end !== 0x0ab16f30 ||
        flags !== 0x2000 || family !== 0xe48bff56 || size !== 256 ||
        number !== at / 512 || count !== data.length / 512 || address % 256 !== 0) {
      throw new Error(`${file}: block ${at / 512} is not what a Pico accepts`);
    }
    blocks.push([address - FLASH, data.subarray(at + 32, at + 32 + size)]);
  }
  return blocks;
});

// Name -> {address, size} of the symbols of an ELF file.
export const elfSymbols = once((file) => {
  const data = fs.readFileSync(file);
  const table = data.readUInt32LE(32), entry = data.readUInt16LE(46), count = data.readUInt16LE(48);
  const symbols = new Map();
  for (let i = 0; i < count; i++) {
    const section = table + i * entry;
    if (data.readUInt32LE(section + 4) !== 2) continue; // SHT_SYMTAB
    const start = data.readUInt32LE(section + 16), size = data.readUInt32LE(section + 20);
    const names = data.readUInt32LE(table + data.readUInt32LE(section + 24) * entry + 16);
    for (let at = start; at < start + size; at += 16) {
      const name = names + data.readUInt32LE(at);
      const text = data.toString('latin1', name, data.indexOf(0, name));
      symbols.set(text, { address: data.readUInt32LE(at + 4), size: data.readUInt32LE(at + 8) });
    }
  }
  return symbols;
});
