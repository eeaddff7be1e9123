#!/usr/bin/env python3
"""Boots a machine and drives the lines of its PL061 as the machine asks.

usage: stock_machine.py FOLDER QEMU ARGUMENT...

What the machine prints comes out again, but for `LINE number level`: then the line is driven, by QEMU's qtest
protocol, and the machine is told so by one byte.
"""

import json
import os
import socket
import subprocess
import sys
import time


def connect(path):
    """A file of lines to a socket that QEMU opens."""
    for _ in range(1000):
        try:
            connection = socket.socket(socket.AF_UNIX)
            connection.connect(path)
            return connection.makefile("rw", encoding="ascii")
        except OSError:
            connection.close()
            time.sleep(0.02)
    sys.exit(f"{path}: QEMU does not answer")


def ask(monitor, command, **arguments):
    """The answer of QEMU's monitor (QMP)."""
    monitor.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
    monitor.flush()
    while True:
        answer = json.loads(monitor.readline())
        if "return" in answer:
            return answer["return"]
        if "error" in answer:
            sys.exit(f"{command}: {answer}")


def find_lines(path):
    """The PL061 among the devices."""
    monitor = connect(path)
    monitor.readline()  # the greeting
    ask(monitor, "qmp_capabilities")
    for device in ask(monitor, "qom-list", path="/machine/unattached"):
        if "pl061" in device["type"]:
            return "/machine/unattached/" + device["name"]
    sys.exit("the machine has no PL061")


def main():
    folder, *command = sys.argv[1:]
    sockets = {name: os.path.join(folder, name) for name in ("qmp", "qtest")}
    for name, path in sockets.items():
        if os.path.exists(path):
            os.unlink(path)
        command += [f"-{name}", f"unix:{path},server=on,wait=off"]
    command += ["-qtest-log", "none"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as machine:
        lines = find_lines(sockets["qmp"])
        qtest = connect(sockets["qtest"])
        for line in machine.stdout:
            text = line.decode("ascii", "replace").rstrip()
            if not text.startswith("LINE "):
                print(text, flush=True)
                continue
            _, number, level = text.split()
            qtest.write(f"set_irq_in {lines} unnamed-gpio-in {number} {level}\n")
            qtest.flush()
            if not qtest.readline().startswith("OK"):
                sys.exit("QEMU did not drive the line")
            machine.stdin.write(b".")
            machine.stdin.flush()
    return machine.returncode


if __name__ == "__main__":
    sys.exit(main())
