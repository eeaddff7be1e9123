#!/usr/bin/env python3
"""Makes what can be flashed out of a linked image for the RP2040.

usage: rp2040_image.py IMAGE.elf

Writes the checksum of the second boot stage into IMAGE.elf, without which the boot ROM refuses it,
and IMAGE.bin and IMAGE.uf2 beside it. A file IMAGE.uf2 is copied to the drive that a Pico shows when
it is powered with BOOTSEL held.
"""

import argparse
import pathlib
import struct
import sys

FLASH = 0x10000000
BOOT2_BYTES = 256  # the last four are the checksum


def boot2_checksum(code):
    """CRC-32 as the boot ROM computes it: RP2040 datasheet, 2.8.1.3.1; MSB first, no final XOR."""
    crc = 0xFFFFFFFF
    for byte in code:
        crc ^= byte << 24
        for _ in range(8):
            crc = (crc << 1) ^ (0x04C11DB7 if crc & 0x80000000 else 0)
        crc &= 0xFFFFFFFF
    return crc


def loaded_segments(elf):
    """(offset in the file, physical address, size) of what is loaded: ELF32, little-endian."""
    if elf[:6] != b"\x7fELF\x01\x01":
        raise ValueError("not an ELF file of a 32-bit little-endian processor")
    (table,) = struct.unpack_from("<I", elf, 28)
    entry_size, count = struct.unpack_from("<HH", elf, 42)
    for i in range(count):
        kind, offset, _, address, size = struct.unpack_from("<5I", elf, table + i * entry_size)
        if kind == 1 and size > 0:
            yield offset, address, size


def seal_boot2(elf):
    """The image with the checksum of its second boot stage."""
    for offset, address, size in loaded_segments(elf):
        if address == FLASH and size >= BOOT2_BYTES:
            end = offset + BOOT2_BYTES
            checksum = struct.pack("<I", boot2_checksum(elf[offset:end - 4]))
            return elf[:end - 4] + checksum + elf[end:]
    raise ValueError("nothing is linked to the start of the flash")


def flash_content(elf):
    """What the flash holds, from its start on; gaps are erased."""
    content = bytearray()
    for offset, address, size in sorted(loaded_segments(elf), key=lambda segment: segment[1]):
        start = address - FLASH
        if start < len(content):
            raise ValueError("segments overlap, or lie outside the flash")
        content += b"\xff" * (start - len(content)) + elf[offset:offset + size]
    return bytes(content)


def uf2(content):
    """USB Flashing Format: blocks of 512 bytes that hold 256 of the flash each
    (https://github.com/microsoft/uf2); family RP2040."""
    pages = [content[at:at + 256].ljust(256, b"\0") for at in range(0, len(content), 256)]
    return b"".join(
        struct.pack("<8I", 0x0A324655, 0x9E5D5157, 0x00002000, FLASH + 256 * i, 256, i, len(pages),
                    0xE48BFF56)
        + page.ljust(476, b"\0") + struct.pack("<I", 0x0AB16F30)
        for i, page in enumerate(pages))


def main():
    parser = argparse.ArgumentParser(description="Seals an RP2040 image; writes its .bin and .uf2.")
    parser.add_argument("image", type=pathlib.Path)
    image = parser.parse_args().image
    try:
        elf = seal_boot2(image.read_bytes())
        content = flash_content(elf)
    except ValueError as error:
        sys.exit(f"{image}: {error}")
    image.write_bytes(elf)
    image.with_suffix(".bin").write_bytes(content)
    image.with_suffix(".uf2").write_bytes(uf2(content))


if __name__ == "__main__":
    main()
