#!/usr/bin/env python3
"""Finds what a reader of the documents and comments would stumble over.

usage: documents.py [ROOT]

A finding is: a relative link whose file or heading does not exist; a path or a header's name in
backticks that does not exist; a cited work without an entry in the bibliography, and an entry that
nobody cites; a number without its leading zero; a comment that opens with a word which sends the
reader back; a hole of firmware/boards/template that nothing explains, or more lines to fill in than
are promised; columns of a table that can run together; a source file, a line of prose or the name of
a test that is too long. Prints `file:line: complaint` for each and exits with 1 where there is one.
"""

import bisect
import functools
import itertools
import pathlib
import re
import subprocess
import sys

BIBLIOGRAPHY = "docs/reference/bibliography.md"
BOARD, PORT = "firmware/boards/template/board.hpp", "docs/how-to/port-to-a-board.md"
BOARD_LINES = 80  # to fill in for a board of one's own
FILE_LINES = 400  # of a source file
LINE_CHARACTERS = 130  # of a line of prose; rows of tables are free
NAME_CHARACTERS = 60  # of a test, Suite.Name
CODE = {".c", ".cpp", ".h", ".hpp"}
SCRIPTS = {".js", ".mjs", ".py", ".sh"}
EXEMPT = ("host_tests/guards/",)  # holds the planted offenders
ROOMS = ("core", "docs", "drivers", "firmware", "hal", "host_tests", "host_tools", "toolchains")

LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
INLINE_CODE = re.compile(r"`([^`\n]+)`")
PATH = re.compile(rf"(?:{'|'.join(ROOMS)})(?:/[\w.*+-]+)+/?")
SOURCE = re.compile(r"[\w*+-]+\.(?:c|cmake|cpp|h|hpp|js|mjs)")
SURNAME = r"[A-Z][\w'-]*[a-z]"
CITATION = re.compile(
    rf"\b((?:{SURNAME}, )*{SURNAME}(?:,? and {SURNAME}| et al\.)?) \(?((?:18|19|20)\d\d)\b(?!-\d)")
ENTRY = re.compile(r"^- \*\*(.+? \d{4})\*\*", re.MULTILINE)
NO_AUTHOR = re.compile(
    r"(?:January|February|March|April|May|June|July|August|September|October|November|December|Std|In)$")
NO_LEADING_ZERO = re.compile(r"(?<![\w.)\]/'\"+-])[+-]?\.\d+(?![\w.]*/)")
OPENING = re.compile(r"(of|that|by|as|what|over|to|who|whose|which|so|the same)\b", re.IGNORECASE)
COMMENT = re.compile(r"^\s*(///?)<?(?:\s(.*))?$")
TRAILING_COMMENT = re.compile(r"\s//[/<]*\s(.*)$")
JOINED_COLUMNS = re.compile(r'"[^"]*(\{:[<>]\d[^{}]*\}\{|\}\{:[<>]\d)')
TEST_NAME = re.compile(r"^(?:TYPED_)?TEST(?:_[FP])?\((\w+),\s*(\w+)\)", re.MULTILINE)


def anchor_of(heading):
    """The anchor that a page of Markdown gives a heading."""
    kept = re.sub(r"[^\w\- ]", "", INLINE_CODE.sub(r"\1", heading).strip().lower())
    return kept.replace(" ", "-")


def prose_of(text):
    """The lines of a page with their numbers, without fenced and indented code."""
    fenced = False
    for number, line in enumerate(text.splitlines(), start=1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced and not line.startswith("    "):
            yield number, line


def comments_of(text):
    """Each line of comment with its number, its words and whether it opens a comment.

    A whole line of comment continues the line above if both begin in the same column.
    """
    column_above = None
    for number, line in enumerate(text.splitlines(), start=1):
        whole = COMMENT.match(line)
        part = whole or TRAILING_COMMENT.search(line)
        words = (part.groups()[-1] or "") if part else ""
        column = line.index("//", part.start()) if part else None
        if part:
            yield number, words, not (whole and column == column_above)
        column_above = None if words == "@file" else column


class Tree:
    """The tracked files below a root, each read once."""

    def __init__(self, root, names=None):
        self.root = pathlib.Path(root)
        self.names = names if names is not None else tracked_files(root)
        self.places = set(self.names) | {
            parent.as_posix() for name in self.names for parent in pathlib.PurePosixPath(name).parents}

    @functools.cache
    def text(self, name):
        return (self.root / name).read_text(encoding="utf-8")

    @functools.cache
    def anchors(self, name):
        return {anchor_of(line.lstrip("#")) for _, line in prose_of(self.text(name)) if line.startswith("#")}

    def pages(self):
        return [name for name in self.names if name.endswith(".md")]

    def sources(self):
        return [name for name in self.names
                if pathlib.PurePosixPath(name).suffix in CODE and not name.startswith(EXEMPT)]


def tracked_files(root):
    listed = subprocess.run(["git", "-C", root, "ls-files", "-z"], check=True, capture_output=True, text=True)
    return [name for name in listed.stdout.split("\0") if name and (pathlib.Path(root) / name).exists()]


def broken_links(tree):
    """Relative links to a file or a heading that does not exist."""
    for name in tree.pages():
        for number, line in prose_of(tree.text(name)):
            for target in LINK.findall(INLINE_CODE.sub("", line)):
                if re.match(r"[a-z]+:", target):
                    continue
                path, _, anchor = target.partition("#")
                place = name if not path else (tree.root / name).parent.joinpath(path).resolve().relative_to(
                    tree.root.resolve()).as_posix()
                if place not in tree.places:
                    yield f"{name}:{number}: no such file: {target}"
                elif anchor and anchor not in tree.anchors(place):
                    yield f"{name}:{number}: no such heading: {target}"


def dead_paths(tree):
    """Paths in backticks that lead nowhere, and bare names of sources that no folder holds; `*` and capitals such as NAME
    stand for anything."""
    for name in tree.pages():
        if name == "CHANGELOG.md":  # tells of files as they were
            continue
        for number, line in prose_of(tree.text(name)):
            for code in INLINE_CODE.findall(line):
                path = code.rstrip("/")
                if not (PATH.fullmatch(code) or SOURCE.fullmatch(code)) or path in tree.places:
                    continue
                folders = "(.*/)?" if SOURCE.fullmatch(code) else ""
                pattern = folders + re.sub(r"\\\*|[A-Z]{3,}", "[^/]*", re.escape(path)) + r"(\.\w+)?"
                if not any(re.fullmatch(pattern, place) for place in tree.places):
                    yield f"{name}:{number}: no such file: {code}"


def words_of(tree, name):
    """The lines of a page's prose or of a source's comments, with their numbers."""
    if name.endswith(".md"):
        return list(prose_of(tree.text(name)))
    return [(number, words) for number, words, _ in comments_of(tree.text(name))]


def citations(tree):
    """Every work cited as `Surname year`, also across the end of a line, with a place that cites it."""
    cited = {}
    for name in tree.pages() + tree.sources():
        if name in (BIBLIOGRAPHY, "CHANGELOG.md"):
            continue
        lines = words_of(tree, name)
        ends = list(itertools.accumulate(len(line) + 1 for _, line in lines))
        for found in CITATION.finditer(" ".join(line for _, line in lines)):
            if not NO_AUTHOR.search(found[1]):
                number = lines[bisect.bisect_right(ends, found.start())][0]
                cited.setdefault(f"{found[1].replace(', and', ' and')} {found[2]}", f"{name}:{number}")
    return cited


def loose_citations(tree):
    """Citations without an entry in the bibliography, and entries without a citation."""
    cited = citations(tree)
    listed = set(ENTRY.findall(tree.text(BIBLIOGRAPHY))) if BIBLIOGRAPHY in tree.places else set()
    for work, place in cited.items():
        if work not in listed:
            yield f"{place}: not in {BIBLIOGRAPHY}: {work}"
    for work in sorted(listed - cited.keys()):
        yield f"{BIBLIOGRAPHY}:1: cited nowhere: {work}"


def missing_zeros(tree):
    """Numbers such as .5 in prose and comments; code in backticks is left alone."""
    for name in tree.pages() + tree.sources():
        for number, line in words_of(tree, name):
            found = NO_LEADING_ZERO.search(INLINE_CODE.sub("", line))
            if found:
                yield f"{name}:{number}: no leading zero: {found.group().strip()}"


def poor_openings(tree):
    """Comments whose first word says nothing by itself."""
    for name in tree.sources():
        for number, words, opens in comments_of(tree.text(name)):
            if opens and OPENING.match(words):
                yield f"{name}:{number}: a comment starts with a noun or a verb: {words}"


def board_holes(tree):
    """Holes of the board's template without a numbered comment before and a row in the page; too many lines to fill in."""
    if BOARD not in tree.places:
        return
    text = tree.text(BOARD)
    marks = re.findall(r"^/// (\d), |^ *// (FILL IN|FILLED IN)$", text, re.MULTILINE)
    found = "".join(number or {"FILL IN": "(", "FILLED IN": ")"}[mark] for number, mark in marks)
    explained = "".join(f"{number}()" for number in re.findall(r"^\| (\d) ", tree.text(PORT), re.MULTILINE))
    if found != explained:
        yield f"{BOARD}:1: comments and holes are {found}; {PORT} explains {explained}"
    lines = sum(hole.count("\n") for hole in re.findall(r"// FILL IN\n(.*?)// FILLED IN\n", text, re.DOTALL))
    if lines > BOARD_LINES:
        yield f"{BOARD}:1: {lines} lines to fill in, {BOARD_LINES} are promised"


def long_files(tree):
    for name in tree.names:
        if pathlib.PurePosixPath(name).suffix not in CODE | SCRIPTS:
            continue
        lines = tree.text(name).count("\n")
        if lines > FILE_LINES:
            yield f"{name}:{FILE_LINES + 1}: {lines} lines; a source file has at most {FILE_LINES}"


def joined_columns(tree):
    """Padded fields of a table's row without a blank between them: a long value would run into the next."""
    for name in tree.sources():
        for number, line in enumerate(tree.text(name).splitlines(), start=1):
            if JOINED_COLUMNS.search(line):
                yield f"{name}:{number}: no blank between two columns: {line.strip()}"


def long_lines(tree):
    """Lines of prose that a diff cannot show; a row of a table cannot be broken."""
    for name in tree.pages():
        for number, line in prose_of(tree.text(name)):
            if len(line) > LINE_CHARACTERS and not line.lstrip().startswith("|"):
                yield f"{name}:{number}: {len(line)} characters; a line of prose has at most {LINE_CHARACTERS}"


def long_test_names(tree):
    for name in tree.sources():
        text = tree.text(name)
        for found in TEST_NAME.finditer(text):
            full = ".".join(found.groups())
            if len(full) > NAME_CHARACTERS:
                number = text.count("\n", 0, found.start()) + 1
                yield f"{name}:{number}: {len(full)} characters; a test's name has at most {NAME_CHARACTERS}: {full}"


CHECKS = (broken_links, dead_paths, loose_citations, missing_zeros, poor_openings, board_holes, joined_columns,
          long_files, long_lines, long_test_names)


def findings(tree):
    return [finding for check in CHECKS for finding in check(tree)]


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]
    found = findings(Tree(root))
    for finding in found:
        print(finding)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
