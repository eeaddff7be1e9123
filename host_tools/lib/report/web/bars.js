// Grouped bars with error bars, drawn as SVG.

const TEXT_WIDTH = 6.6; // of a character of the 12 px face, on average

function barRange(data) {
  const values = data.groups.flatMap(({ values, lo, hi }) => [...values, ...lo, ...hi]);
  if (data.reference) values.push(data.reference.value);
  const finite = values.filter((value) => value !== null);
  const least = Math.min(0, ...finite);
  const greatest = Math.max(0, ...finite);
  if (least === greatest) return [0, 1];
  const margin = 0.06 * (greatest - least);
  return [least < 0 ? least - margin : 0, greatest > 0 ? greatest + margin : 0];
}

// Where things stand: pixel of a value, left edge and width of a bar.
function barGeometry(data, { width, height }) {
  const [least, greatest] = barRange(data);
  const { ticks, spacing } = linearTicks(least, greatest, height / 55);
  const labels = formatTicks(ticks, spacing);
  const scale = 12 + TEXT_WIDTH * Math.max(...labels.map((label) => label.length));
  const longest = Math.max(0, ...data.categories.map((name) => name.length));
  const tilted = longest * TEXT_WIDTH > (width - scale) / data.categories.length - 8;
  // A tilted name ends below its bars; the first one must not begin left of the chart.
  const overhang = tilted ? 0.81 * TEXT_WIDTH * data.categories[0].length : 0;
  const left = Math.max(scale, overhang - (width - scale) / data.categories.length / 2);
  const slot = (width - left) / data.categories.length;
  const foot = tilted ? 14 + 0.6 * TEXT_WIDTH * longest : 26;
  const top = 8;
  const bottom = height - foot;
  const barWidth = Math.min(56, (slot * 0.76) / data.groups.length);
  return {
    ticks,
    labels,
    left,
    bottom,
    width,
    tilted,
    barWidth,
    y: (value) => bottom - ((value - least) / (greatest - least)) * (bottom - top),
    middle: (category) => left + slot * (category + 0.5),
    barLeft: (category, group) => left + slot * (category + 0.5)
      + (group - data.groups.length / 2) * barWidth,
  };
}

function barGrid({ ticks, labels, left, width, y }) {
  return ticks.flatMap((tick, i) => [
    makeSvg("line", { x1: left, x2: width, y1: y(tick), y2: y(tick), style: "stroke: var(--grid)" }),
    makeSvg("text", { x: left - 8, y: y(tick) + 4, "text-anchor": "end", class: "tick" }, labels[i]),
  ]);
}

function categoryNames(data, geometry) {
  return data.categories.map((name, c) => {
    const x = geometry.middle(c);
    const y = geometry.bottom + 17;
    if (!geometry.tilted) return makeSvg("text", { x, y, "text-anchor": "middle" }, name);
    const turn = `rotate(-36 ${x} ${y})`;
    return makeSvg("text", { x: x + 4, y: y - 4, "text-anchor": "end", transform: turn }, name);
  });
}

function errorBar(group, c, middle, y) {
  const [lo, hi] = [group.lo[c], group.hi[c]];
  if (lo === undefined || lo === null || hi === null) return [];
  const path = `M${middle} ${y(lo)}V${y(hi)}M${middle - 4} ${y(lo)}h8M${middle - 4} ${y(hi)}h8`;
  return [makeSvg("path", { d: path, style: "stroke: var(--text); stroke-width: 1.25; fill: none" })];
}

// What the pointer is told about a bar.
function barTitle(data, group, c) {
  const interval = group.lo.length > 0
    ? ` (${formatNumber(group.lo[c])} … ${formatNumber(group.hi[c])})` : "";
  const unit = data.y.unit === "" ? "" : ` ${data.y.unit}`;
  return `${data.categories[c]}, ${group.name}: ${formatNumber(group.values[c])}${unit}${interval}`;
}

function bar(data, geometry, g, c) {
  const group = data.groups[g];
  const value = group.values[c];
  if (value === null) return [];
  const { y, barWidth } = geometry;
  const x = geometry.barLeft(c, g);
  const rectangle = makeSvg("rect", {
    x: x + 1,
    y: Math.min(y(value), y(0)),
    width: Math.max(1, barWidth - 2),
    height: Math.abs(y(value) - y(0)),
    style: `fill: var(--${group.ink})`,
  });
  const whole = makeSvg("g", {}, makeSvg("title", {}, barTitle(data, group, c)), rectangle,
    ...errorBar(group, c, x + barWidth / 2, y));
  return [whole];
}

function referenceLine(data, { left, width, y }) {
  if (!data.reference) return [];
  const level = y(data.reference.value);
  const style = "stroke: var(--ink); stroke-width: 1.25";
  return [makeSvg("line", { x1: left, x2: width, y1: level, y2: level, "stroke-dasharray": "6 4", style })];
}

function barsLegend(data) {
  const entries = data.groups.map(({ name, ink }) => ({ name, kind: "bar", ink }));
  if (data.reference) entries.push({ name: data.reference.name, kind: "dashed", ink: "ink" });
  return entries;
}

function drawBars(frame, size) {
  const { data } = frame;
  const stage = make("div");
  const draw = ({ width, height }) => {
    const geometry = barGeometry(data, { width, height });
    const zero = geometry.y(0);
    const bars = data.categories.flatMap((_, c) => data.groups.flatMap((__, g) => bar(data, geometry, g, c)));
    stage.replaceChildren(makeSvg("svg", { width, height, viewBox: `0 0 ${width} ${height}` },
      ...barGrid(geometry), ...bars,
      makeSvg("line", { x1: geometry.left, x2: width, y1: zero, y2: zero, style: "stroke: var(--muted)" }),
      ...referenceLine(data, geometry), ...categoryNames(data, geometry)));
    markDrawn(frame.figure);
  };
  draw(size);
  frame.plot.replaceChildren(make("p", { className: "axis-title" }, axisTitle(data.y)), stage);
  fillLegend(frame.legend, barsLegend(data));
  return { resize: draw, remove: () => stage.remove(), settle: () => {} };
}

function barsTable(data) {
  return {
    headings: ["", ...data.groups.flatMap(({ name, lo }) => (lo.length > 0 ? [name, "from", "to"] : [name]))],
    rows: data.categories.map((category, c) => [category,
      ...data.groups.flatMap(({ values, lo, hi }) => (lo.length > 0 ? [values[c], lo[c], hi[c]] : [values[c]]))]),
  };
}
