#!/usr/bin/env python3
"""Draws the picture of learning.md from what `zerorate evaluate drives --learn --json` wrote.

usage: draw_learning.py FIGURES.json

Writes learning.svg beside itself: drift and coverage of the learning and of the fixed filter, data sheet by data sheet.
"""

import fractions
import html
import json
import pathlib
import sys

WIDTH, HEIGHT, LEFT, TOP, PANEL, ROW = 760, 372, 120, 64, 280, 30
BLUE, VERMILION, INK, RULE = "#0072b2", "#d55e00", "#1f2933", "#cbd2d9"
CONTESTANTS = {"learning": BLUE, "fixed": VERMILION}


def factor(value):
    return str(fractions.Fraction(value).limit_denominator(10))


class Panel:
    """A figure of every case, with its interval, on a linear axis; what lies beyond `hi` stands at the edge."""

    def __init__(self, left, title, key, lo, hi, ticks, reference):
        self.left, self.title, self.key, self.lo, self.hi = left, title, key, lo, hi
        self.ticks, self.reference = ticks, reference

    def x(self, value):
        return self.left + PANEL * (min(max(value, self.lo), self.hi) - self.lo) / (self.hi - self.lo)

    def parts(self, cases):
        bottom = TOP + ROW * len(cases)
        yield f'<text x="{self.left}" y="{TOP - 12}">{html.escape(self.title)}</text>'
        for tick in self.ticks:
            colour = INK if tick == self.reference else RULE
            yield f'<line x1="{self.x(tick):.1f}" y1="{TOP}" x2="{self.x(tick):.1f}" y2="{bottom}" stroke="{colour}"/>'
            yield f'<text x="{self.x(tick):.1f}" y="{bottom + 18}" text-anchor="middle">{tick:g}</text>'
        for row, case in enumerate(cases):
            for shift, (who, colour) in zip((-5, 5), CONTESTANTS.items()):
                y = TOP + ROW * (row + 0.5) + shift
                low, high = case[who][self.key + "_ci95"]
                yield (f'<line x1="{self.x(low):.1f}" y1="{y}" x2="{self.x(high):.1f}" y2="{y}" stroke="{colour}" '
                       'stroke-width="2"/>')
                yield f'<circle cx="{self.x(case[who][self.key]):.1f}" cy="{y}" r="4" fill="{colour}"/>'


def draw(found):
    cases = found["cases"]
    panels = [Panel(LEFT, "drift over that of the filter fitted on the others", "ratio_to_fitted_on_others", 0.95, 1.4,
                    (1.0, 1.1, 1.2, 1.3, 1.4), 1.0),
              Panel(LEFT + PANEL + 50, "coverage of the 95 % interval", "coverage95", 0.25, 1.0,
                    (0.25, 0.5, 0.75, 0.95), 0.95)]
    described = "Whatever is in the data sheet, the learning filter stays at the drift and the coverage of a fitted one."
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
             f'font-family="sans-serif" font-size="13" fill="{INK}" role="img">',
             "<title>A node that learns, with data sheets that are wrong</title>", f"<desc>{described}</desc>",
             f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for shift, (who, colour) in zip((0, 110), CONTESTANTS.items()):
        parts += [f'<circle cx="{LEFT + shift + 6}" cy="20" r="4" fill="{colour}"/>',
                  f'<text x="{LEFT + shift + 16}" y="24">{who}</text>']
    for row, case in enumerate(cases):
        label = f'N × {factor(case["white_factor"])}, B × {factor(case["flicker_factor"])}'
        parts.append(f'<text x="{LEFT - 12}" y="{TOP + ROW * (row + 0.5) + 4}" text-anchor="end">{label}</text>')
    for panel in panels:
        parts += panel.parts(cases)
    return "\n".join([*parts, "</svg>"]) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    figures = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    (pathlib.Path(__file__).parent / "learning.svg").write_text(draw(figures), encoding="utf-8")
