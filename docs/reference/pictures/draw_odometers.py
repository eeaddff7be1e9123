#!/usr/bin/env python3
"""Draws the pictures of real-odometers.md from what `zerorate odometer --json` wrote.

usage: draw_odometers.py K08.json K19.json T19.json

Writes odometer-zero.svg, odometer-rolling.svg and odometer-turning.svg beside itself. Only quantiles and shares
enter: no row of a recording.
"""

import html
import json
import math
import pathlib
import sys

WIDTH, HEIGHT = 760, 380
LEFT, RIGHT, TOP, BOTTOM = 90, 30, 50, 60
BLUE, VERMILION, GREEN, AMBER, INK, RULE = "#0072b2", "#d55e00", "#009e73", "#e69f00", "#1f2933", "#cbd2d9"
SITUATIONS = {"after_stop": ("first metres after a stop", BLUE), "before_stop": ("last metres before it", VERMILION),
              "inching": ("inching between", GREEN), "passing": ("passing without a stop", AMBER)}


class Drawing:
    """An SVG with a linear or logarithmic x axis from `lo` to `hi`, and a y axis from 0 to 1."""

    def __init__(self, title, described, lo, hi, logarithmic=False):
        self.lo, self.hi, self.logarithmic = lo, hi, logarithmic
        self.parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
                      f'height="{HEIGHT}" font-family="sans-serif" font-size="13" fill="{INK}" role="img">',
                      f"<title>{html.escape(title)}</title>", f"<desc>{html.escape(described)}</desc>",
                      f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>']
        self.text(LEFT, 26, title, size=15)

    def x(self, value):
        scale = math.log10 if self.logarithmic else float
        share = (scale(max(value, self.lo)) - scale(self.lo)) / (scale(self.hi) - scale(self.lo))
        return LEFT + share * (WIDTH - LEFT - RIGHT)

    @staticmethod
    def y(share):
        return HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM)

    def text(self, x, y, words, anchor="start", size=13, colour=INK):
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}" fill="{colour}">'
                          f"{html.escape(words)}</text>")

    def line(self, points, colour, width=2.0, dashed=False):
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        dash = ' stroke-dasharray="6 4"' if dashed else ""
        self.parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}"{dash}/>')

    def box(self, x, y, width, height, colour):
        self.parts.append(f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" fill="{colour}"/>')

    def x_axis(self, ticks, label):
        for tick in ticks:
            self.line([(self.x(tick), self.y(0)), (self.x(tick), self.y(1))], RULE, 1)
            self.text(self.x(tick), self.y(0) + 20, f"{tick:g}", "middle")
        self.text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 14, label, "middle")

    def y_axis(self, label):
        for tick in (0, 0.25, 0.5, 0.75, 1):
            self.line([(LEFT, self.y(tick)), (WIDTH - RIGHT, self.y(tick))], RULE, 1)
            self.text(LEFT - 8, self.y(tick) + 4, f"{100 * tick:g} %", "end")
        self.text(LEFT, TOP - 8, label, size=12)

    def distribution(self, quantiles, colour, dashed=False):
        steps = len(quantiles) - 1
        self.line([(self.x(value), self.y(i / steps)) for i, value in enumerate(quantiles)], colour, 2.5, dashed)

    def write(self, name):
        path = pathlib.Path(__file__).parent / name
        path.write_text("\n".join([*self.parts, "</svg>"]) + "\n", encoding="utf-8")


def draw_zero(k19, t19):
    drawing = Drawing("True speed at which the odometer leaves and reaches zero",
                      "Distributions of the reference's speed: leaving zero between 0.35 and 1.5 m/s, reaching it "
                      "mostly at rest.", 0.0, 1.6)
    drawing.y_axis("share of the events")
    drawing.x_axis([0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6], "speed of the reference [m/s]")
    for record, colour in ((k19, BLUE), (t19, VERMILION)):
        drawing.distribution(record["leaves_zero_mps"]["quantiles"], colour)
        drawing.distribution(record["reaches_zero_mps"]["quantiles"], colour, dashed=True)
    at = drawing.x(1.08)
    for row, (words, colour, dashed) in enumerate((("leaves zero, K19", BLUE, False),
                                                   ("leaves zero, T19", VERMILION, False),
                                                   ("reaches zero, K19", BLUE, True),
                                                   ("reaches zero, T19", VERMILION, True))):
        y = drawing.y(0.42) + 20 * row
        drawing.line([(at, y - 4), (at + 28, y - 4)], colour, 2.5, dashed)
        drawing.text(at + 34, y, words)
    drawing.write("odometer-zero.svg")


def draw_rolling(records):
    drawing = Drawing("Rolling at more than 0.1 m/s while the odometer reads zero",
                      "Stacked bars: share of the time at zero by situation, for three recordings.", 0.0, 0.12)
    drawing.x_axis([0, 0.02, 0.04, 0.06, 0.08, 0.1, 0.12], "share of the time at zero")
    for row, (name, record) in enumerate(records.items()):
        y = TOP + 34 + 62 * row
        drawing.text(LEFT - 8, y + 23, name, "end")
        begin = 0.0
        for situation, (_, colour) in SITUATIONS.items():
            share = record["rolling_by_situation"][situation]["share"]["value"]
            drawing.box(drawing.x(begin), y, drawing.x(begin + share) - drawing.x(begin), 36, colour)
            begin += share
    for column, (words, colour) in enumerate(SITUATIONS.values()):
        x, y = LEFT + 10 + 310 * (column % 2), HEIGHT - BOTTOM - 34 + 20 * (column // 2)
        drawing.box(x, y - 10, 12, 12, colour)
        drawing.text(x + 18, y, words)
    drawing.write("odometer-rolling.svg")


def draw_turning(record):
    drawing = Drawing("Turning while the odometer reads zero, K08",
                      "Distributions of the yaw rate's magnitude: at true rest and while rolling at zero.",
                      0.001, 2.0, logarithmic=True)
    drawing.y_axis("share of the rows")
    drawing.x_axis([0.001, 0.01, 0.1, 1], "yaw rate [deg/s]")
    drawing.distribution(record["standing_turning_dps"], INK, dashed=True)
    drawing.distribution(record["rolling"]["turning_dps"], BLUE)
    drawing.text(drawing.x(0.0012), drawing.y(0.8), "at true rest")
    drawing.text(drawing.x(0.1), drawing.y(0.75), "rolling", colour=BLUE)
    drawing.write("odometer-turning.svg")


def main():
    k08, k19, t19 = (json.loads(pathlib.Path(name).read_text(encoding="utf-8")) for name in sys.argv[1:4])
    draw_zero(k19, t19)
    draw_rolling({"K08": k08, "K19": k19, "T19": t19})
    draw_turning(k08)


if __name__ == "__main__":
    main()
