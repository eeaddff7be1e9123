#!/usr/bin/env python3
"""Tests of toolchains/images/rp2040_image.py."""

import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

TOOL = pathlib.Path(__file__).resolve().parents[2] / "toolchains" / "images" / "rp2040_image.py"
sys.path.insert(0, str(TOOL.parent))
import rp2040_image  # noqa: E402

FLASH = 0x10000000


def elf(*segments):
    """An ELF file with these (address, content) to load, and one empty segment."""
    table, data = b"", b""
    start = 52 + 32 * (len(segments) + 1)
    for address, content in (*segments, (0x20000000, b"")):
        table += struct.pack("<8I", 1, start + len(data), address, address, len(content), len(content), 5, 4)
        data += content
    header = b"\x7fELF\x01\x01\x01".ljust(16, b"\0")
    header += struct.pack("<2H5I6H", 2, 40, 1, 0, 52, 0, 0, 52, 32, len(segments) + 1, 40, 0, 0)
    return header + table + data


BOOT2 = bytes(range(252)) + bytes(4)


class Boot2Checksum(unittest.TestCase):
    def test_is_the_published_one(self):
        # CRC-32/MPEG-2: the check value of the catalogue of parametrised CRC algorithms.
        self.assertEqual(rp2040_image.boot2_checksum(b"123456789"), 0x0376E6E7)

    def test_agrees_with_zlib_on_reversed_bits(self):
        def mirrored(value, bits):
            return int(f"{value:0{bits}b}"[::-1], 2)
        expected = mirrored(zlib.crc32(bytes(mirrored(b, 8) for b in BOOT2[:252])) ^ 0xFFFFFFFF, 32)
        self.assertEqual(rp2040_image.boot2_checksum(BOOT2[:252]), expected)


class Files(unittest.TestCase):
    def make(self, content):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        image = pathlib.Path(folder.name) / "image.elf"
        image.write_bytes(content)
        done = subprocess.run([sys.executable, "-B", TOOL, image], capture_output=True, text=True, check=False)
        return image, done

    def test_hold_the_sealed_flash_with_gaps_erased(self):
        image, done = self.make(elf((FLASH + 300, b"later"), (FLASH, BOOT2 + b"code")))
        self.assertEqual(done.returncode, 0, done.stderr)
        flash = image.with_suffix(".bin").read_bytes()
        self.assertEqual(flash[:252], BOOT2[:252])
        self.assertEqual(flash[252:256], struct.pack("<I", rp2040_image.boot2_checksum(BOOT2[:252])))
        self.assertEqual(flash[256:], b"code" + b"\xff" * 40 + b"later")
        self.assertIn(flash[:256], image.read_bytes())

    def test_uf2_blocks_carry_the_flash_in_order(self):
        image, _ = self.make(elf((FLASH, BOOT2 + bytes(range(200)) * 3)))
        uf2 = image.with_suffix(".uf2").read_bytes()
        flash = image.with_suffix(".bin").read_bytes()
        self.assertEqual(len(uf2), 512 * 4)
        for i in range(4):
            block = uf2[512 * i:512 * (i + 1)]
            self.assertEqual(struct.unpack("<8I", block[:32]),
                             (0x0A324655, 0x9E5D5157, 0x2000, FLASH + 256 * i, 256, i, 4, 0xE48BFF56))
            self.assertEqual(block[32:288], flash[256 * i:256 * (i + 1)].ljust(256, b"\0"))
            self.assertEqual(block[508:], struct.pack("<I", 0x0AB16F30))

    def test_are_not_made_of_what_is_no_image(self):
        for content, complaint in ((b"MZ", "not an ELF"), (elf((FLASH + 256, b"x")), "start of the flash"),
                                   (elf((FLASH, BOOT2), (FLASH + 255, b"xx")), "overlap")):
            _, done = self.make(content)
            self.assertEqual(done.returncode, 1)
            self.assertIn(complaint, done.stderr)


if __name__ == "__main__":
    unittest.main()
