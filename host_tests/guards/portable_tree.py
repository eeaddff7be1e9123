#!/usr/bin/env python3
"""Finds what ties a source tree to one machine or one network.

usage: portable_tree.py [ROOT]

That is: absolute paths into somebody's home, scratch or work folder; hosts of package registries;
and lock files that say where a package was downloaded from. Prints `file:line: what is wrong` for
each finding and exits with 1 where there is one.
"""

import json
import os
import pathlib
import re
import sys

SKIPPED = {".git", "build", "node_modules", "__pycache__"}
TIES = {
    "path of one machine": re.compile(r"(?<![\w.~}-])/" r"(home|root|work|Users|tmp|mnt|media)/[\w.-]"),
    "host of a package registry": re.compile(
        r"\b(registry\.[a-z]+(js|hub)?\.(org|com|io)|(deb|security|ftp)\.(debian|ubuntu)\.(org|com)"
        r"|archive\.ubuntu\.com|pypi\.org|files\.pythonhosted\.org|proxy\.golang\.org)"),
}


def lock_file_findings(name, text):
    """A finding for every package of a package-lock.json that names its download address."""
    packages = json.loads(text).get("packages", {})
    return [f"{name}: resolved address of {package or 'the root'}: see npm's --omit-lockfile-registry-resolved"
            for package, entry in packages.items() if "resolved" in entry]


def files(root):
    """All files of the tree that are not built or downloaded, in the order of their paths."""
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(f for f in folders if f not in SKIPPED and not f.startswith("build-"))
        for name in sorted(set(names) - SKIPPED):  # .git is a file in a work tree
            yield pathlib.Path(folder) / name


def findings(root):
    """`file:line: complaint` for every tie below root."""
    found = []
    for path in files(root):
        name = path.relative_to(root).as_posix()
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # a picture or a compressed recording names no path
        for number, line in enumerate(text.splitlines(), start=1):
            found += [f"{name}:{number}: {tie}: {line.strip()}" for tie, rule in TIES.items() if rule.search(line)]
        if path.name == "package-lock.json":
            found += lock_file_findings(name, text)
    return found


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]
    found = findings(root)
    for finding in found:
        print(finding)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
