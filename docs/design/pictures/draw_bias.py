#!/usr/bin/env python3
"""Draws the pictures of bias and heading for README.md and docs/design/why-a-gyro-drifts.md: charts of the product's reports.

usage: draw_bias.py ZERORATE

Runs the commands of each picture in a folder of its own, opens the report in chromium, and writes one of its charts
beside itself. The page shows the same commands, and a test runs those.
"""

import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

# Picture: the commands that make its report, and the place of the chart in it.
PICTURES = {
    "predicted-bias": (("simulate --scenario motorway --seed 3",
                        "replay motorway.csv.gz --model lsm6dso --report report.html"), 0),
    "bias-in-a-stop": (("simulate --rest 180 --rate-hz 20 --seed 4 -o stop.csv.gz",
                        "replay stop.csv.gz --model lsm6dso --axis z --schedule still=1000000,drive=1,seed=1 "
                        "--report report.html"), 0),
    "bias-in-a-drive": (("simulate --rest 1800 --rate-hz 20 --seed 4 -o drive.csv.gz",
                         "replay drive.csv.gz --model lsm6dso --axis z --schedule still=90,drive=600,seed=3 "
                         "--report report.html"), 0),
    "interval-of-drives": (("simulate --rest 36000 --rate-hz 10 --seed 4 -o day.csv.gz",
                            "replay day.csv.gz --model lsm6dso --axis z --schedule still=90,drive=600,seed=3 "
                            "--report report.html"), 2),
}
WIDTH, HEIGHT = 900, 460
ONE_CHART = """<style>
  body > * {{ display: none !important; }}
  figure.chart {{ display: none; }}
  figure.chart.alone {{ display: block; position: fixed; inset: 0; margin: 0; padding: 8px 16px; background: #fff; z-index: 9; }}
  figure.chart.alone :is(figcaption, details) {{ display: none; }}
</style>
<script>
  const alone = document.querySelectorAll("figure.chart")[{place}];
  alone.classList.add("alone");
  document.body.append(alone);
  alone.style.setProperty("display", "block", "important");
</script>"""


def draw(zerorate, browser, name, folder):
    commands, place = PICTURES[name]
    for command in commands:
        subprocess.run([zerorate, *shlex.split(command)], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    report = folder / "report.html"
    text = report.read_text(encoding="utf-8")
    report.write_text(text.replace("</body>", ONE_CHART.format(place=place) + "</body>"), encoding="utf-8")
    subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run",
                    "--disable-background-networking", f"--user-data-dir={folder / 'profile'}",
                    f"--window-size={WIDTH},{HEIGHT}", "--virtual-time-budget=4000",
                    f"--screenshot={pathlib.Path(__file__).resolve().parent / name}.png", report.as_uri()],
                   check=True, stderr=subprocess.DEVNULL, timeout=90)


def main():
    zerorate = str(pathlib.Path(sys.argv[1]).resolve())
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if not browser:
        sys.exit("no chromium")
    for name in PICTURES:
        with tempfile.TemporaryDirectory(prefix="zerorate-") as folder:
            draw(zerorate, browser, name, pathlib.Path(folder))


if __name__ == "__main__":
    main()
