#!/usr/bin/env python3
"""Checks every #include line of a source tree against the table of allowed arrows.

usage: include_arrows.py [ROOT]

Prints `file:line: what is wrong` for each finding and exits with 1 where there is one.
"""

import pathlib
import re
import sys
import tomllib

SOURCES = {".hpp", ".cpp", ".h", ".c"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
FOLDERS = ("core", "hal", "drivers", "firmware", "host_tools", "host_tests")


def matches(room, pattern):
    """Whether a room is named by a pattern of the table; `*` stands for one path component."""
    parts, wanted = room.split("/"), pattern.split("/")
    return len(parts) == len(wanted) and all(w in ("*", p) for p, w in zip(parts, wanted))


class House:
    """The table: which rooms there are, and whom each may include."""

    def __init__(self, table):
        self._arrows = table["rooms"]
        self._flashed = table["flashed"]["rooms"]
        self._system_headers = set(table["flashed"]["system_headers"])

    def room_of(self, path):
        """(room, table line) of a file, the deepest and most exactly named one; None where no line holds it."""
        folders = path.split("/")[:-1]
        for depth in range(len(folders), 0, -1):
            room = "/".join(folders[:depth])
            lines = [line for line in self._arrows if matches(room, line)]
            if lines:
                return room, min(lines, key=lambda line: line.count("*"))
        return None

    def complaint(self, path, quoted, header):
        """What is wrong with `#include` of a header in the file at path; None where nothing is."""
        own = self.room_of(path)
        if own is None:
            return f"{path} stands in no room of arrows.toml"
        room, line = own
        if quoted:
            target = self.room_of(header)
            if target is None:
                return f'"{header}" is in no room of arrows.toml; includes start at the root of the repository'
            if target[0] == room or any(matches(target[0], allowed) for allowed in self._arrows[line]):
                return None
            return f"{room} may not include {target[0]} ({header})"
        if any(matches(room, flashed) for flashed in self._flashed) and header not in self._system_headers:
            return f"{room} is flashed and may not include <{header}>"
        return None


def findings(root, house):
    """`file:line: complaint` for every forbidden #include below root, in the order of the paths."""
    found = []
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in SOURCES:
                continue
            name = path.relative_to(root).as_posix()
            for number, text in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
                include = INCLUDE.match(text)
                if include is None:
                    continue
                complaint = house.complaint(name, include[1] == '"', include[2])
                if complaint is not None:
                    found.append(f"{name}:{number}: {complaint}")
    return found


def read_house(table=pathlib.Path(__file__).with_name("arrows.toml")):
    return House(tomllib.loads(table.read_text(encoding="utf-8")))


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]
    found = findings(root, read_house())
    for finding in found:
        print(finding)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
