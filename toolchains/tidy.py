#!/usr/bin/env python3
"""Runs clang-tidy on every source file of the project; a file that was clean before and has not changed costs nothing.

usage: tidy.py [--jobs N] BUILD_FOLDER [FILE...]

Compile flags come from BUILD_FOLDER/compile_commands.json, of a build that compiles file by file. Its precompiled
headers are left out: a file that forgets an include fails here, unless one that is read before it has that include. Each
.cpp answers for the headers of its folder too.
The headers of a folder are read together as one translation unit, and so are the hosted sources of a folder and target,
because most of the time goes into what they include. That costs two checks, of unused aliases and using-declarations,
which look only at the main file. The analyzer is asked to look at headers.

The results stand in $XDG_CACHE_HOME/zerorate-tidy (~/.cache where that is not set). A result counts again only where
the tool, its configuration, the flags and every byte of every file that was read are the same. The bytes are hashed
and not the preprocessed source, because a comment can silence a check (NOLINT). Only clean files are remembered.
"""

import argparse
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

FOLDERS = ("core", "hal", "drivers", "firmware", "host_tools")
HOSTED = re.compile(r"(host_tools/|firmware/model|hal/(sim|testing|linux)).*\.hpp$")
# Files that are read together: hosted sources, which a build compiles at once too, and headers. Those of bare boards
# and the simulated chips are not, because some have the same names.
TOGETHER = re.compile(r"(host_tools|hal/linux|firmware/(model|toml|boards/linux))/|(?!firmware/boards/).*\.hpp$")
TARGET = re.compile(r" -o \S*?CMakeFiles/([^/]+)\.dir/")
# Files that CMake makes: their flags are none to borrow.
GENERATED = re.compile(r"/cmake_pch\.hxx\.cxx$|_verify_interface_header_sets/")
INCLUDED = re.compile(r"^\.+ (.*)$")
# Flags of GCC that clang refuses, and the warnings for those that it knows by another meaning or not at all.
GCC_ONLY = ("-fcx-limited-range", "--param=")
EXTRA_FLAGS = ["-Wno-double-promotion", "-Wno-ignored-optimization-argument", "-Wno-unknown-warning-option"]
HEADER_FLAGS = ["-Xclang", "-analyzer-opt-analyze-headers"]
KEPT_RUNS = 4  # as many states of one file are remembered, for branches to switch between


def digest(*parts):
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


@functools.lru_cache(maxsize=None)
def content_digest(path):
    """The hash of a file's bytes; of a file that is not there, the empty string."""
    try:
        return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()
    except OSError:
        return ""


class Cache:
    """Remembers, by the key of a run, the files that it read and the hash of their contents."""

    def __init__(self, folder, root):
        self._folder, self._root = folder, root
        folder.mkdir(parents=True, exist_ok=True)

    def has(self, key):
        return any(run["digest"] == self._digest_of(run["files"]) for run in self._runs(key))

    def remember(self, key, files):
        """Stores a run that found nothing. Paths in the project are relative, so that every clone profits."""
        files = sorted({os.path.relpath(file, self._root) if file.startswith(f"{self._root}/") else file
                        for file in map(os.path.realpath, files)})
        runs = [{"files": files, "digest": self._digest_of(files)}, *self._runs(key)][:KEPT_RUNS]
        unfinished = self._folder / f"{key}.{os.getpid()}"
        unfinished.write_text(json.dumps(runs), encoding="utf-8")
        unfinished.replace(self._folder / f"{key}.json")

    def _runs(self, key):
        try:
            return json.loads((self._folder / f"{key}.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return []

    def _digest_of(self, files):
        return digest(*(content_digest(os.path.join(self._root, file)) for file in files))


def without_precompiled_headers(words):
    """The flags without those by which CMake puts a precompiled header in front of a file."""
    kept = []
    for word in words:
        if word.endswith("/cmake_pch.hxx"):
            kept.pop()  # -include
        elif word != "-Winvalid-pch":
            kept.append(word)
    return kept


class Flags:
    """The compiler's flags for each file, from a compile database."""

    def __init__(self, database, root):
        self._of, self._targets = {}, {}
        for entry in json.loads(database.read_text(encoding="utf-8")):
            if GENERATED.search(entry["file"]):
                continue
            words = shlex.split(entry["command"])[1:]
            words = [word for word in words[:words.index("-o")] if not word.startswith(("-M", *GCC_ONLY))]
            file = os.path.relpath(entry["file"], root)
            self._of.setdefault(file, without_precompiled_headers(words))
            target = TARGET.search(entry["command"])
            self._targets.setdefault(file, target[1] if target else None)

    def of(self, file):
        """The flags of a file; of one that no build compiles here, those of the file nearest by its path."""
        if file not in self._of:
            nearest = max(sorted(self._of), key=lambda other: len(os.path.commonprefix([file, other])))
            return self._of[nearest]
        return self._of[file]

    def has(self, file):
        return file in self._of

    def target_of(self, file):
        return self._targets.get(file)


def files_to_check(root, flags):
    """Every source file of the product, and the headers of what is flashed, relative to the root."""
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.[ch]pp")):
            name = path.relative_to(root).as_posix()
            # Of the two sources for libgpiod only the one that this machine builds means anything here.
            other_gpiod = path.name.startswith("gpio_line_v") and path.suffix == ".cpp" and not flags.has(name)
            if not other_gpiod and not HOSTED.match(name):
                yield name


def units(files, flags):
    """The files in tuples: those that are read together, and each other one alone."""
    groups = {}
    for file in files:
        key = (os.path.dirname(file), flags.target_of(file), *flags.of(file)) if TOGETHER.match(file) else file
        groups.setdefault(key, []).append(file)
    return [tuple(group) for group in groups.values()]


class Tidy:
    def __init__(self, root, flags, cache):
        self._root, self._flags, self._cache = root, flags, cache
        self._version = subprocess.run(["clang-tidy", "--version"], check=True, capture_output=True, text=True).stdout

    def check(self, files):
        """(whether the files were remembered as clean, what clang-tidy finds in them: empty where nothing)."""
        folder = os.path.dirname(files[0])
        flags = self._flags.of(files[0]) + EXTRA_FLAGS + (HEADER_FLAGS if len(files) > 1 else [])
        configuration = [content_digest(above / ".clang-tidy") for above in (self._root / files[0]).parents]
        key = digest(*files, self._version, *configuration,
                     *(flag.replace(str(self._root), "") for flag in flags))
        if self._cache.has(key):
            return True, ""
        with tempfile.TemporaryDirectory() as scratch:
            main, overlay = self._main_file(files, pathlib.Path(scratch))
            # -H prints the path of every header that is read.
            run = subprocess.run(
                ["clang-tidy", "--quiet", *overlay, f"--header-filter={self._answers_for(folder, files)}", main, "--",
                 *flags, "-H"], cwd=self._root, capture_output=True, text=True)
        lines = [(INCLUDED.match(line), line) for line in run.stderr.splitlines()]
        if run.returncode == 0:
            included = [os.path.join(self._root, match[1]) for match, _ in lines if match]
            self._cache.remember(key, [*(str(self._root / file) for file in files), *included])
            return False, ""
        return False, "\n".join([run.stdout, *(line for match, line in lines if not match)]).strip() or "failed"

    def _main_file(self, files, scratch):
        """(the file to check, the options that make it). Files read together are included by one that exists for
        clang-tidy alone, beside them, so that it has their configuration."""
        if len(files) == 1:
            return files[0], []
        main = str(self._root / os.path.dirname(files[0]) / "together.cpp")
        contents, overlay = scratch / "together.cpp", scratch / "overlay.yaml"
        contents.write_text("".join(f'#include "{self._root / file}"  // NOLINT(bugprone-suspicious-include)\n'
                                    for file in files), encoding="utf-8")
        overlay.write_text(json.dumps({"version": 0, "roots": [
            {"type": "file", "name": main, "external-contents": str(contents)}]}), encoding="utf-8")
        return main, [f"--vfsoverlay={overlay}"]

    @staticmethod
    def _answers_for(folder, files):
        sources = "|".join(re.escape(os.path.basename(file)) for file in files)
        return f"/{re.escape(folder)}/([^/]*[.]hpp|{sources})$"


def cache_folder():
    above = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return pathlib.Path(above) / "zerorate-tidy"


def main():
    parser = argparse.ArgumentParser(description="clang-tidy with a memory", add_help=True)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).parents[1])
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("files", nargs="*", metavar="FILE")
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    flags = Flags(arguments.build / "compile_commands.json", root)
    tidy = Tidy(root, flags, Cache(cache_folder(), root))

    files = arguments.files or list(files_to_check(root, flags))
    together = units(files, flags)
    remembered = findings = 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for unit, (was_remembered, found) in zip(together, pool.map(tidy.check, together)):
            remembered += len(unit) if was_remembered else 0
            if found:
                findings += len(unit)
                print(f"{', '.join(unit)}:\n{found}\n", flush=True)
    print(f"{len(files)} files: {remembered} unchanged since they were clean, {findings} with findings")
    sys.exit(1 if findings or not files else 0)


if __name__ == "__main__":
    main()
