#!/usr/bin/env python3
"""CAN frames in the hands of another tool: Debian's canmatrix reads the DBC file that `zerorate export --dbc` writes for a
configuration, decodes frames by it, and finds the values that were written into them.

usage: can_test.py ZERORATE CAN_FRAMES_SENT [unittest arguments]
"""

import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

# Debian's modules, for a Python that is not Debian's.
sys.path.append("/usr/lib/python3/dist-packages")
try:
    import canmatrix.formats
except ImportError:
    print("no canmatrix (python3-canmatrix)")
    sys.exit(77)

ZERORATE, SENT = sys.argv.pop(1), sys.argv.pop(1)
CONFIGURATION = """schema = "zerorate.daemon/1"
[gyro]
chip = "lsm6dso"
bus = "spi"
device = "/dev/spidev0.0"
rate_hz = 208
full_scale_dps = 250
[odometer]
chip = "/dev/gpiochip0"
line = 17
"""
SINK = """[[sink]]
type = "can"
interface = "can0"
id = 0x310
"""


def exported(configuration, *options):
    """The DBC file of a configuration, as canmatrix sees it."""
    with tempfile.TemporaryDirectory() as folder:
        toml, dbc = pathlib.Path(folder, "zerorated.toml"), pathlib.Path(folder, "zerorate.dbc")
        toml.write_text(configuration, encoding="utf-8")
        subprocess.run([ZERORATE, "export", "--dbc", toml, *options, "-o", dbc], check=True, timeout=20)
        return canmatrix.formats.loadp_flat(str(dbc))


def messages(layout, data_id=0x345, variant="11C"):
    """Frames by identifier and written values by signal, message by message."""
    text = subprocess.run([SENT, layout, "0x310", hex(data_id), variant], capture_output=True, text=True, check=True,
                          timeout=20).stdout
    frames, values = {}, {}
    for line in text.splitlines():
        word, *rest = line.split()
        if word == "frame":
            frames[int(rest[0])] = bytes.fromhex(rest[1])
        elif word == "value":
            values[rest[0]] = float(rest[1])
        else:
            yield frames, values
            frames, values = {}, {}


def crc_by_table(data):
    """CRC-8 of polynomial 0x1D that starts at 0, by a table of 256 bytes."""
    table = list(range(256))
    for _ in range(8):
        table = [(x << 1 ^ (0x1D if x & 0x80 else 0)) & 0xFF for x in table]
    crc = 0
    for byte in data:
        crc = table[crc ^ byte]
    return crc


class Frames(unittest.TestCase):
    def compare(self, layout, sink):
        """Signals that were compared at least once."""
        matrix, compared = exported(CONFIGURATION + SINK + sink), set()
        for frames, values in messages(layout):
            for identifier, data in frames.items():
                frame = matrix.frame_by_id(canmatrix.ArbitrationId(identifier))
                self.assertEqual(len(data), frame.size)
                for name, decoded in frame.decode(data).items():
                    if name in values:
                        self.check(decoded, values[name])
                        compared.add(name)
        return compared

    def check(self, decoded, written):
        signal, value = decoded.signal, float(decoded.phys_value)
        if signal.values.get(decoded.raw_value) == "not available":
            beyond = math.isnan(written) or written > float(signal.max) or written < float(signal.min)
            self.assertTrue(beyond, f"{signal.name}: {written} is not available")
        else:
            # Half an LSB, and roundings of single precision.
            self.assertAlmostEqual(value, written, delta=0.501 * float(signal.factor) + 1e-6 * abs(written), msg=signal.name)

    def test_of_the_axes_hold_what_was_written(self):
        compared = self.compare("axes", "")
        for name in ("RateX", "BiasY", "SigmaZ", "TurnX", "RateVertical", "Heading", "UpY", "AccelerationZ", "Temperature",
                     "OdometerPulses", "Motion", "Calibrated", "AccelerationMissing"):
            self.assertIn(name, compared)

    def test_of_the_yaw_rate_hold_what_was_written(self):
        self.assertEqual(self.compare("yaw", 'layout = "yaw"\nup = "z"\n'),
                         {"YawRate", "Motion", "Calibrated", "AccelerationMissing"})

    def test_of_can_fd_hold_what_was_written(self):
        compared = self.compare("fd", 'layout = "fd"\n')
        for name in ("RateX", "SigmaZ", "YawRate", "Motion", "TurnX", "Heading"):
            self.assertIn(name, compared)

    def test_count_and_protect_as_profile_11(self):
        for layout, variant in (("yaw", "11A"), ("yaw", "11C"), ("fd", "11A"), ("fd", "11C")):
            for number, (frames, _) in enumerate(messages(layout, 0x345, variant)):
                data = frames[0x310]
                self.assertEqual(data[1], number % 15 | (0x30 if variant == "11C" else 0))
                self.assertEqual(data[0], crc_by_table([0x45, 0x03 if variant == "11A" else 0, *data[1:]]))


class DbcFile(unittest.TestCase):
    def test_has_the_identifiers_times_and_receivers_of_the_configuration(self):
        matrix = exported(CONFIGURATION + SINK + 'every = 4\n', "--receivers", "BRAKE,DISPLAY")
        status = matrix.frame_by_name("ZERORATE_STATUS")
        self.assertEqual(status.arbitration_id.id, 0x310)
        self.assertEqual(status.cycle_time, 19)  # 4 / 208 Hz
        self.assertEqual(matrix.frame_by_name("ZERORATE_TURN_X").cycle_time, 77)
        self.assertEqual(matrix.frame_by_name("ZERORATE_TURN_VERTICAL").arbitration_id.id, 0x31E)
        self.assertEqual({ecu.name for ecu in matrix.ecus}, {"ZERORATE", "BRAKE", "DISPLAY"})
        self.assertEqual(status.transmitters, ["ZERORATE"])
        self.assertEqual(status.signal_by_name("SigmaX").receivers, ["BRAKE", "DISPLAY"])

    def test_names_the_protection_and_can_fd(self):
        matrix = exported(CONFIGURATION + SINK + 'layout = "fd"\ne2e_variant = "11A"\ne2e_data_id = 0x1234\n')
        frame = matrix.frame_by_name("ZERORATE_FD")
        self.assertTrue(frame.is_fd)
        self.assertEqual((frame.attributes["E2EProfile"], frame.attributes["E2EDataId"]), ("11A", "4660"))
        self.assertFalse(matrix.frame_by_name("ZERORATE_INPUTS").is_fd)

    def test_has_no_two_signals_on_one_bit(self):
        for sink in ("", 'layout = "yaw"\nup = "z"\n', 'layout = "fd"\n'):
            for frame in exported(CONFIGURATION + SINK + sink).frames:
                bits = [bit for signal in frame.signals for bit in range(signal.start_bit, signal.start_bit + signal.size)]
                self.assertEqual(len(bits), len(set(bits)), frame.name)
                self.assertLess(max(bits), 8 * frame.size)


if __name__ == "__main__":
    unittest.main()
