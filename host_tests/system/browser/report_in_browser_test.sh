#!/bin/bash
# report_in_browser_test.sh PROGRAM REPORT FOLDER
#
# Opens the report of that name that PROGRAM writes in a headless browser, on screen, on a phone and on paper, and asks
# whether every chart was painted, no script complained, and the page is no wider than the phone. Without chromium it says so and ends
# with 77 (skipped).
set -euo pipefail
program=$1
name=$2
folder=$3

browser=$(command -v chromium || command -v chromium-browser || true)
if [[ -z $browser ]]; then
  echo "skipped: no chromium"
  exit 77
fi

mkdir -p "$folder"
profile=$(mktemp -d "$folder/profile.XXXXXX")
trap 'rm -rf "$profile"' EXIT
report=$(realpath "$folder")/report.html
"$program" "$name" "$report"

open_report() {
  timeout 60 "$browser" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync \
    --enable-logging=stderr --user-data-dir="$profile" "$@" "file://$report" 2> "$folder/log"
}

fail() {
  echo "FAILED: $1"
  exit 1
}

open_report --window-size=1200,900 --dump-dom > "$folder/dom.html"
if grep CONSOLE "$folder/log"; then fail "a script complained"; fi
charts=$(grep -c '<figure class="chart"' "$report")
painted=$(grep -c '<figure class="chart"[^>]* data-drawn="true"' "$folder/dom.html" || true)
canvases=$(grep -o '<canvas' "$folder/dom.html" | wc -l)
curves=$(grep -c 'data-chart="curves"' "$report")
bars=$(grep -o '<svg[^>]* viewBox="' "$folder/dom.html" | wc -l)
echo "$charts charts, $painted painted, $canvases canvases, $bars bar charts"
((charts > 0 && painted == charts)) || fail "not every chart was painted"
((canvases == curves)) || fail "expected $curves canvases"
((bars == charts - curves)) || fail "expected $((charts - curves)) bar charts"
if [[ $name == sample ]]; then
  grep -q 'Time since 1[^0-9<]*796[^0-9<]*040[^0-9<]*000, s' "$folder/dom.html" || fail "stamps are not counted from their start"
fi

# How far the page reaches beyond a screen 390 pixels wide, said by the page itself.
page=$report
report=$(realpath "$folder")/phone.html
sed 's#</body>#<script>addEventListener("load", () => {\
  const page = document.documentElement;\
  page.dataset.excess = page.scrollWidth - window.innerWidth;\
});</script></body>#' "$page" > "$report"
open_report --window-size=390,844 --dump-dom > "$folder/phone-dom.html"
excess=$(sed -n 's/.*data-excess="\(-\{0,1\}[0-9]*\)".*/\1/p' "$folder/phone-dom.html" | head -n 1)
echo "$excess pixels beyond the screen of a phone"
((excess <= 0)) || fail "the page is wider than a phone"
report=$page

open_report --no-pdf-header-footer --print-to-pdf="$folder/report.pdf"
if grep CONSOLE "$folder/log"; then fail "a script complained while printing"; fi
[[ -s $folder/report.pdf ]] || fail "nothing was printed"
echo "passed"
