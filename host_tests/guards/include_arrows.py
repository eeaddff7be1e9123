#!/usr/bin/env python3
"""Checks every #include line of a source tree against the table of allowed arrows.

usage: include_arrows.py [ROOT]

Prints `file:line: what is wrong` for each forbidden include, then what is wrong with the table itself
(a cycle, an arrow into the laboratory, one that nothing uses, a folder without a line), and exits with 1 where there is anything.
"""

import graphlib
import pathlib
import re
import sys
import tomllib

SOURCES = {".hpp", ".cpp", ".h", ".c"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
TESTS = "host_tests"
C_HEADERS = "firmware/c_api/include/"
FOLDERS = ("core", "hal", "drivers", "firmware", "host_tools", TESTS)


def matches(room, pattern):
    """Whether a room is named by a pattern of the table; `*` stands for one path component."""
    parts, wanted = room.split("/"), pattern.split("/")
    return len(parts) == len(wanted) and all(w in ("*", p) for p, w in zip(parts, wanted))


class House:
    """The table: which rooms there are, and whom each may include."""

    def __init__(self, table):
        self.arrows = table["rooms"]
        self.laboratory = table["laboratory"]["rooms"]
        self._flashed = table["flashed"]["rooms"]
        self._system_headers = set(table["flashed"]["system_headers"])

    def room_of(self, path):
        """The room of a file, the deepest one that is named; None where no line holds it."""
        folders = path.split("/")[:-1]
        rooms = ("/".join(folders[:depth]) for depth in range(len(folders), 0, -1))
        return next((room for room in rooms if room in self.arrows), None)

    def complaint(self, path, quoted, header):
        """What is wrong with `#include` of a header in the file at path; None where nothing is."""
        room = self.room_of(path)
        if room is None:
            return f"{path} stands in no room of arrows.toml"
        if quoted:
            # The headers of the C interface are installed side by side, away from the root.
            is_installed_beside = path.startswith(C_HEADERS) and "/" not in header
            target = self.room_of(path if is_installed_beside else header)
            if target is None:
                return f'"{header}" is in no room of arrows.toml; includes start at the root of the repository'
            if target == room or any(matches(target, allowed) for allowed in self.arrows[room]):
                return None
            return f"{room} may not include {target} ({header})"
        if any(matches(room, flashed) for flashed in self._flashed) and header not in self._system_headers:
            return f"{room} is flashed and may not include <{header}>"
        return None


def sources(root):
    """The name of every source file below root, in the order of the paths."""
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SOURCES:
                yield path.relative_to(root).as_posix()


def includes(root):
    """(file, line number, whether it is quoted, header) of every #include below root."""
    for name in sources(root):
        for number, text in enumerate((root / name).read_text(encoding="utf-8").splitlines(), start=1):
            include = INCLUDE.match(text)
            if include is not None:
                yield name, number, include[1] == '"', include[2]


def findings(root, house):
    """`file:line: complaint` for every forbidden #include below root, in the order of the paths."""
    complaints = ((name, number, house.complaint(name, quoted, header))
                  for name, number, quoted, header in includes(root))
    return [f"{name}:{number}: {complaint}" for name, number, complaint in complaints if complaint is not None]


def patterns(house):
    """Lines with a `*`, which only the tests may have, and which hides who includes whom."""
    return [f"{room} -> {allowed} names more than one room" for room, line in house.arrows.items()
            for allowed in (room, *line) if "*" in allowed and room != TESTS]


def into_laboratory(house):
    """Permitted arrows from a room of the product to one of the laboratory."""
    def is_laboratory(room):
        return any(matches(room, pattern) for pattern in house.laboratory)
    return [f"{room} -> {allowed} makes the product need the laboratory" for room, line in house.arrows.items()
            for allowed in line if is_laboratory(allowed) and not is_laboratory(room) and room != TESTS]


def cycle(house):
    """The rooms of a cycle of permitted arrows, in words; none where there is none."""
    try:
        graphlib.TopologicalSorter(house.arrows).prepare()
    except graphlib.CycleError as error:
        return ["cycle: " + " -> ".join(reversed(error.args[1]))]
    return []


def unused(root, house):
    """Permitted arrows that no #include below root needs."""
    used = {(house.room_of(name), house.room_of(header)) for name, _, quoted, header in includes(root) if quoted}
    return [f"{room} -> {allowed} is used by nothing" for room, line in house.arrows.items() for allowed in line
            if not any(source == room and target is not None and matches(target, allowed)
                       for source, target in used)]


def unlisted(root, house):
    """Folders with sources, other than the tests', that have no line of their own; lines without sources."""
    folders = {name.rpartition("/")[0] for name in sources(root)}
    homeless = [f"{folder} has no line" for folder in sorted(folders - house.arrows.keys())
                if not folder.startswith(TESTS)]
    return homeless + [f"{room} has no sources" for room in house.arrows if room not in folders and room != TESTS]


def complaints_of(root, house):
    """Everything that is wrong with the tree or with the table."""
    return (findings(root, house) + patterns(house) + into_laboratory(house) + cycle(house) + unused(root, house)
            + unlisted(root, house))


def read_house(table=pathlib.Path(__file__).with_name("arrows.toml")):
    return House(tomllib.loads(table.read_text(encoding="utf-8")))


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]
    found = complaints_of(root, read_house())
    for finding in found:
        print(finding)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
