#!/usr/bin/env python3
"""zerorated with a speed and headings that messages bring: by UDP, a Unix socket and CAN.

usage: message_inputs_test.py ZERORATED [unittest arguments]
"""

import itertools
import os
import re
import shutil
import socket
import struct
import subprocess
import time
import unittest

import zerorated_test
from without_hardware_test import Simulated
from zerorated_test import LIMIT_S


# Stands in for the kernel's CAN where there is none: the socket is a Unix datagram socket that takes the same frames.
NO_CAN = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#define REAL(name, ...) ((int (*)(__VA_ARGS__))dlsym(RTLD_NEXT, #name))
int socket(int family, int type, int protocol) {
  const int is_can = family == PF_CAN;
  return REAL(socket, int, int, int)(is_can ? AF_UNIX : family, is_can ? SOCK_DGRAM | SOCK_CLOEXEC : type,
                                     is_can ? 0 : protocol);
}
int ioctl(int file, unsigned long request, ...) {
  va_list more;
  va_start(more, request);
  void* argument = va_arg(more, void*);
  va_end(more);
  if (request == SIOCGIFINDEX) return ((struct ifreq*)argument)->ifr_ifindex = 1, 0;
  return REAL(ioctl, int, unsigned long, void*)(file, request, argument);
}
int setsockopt(int file, int level, int name, const void* value, socklen_t size) {
  return level == SOL_CAN_RAW ? 0 : REAL(setsockopt, int, int, int, const void*, socklen_t)(file, level, name, value, size);
}
int bind(int file, const struct sockaddr* address, socklen_t size) {
  if (address->sa_family != AF_CAN) return REAL(bind, int, const struct sockaddr*, socklen_t)(file, address, size);
  struct sockaddr_un path = {.sun_family = AF_UNIX};
  strncpy(path.sun_path, getenv("ZERORATE_TEST_CAN"), sizeof path.sun_path - 1);
  return REAL(bind, int, const struct sockaddr*, socklen_t)(file, (const struct sockaddr*)&path, sizeof path);
}
"""

TRAITS = "dead_band_mps = 0.1\nlatency_s = 0.05\n"


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class MessageInputs(Simulated):
    def wait_for(self, is_reached, say, words):
        """Says the speed ten times a second until a message is as it should be."""
        for _ in range(200):
            if words is not None:
                say(words.encode())
            end = time.monotonic() + 0.1
            while time.monotonic() < end:
                message = self.message()
                if is_reached(message):
                    return message
        self.fail("not reached")

    def drive_by_messages(self, say):
        """Stands, moves, falls silent and stands again, by what is said of the speed."""
        self.start()
        self.assertTrue(self.message()["health"] & 0x20, "nobody has said anything: odometer_fault")
        self.wait_for(lambda message: message["health"] & 0x01 and message["motion"] == 2, say, "0.05")
        self.wait_for(lambda message: message["motion"] == 0, say, "-0.5")
        self.wait_for(lambda message: message["motion"] == 2, say, "still")
        silent_since = time.monotonic()
        self.wait_for(lambda message: message["health"] & 0x20 and message["motion"] == 0, say, None)
        self.assertGreater(time.monotonic() - silent_since, 0.8)
        self.wait_for(lambda message: not message["health"] & 0x20, say, "still")
        return self.stop()

    def test_takes_the_speed_from_udp(self):
        port = free_port()
        self.simulate(f'[odometer]\ntype = "udp"\naddress = "127.0.0.1"\nport = {port}\n' + TRAITS)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            errors = self.drive_by_messages(lambda words: sender.sendto(words, ("127.0.0.1", port)))
        self.assertIn(f"odometer udp:127.0.0.1:{port}: Connection timed out (no message with a speed comes", errors)

    def test_takes_a_turn_on_the_spot_for_motion(self):
        port = free_port()
        self.simulate(f'[odometer]\ntype = "udp"\naddress = "127.0.0.1"\nport = {port}\n' + TRAITS)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            def say(words):
                sender.sendto(words, ("127.0.0.1", port))
            self.start()
            self.wait_for(lambda message: message["motion"] == 2, say, "0 0")
            self.wait_for(lambda message: message["motion"] == 0, say, "-0.12 0.12")
            self.wait_for(lambda message: message["motion"] == 2, say, "0 0")
            self.wait_for(lambda message: message["health"] & 0x20 and message["motion"] == 0, say, "0;0")
            errors = self.stop()
        self.assertIn(f"odometer udp:127.0.0.1:{port}: Bad message (messages come, and none can be used", errors)

    def test_takes_the_speed_from_a_unix_socket(self):
        path = self.folder / "speed"
        self.simulate(f'[odometer]\ntype = "unix"\npath = "{path}"\n' + TRAITS)
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            self.drive_by_messages(lambda words: sender.sendto(words, str(path)))
        self.assertFalse(path.exists())

    def head_by_messages(self, origin, say):
        """Stands, is told a heading, and says it again counter-clockwise; what is no heading changes nothing."""
        self.simulate(f'[reference]\n{origin}up = "z"\nsense = "clockwise"\nsigma_deg = 0.5\nlatency_s = 0.1\n')
        self.start()
        self.message()  # the socket is open
        self.wait_for(lambda message: message["health"] & 0x01, say, "north")
        end = time.monotonic() + LIMIT_S
        while not (heading := re.search(r"^zerorate_heading_deg (.*)$", self.metrics(), re.MULTILINE)):
            self.assertLess(time.monotonic(), end, "no heading")
            say(b"350.5 0.5\n")
            time.sleep(0.1)
        self.assertAlmostEqual(float(heading[1]), 9.5, delta=0.5)
        self.assertIn("zerorate_references_refused_total 0", self.metrics())
        return self.stop()

    def test_takes_headings_from_udp(self):
        port = free_port()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            errors = self.head_by_messages(f'type = "udp"\naddress = "127.0.0.1"\nport = {port}\n',
                                           lambda words: sender.sendto(words, ("127.0.0.1", port)))
        self.assertIn(f"reference udp:127.0.0.1:{port}", errors)

    def test_takes_headings_from_a_unix_socket(self):
        path = self.folder / "heading"
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            self.head_by_messages(f'type = "unix"\npath = "{path}"\n', lambda words: sender.sendto(words, str(path)))
        self.assertFalse(path.exists())

    def drive_by_can(self, interface, send):
        """Speed as a signed signal of 0.01 m/s in big byte order."""
        self.simulate(f'[odometer]\ntype = "can"\ninterface = "{interface}"\nid = 0x1A0\nstart_bit = 7\nlength = 16\n'
                      'byte_order = "big"\nsigned = true\nscale_mps = 0.01\n' + TRAITS)

        def say(words):
            speed = struct.pack(">h6x", 0 if words == b"still" else round(100 * float(words)))
            send(struct.pack("=IB3x8s", 0x1A0, 8, speed))
        errors = self.drive_by_messages(say)
        self.assertIn(f"odometer can:{interface} id 0x1a0: Connection timed out (no message with a speed comes", errors)

    @unittest.skipUnless(shutil.which("ip"), "no ip")
    def test_takes_the_speed_from_can(self):
        name = f"zrt{os.getpid() % 10**6}"
        made = subprocess.run(["ip", "link", "add", name, "type", "vcan"], capture_output=True, text=True, check=False)
        if made.returncode != 0:
            self.skipTest(f"no vcan here: {made.stderr.strip()}")
        self.addCleanup(subprocess.run, ["ip", "link", "del", name], check=True)
        subprocess.run(["ip", "link", "set", name, "up"], check=True)
        with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as sender:
            sender.bind((name,))
            self.drive_by_can(name, sender.send)

    def stand_in_for_can(self):
        """Path of the socket that stands in for the bus."""
        if not shutil.which("cc") or zerorated_test.is_sanitized():
            self.skipTest("no C compiler named cc, or a sanitizer whose library must be loaded first")
        path, library = self.folder / "can", self.folder / "no_can.so"
        subprocess.run(["cc", "-shared", "-fPIC", "-o", library, "-x", "c", "-"], input=NO_CAN, text=True, check=True)
        self.environment = dict(os.environ, LD_PRELOAD=str(library), ZERORATE_TEST_CAN=str(path))
        return path

    def test_takes_several_signals_from_can(self):
        """Two wheels, a counter and the ignition in two frames: none may be absent, old or invalid."""
        path = self.stand_in_for_can()
        bits = 'length = 8\nbyte_order = "little"\n'
        wheel = '[[odometer.signal]]\nid = 0x1A0\nscale_mps = 0.1\nsigned = true\n' + bits
        self.simulate('[odometer]\ntype = "can"\ninterface = "can0"\n' + TRAITS + wheel + "start_bit = 0\n" + wheel +
                      "start_bit = 8\n" + '[[odometer.signal]]\nid = 0x1A0\nrole = "counter"\nstart_bit = 16\n' + bits +
                      '[[odometer.signal]]\nid = 0x2B0\nrole = "valid"\nvalue = 4\nstart_bit = 0\n' + bits)
        counts = itertools.count()
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            def say(words):
                left, right, ignition, *count = map(int, words.split())
                count = count[0] if count else next(counts) % 256
                wheels = struct.pack("<bbB5x", left, right, count)
                sender.sendto(struct.pack("=IB3x8s", 0x1A0, 8, wheels), str(path))
                sender.sendto(struct.pack("=IB3x8s", 0x2B0, 8, bytes([ignition])), str(path))
            self.start()
            self.message()
            for still, moving in (("0 0 4", "-3 3 4"), ("0 0 4", "0 0 5"), ("0 0 4", "0 0 4 7")):
                self.wait_for(lambda message: message["motion"] == 2, say, still)
                self.wait_for(lambda message: message["motion"] == 0, say, moving)
            errors = self.stop()
        self.assertIn("odometer can:can0 ids 0x1a0, 0x2b0: No data available (the vehicle says that its speed", errors)

    def test_takes_the_speed_from_a_stand_in_for_can(self):
        path = self.stand_in_for_can()
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            self.drive_by_can("can0", lambda frame: sender.sendto(frame, str(path)))

    def test_says_that_the_can_interface_of_the_speed_is_not_there(self):
        self.simulate('[odometer]\ntype = "can"\ninterface = "no-can"\nid = 0x1A0\nstart_bit = 0\nlength = 8\n'
                      'byte_order = "little"\nscale_mps = 0.1\n' + TRAITS)
        self.start()
        message = self.wait_for(lambda message: message["health"] & 0x20, None, None)
        self.assertEqual(message["motion"], 0)
        for _ in range(200):
            self.message()
        self.assertRegex(self.stop(), r"odometer can:no-can id 0x1a0: .+ \(.+\); the vehicle counts as moving")


if __name__ == "__main__":
    unittest.main()
