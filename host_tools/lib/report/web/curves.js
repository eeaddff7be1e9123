// Curves over a common x, drawn by uPlot.

// Counts time from a round start where its ticks would all read the same, such as stamps since 1970.
function countFromStart(data) {
  const all = data.series.flatMap((one) => one.x);
  if (data.x.logarithmic || data.x.unit !== "s" || all.length === 0) return data;
  const [least, greatest] = all.reduce(([a, b], x) => [Math.min(a, x), Math.max(b, x)], [Infinity, -Infinity]);
  const span = Math.max(greatest - least, 100);
  if (least < 1e4 * span) return data;
  const round = 10 ** Math.ceil(Math.log10(span));
  const start = Math.floor(least / round) * round;
  return {
    ...data,
    x: { ...data.x, label: `${data.x.label} since ${typeset(String(start))}` },
    series: data.series.map((one) => ({ ...one, x: one.x.map((x) => x - start) })),
    shaded: data.shaded.map(([from, to]) => [from - start, to - start]),
  };
}

// One ascending x for all series, as uPlot wants it: undefined where a series has no point, null
// where it has a gap. Points of one series at the same x keep a row each.
function alignSeries(series) {
  const next = series.map(() => 0);
  const xs = [];
  const rows = [];
  for (;;) {
    const x = Math.min(...series.map((one, s) => (next[s] < one.x.length ? one.x[next[s]] : Infinity)));
    if (x === Infinity) return { xs, rows };
    xs.push(x);
    rows.push(series.map((one, s) => {
      const i = next[s];
      if (i >= one.x.length || one.x[i] !== x) return undefined;
      next[s] += 1;
      return i;
    }));
  }
}

// Rows of the points without a neighbour, which a line would leave invisible.
function lonePoints(one, rowOf) {
  const missing = (i) => one.y[i] === null || one.y[i] === undefined;
  const indices = [...one.y.keys()].filter((i) => !missing(i) && missing(i - 1) && missing(i + 1));
  return indices.map((i) => rowOf[i]);
}

function paddedLinear(least, greatest, share) {
  if (least === null) return [0, 1];
  const span = greatest - least || Math.abs(least) * 0.2 || 1;
  return [least - span * share, greatest + span * share];
}

function paddedLogarithmic(least, greatest, share) {
  if (least === null || least <= 0) return [0.1, 10];
  const factor = greatest > least ? (greatest / least) ** share : 3;
  return [least / factor, greatest * factor];
}

function scaleOptions(axis, share) {
  const padded = axis.logarithmic ? paddedLogarithmic : paddedLinear;
  return {
    time: false,
    distr: axis.logarithmic ? 3 : 1,
    range: (_plot, least, greatest) => padded(least, greatest, share),
  };
}

// Within one decade a logarithmic axis is close to a linear one, and 1, 2, 5 may all lie outside.
function isNarrow(least, greatest) {
  return greatest < 10 * least;
}

function magnitudeTicks(least, greatest, count) {
  if (isNarrow(least, greatest)) return linearTicks(least, greatest, count).ticks;
  const ticks = [];
  const finest = Math.log10(greatest / least) > 1.2 * count ? 1 : 9; // lines too close are a grey haze
  for (let e = Math.floor(Math.log10(least)); 10 ** e <= greatest; e += 1) {
    for (let m = 1; m <= finest; m += 1) {
      const tick = Number(`${m}e${e}`);
      if (tick >= least && tick <= greatest) ticks.push(tick);
    }
  }
  return ticks;
}

// Which ticks of a logarithmic axis are labelled: whole decades, thinned where they are many, or
// 1, 2 and 5 where there are few.
function labelledMagnitudes(ticks, { min, max }, pixels, pixelsPerLabel) {
  if (isNarrow(min, max)) return ticks;
  const perDecade = pixels / Math.log10(max / min);
  const step = Math.ceil(pixelsPerLabel / perDecade);
  return ticks.map((tick) => {
    const exponent = Math.floor(Math.log10(tick) + 1e-9);
    const mantissa = Math.round(tick / 10 ** exponent);
    const labelled = mantissa === 1 ? exponent % step === 0
      : perDecade > 3.4 * pixelsPerLabel && (mantissa === 2 || mantissa === 5);
    return labelled ? tick : null;
  });
}

function logarithmicTicks(isX, zoom) {
  const pixelsPerLabel = isX ? 52 : 26;
  const pixels = (plot) => (isX ? plot.bbox.width : plot.bbox.height) / uPlot.pxRatio / zoom;
  const scale = (plot) => plot.scales[isX ? "x" : "y"];
  return {
    splits: (plot, _axis, least, greatest) =>
      magnitudeTicks(least, greatest, pixels(plot) / (1.5 * pixelsPerLabel)),
    filter: (plot, ticks) => labelledMagnitudes(ticks, scale(plot), pixels(plot), pixelsPerLabel),
    values: (_plot, ticks) => formatMagnitudes(ticks),
  };
}

function axisOptions(axis, isX, zoom) {
  const gap = 6 * zoom;
  const tickLength = 4 * zoom;
  const options = {
    stroke: () => ink("muted"),
    font: `${12 * zoom}px ${ink("sans")}`,
    gap,
    space: (isX ? 64 : 34) * zoom,
    grid: { stroke: () => ink("grid"), width: zoom },
    ticks: { stroke: () => ink("rule"), width: zoom, size: tickLength },
    values: (_plot, ticks, _axis, _space, spacing) => formatTicks(ticks, spacing),
    size: 22 * zoom + gap,
  };
  if (axis.logarithmic) Object.assign(options, logarithmicTicks(isX, zoom));
  if (!isX) {
    options.size = (plot, labels) => {
      plot.ctx.font = `${12 * zoom * uPlot.pxRatio}px ${ink("sans")}`;
      const widths = (labels ?? []).map((label) => plot.ctx.measureText(label ?? "").width);
      return Math.ceil(gap + tickLength + Math.max(16 * zoom, ...widths.map((w) => w / uPlot.pxRatio)));
    };
  }
  return options;
}

const PATHS = {
  line: uPlot.paths.linear(),
  steps: uPlot.paths.stepped({ align: 1 }),
  points: () => null,
};

function lineOptions(one, rowOf, zoom) {
  const dots = one.style === "points" || one.marks ? rowOf : lonePoints(one, rowOf);
  return {
    stroke: () => ink(one.ink),
    width: 1.5 * zoom,
    dash: one.dashed ? [6 * zoom, 4 * zoom] : undefined,
    paths: PATHS[one.style],
    points: {
      show: true,
      filter: () => dots,
      size: 5 * zoom,
      width: 0,
      fill: () => ink(one.ink),
    },
  };
}

function edgeOptions(one) {
  return { stroke: "transparent", width: 0, paths: PATHS[one.style], points: { show: false } };
}

// The columns of uPlot: all band edges first, so that the lines lie on top of every band.
function layOut(data, zoom) {
  const { xs, rows } = alignSeries(data.series);
  const column = (s, values) => rows.map((row) => (row[s] === undefined ? undefined : values[row[s]]));
  const layout = { columns: [xs], series: [{}], bands: [], bars: [], rows, lineOf: [] };
  data.series.forEach((one, s) => {
    if (!one.lo) return;
    const lower = layout.columns.push(column(s, one.lo), column(s, one.hi)) - 2;
    layout.series.push(edgeOptions(one), edgeOptions(one));
    const band = { series: [lower + 1, lower], fill: () => `${ink(one.ink)}2e`, owner: s };
    (one.style === "points" ? layout.bars : layout.bands).push(band);
  });
  data.series.forEach((one, s) => {
    const rowOf = rows.flatMap((row, r) => (row[s] === undefined ? [] : [r]));
    layout.lineOf[s] = layout.columns.push(column(s, one.y)) - 1;
    layout.series.push(lineOptions(one, rowOf, zoom));
  });
  return layout;
}

function shade(plot, intervals) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.fillStyle = ink("shade");
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  for (const [from, to] of intervals) {
    const left = plot.valToPos(from, "x", true);
    ctx.fillRect(left, bbox.top, plot.valToPos(to, "x", true) - left, bbox.height);
  }
  ctx.restore();
}

// The interval of each single point: an area between points would join what has nothing in common.
function drawIntervals(plot, layout, zoom) {
  const { ctx, bbox } = plot;
  const [xs] = layout.columns;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.lineWidth = 5 * zoom * uPlot.pxRatio;
  for (const { series: [upper, lower], fill, owner } of layout.bars) {
    if (!plot.series[layout.lineOf[owner]].show) continue;
    ctx.strokeStyle = fill();
    ctx.beginPath();
    layout.columns[lower].forEach((low, row) => {
      if (!Number.isFinite(low)) return;
      const x = plot.valToPos(xs[row], "x", true);
      ctx.moveTo(x, plot.valToPos(low, "y", true));
      ctx.lineTo(x, plot.valToPos(layout.columns[upper][row], "y", true));
    });
    ctx.stroke();
  }
  ctx.restore();
}

function kindOf(one) {
  if (one.dashed) return "dashed";
  return one.marks ? "marks" : one.style;
}

// The row nearest to `row` in which the column has a value.
function nearestRow(column, row) {
  for (let distance = 0; distance < column.length; distance += 1) {
    if (Number.isFinite(column[row - distance])) return row - distance;
    if (Number.isFinite(column[row + distance])) return row + distance;
  }
  return null;
}

function readoutRows(plot, data, layout) {
  return data.series.flatMap((one, s) => {
    const row = plot.cursor.idxs[layout.lineOf[s]];
    if (row === null || row === undefined || !plot.series[layout.lineOf[s]].show) return [];
    const i = layout.rows[row][s];
    const band = one.lo ? `${formatNumber(one.lo[i])} … ${formatNumber(one.hi[i])}` : "";
    const cells = [swatch(kindOf(one), one.ink), one.name, formatNumber(one.y[i]), band];
    return [make("tr", {}, ...cells.map((cell) => make("td", {}, cell)))];
  });
}

// The values under the pointer, on the side of it that has more room.
function updateReadout(readout, plot, data, layout) {
  const { left, idx } = plot.cursor;
  readout.hidden = left < 0 || idx === null || idx === undefined;
  if (readout.hidden) return;
  const unit = data.x.unit === "" ? "" : ` ${data.x.unit}`;
  const rows = readoutRows(plot, data, layout);
  readout.replaceChildren(`${data.x.label} ${formatNumber(layout.columns[0][idx])}${unit}`,
    make("table", {}, make("tbody", {}, ...rows)));
  const width = plot.over.clientWidth;
  readout.style.left = left < width / 2 ? `${left + 14}px` : "auto";
  readout.style.right = left < width / 2 ? "auto" : `${width - left + 14}px`;
  readout.style.maxWidth = `${Math.max(left, width - left) - 14}px`;
}

function plotOptions({ data, figure }, layout, { width, height, zoom }) {
  const hasDots = data.series.some((one) => one.style === "points" || one.marks);
  const readout = make("div", { className: "readout", hidden: true });
  return {
    width: width * zoom,
    height: height * zoom,
    legend: { show: false },
    padding: [8 * zoom, 24 * zoom, 0, 0],
    scales: { x: scaleOptions(data.x, hasDots ? 0.02 : 0), y: scaleOptions(data.y, 0.05) },
    axes: [axisOptions(data.x, true, zoom), axisOptions(data.y, false, zoom)],
    series: layout.series,
    bands: layout.bands,
    cursor: {
      y: false,
      drag: { x: true, y: false, dist: 6 },
      points: { size: 8, width: 0, fill: (plot, s) => plot.series[s].stroke() },
      dataIdx: (_plot, s, row) => (s === 0 ? row : nearestRow(layout.columns[s], row)),
    },
    hooks: {
      init: [(plot) => plot.over.append(readout)],
      drawClear: [(plot) => {
        shade(plot, data.shaded);
        drawIntervals(plot, layout, zoom);
      }],
      draw: [() => markDrawn(figure)],
      setCursor: [(plot) => updateReadout(readout, plot, data, layout)],
    },
  };
}

function showSeries(plot, layout, s, shown) {
  plot.setSeries(layout.lineOf[s], { show: shown });
  for (const band of [...layout.bands, ...layout.bars].filter(({ owner }) => owner === s)) {
    for (const edge of band.series) plot.setSeries(edge, { show: shown });
  }
}

function curvesLegend(data, plot, layout) {
  const entries = data.series.map((one, s) => ({
    name: one.name,
    kind: kindOf(one),
    ink: one.ink,
    toggle: (shown) => showSeries(plot, layout, s, shown),
  }));
  if (data.shaded.length > 0) entries.push({ name: data.shadedName, kind: "area", ink: "shade" });
  return entries;
}

function drawCurves(frame, size) {
  const { data } = frame;
  const layout = layOut(data, size.zoom);
  const stage = make("div");
  frame.plot.replaceChildren(make("p", { className: "axis-title" }, axisTitle(data.y)), stage,
    make("p", { className: "axis-title x" }, axisTitle(data.x)));
  const plot = new uPlot(plotOptions(frame, layout, size), layout.columns, stage);
  fillLegend(frame.legend, curvesLegend(data, plot, layout));
  return {
    resize: ({ width, height }) => plot.setSize({ width, height }),
    remove: () => plot.destroy(),
    // On paper the bare canvas, drawn larger by `zoom`, scales to the width of the page.
    settle: () => stage.replaceChildren(plot.ctx.canvas),
  };
}

function curvesTable(data) {
  const { xs, rows } = alignSeries(data.series);
  const columns = data.series.flatMap((one) => [
    { heading: one.name, of: one.y },
    ...(one.lo ? [{ heading: "from", of: one.lo }, { heading: "to", of: one.hi }] : []),
  ].map((column) => ({ ...column, s: data.series.indexOf(one) })));
  return {
    headings: [axisTitle(data.x), ...columns.map(({ heading }) => heading)],
    rows: rows.map((row, r) => [xs[r], ...columns.map(({ of, s }) => (row[s] === undefined ? "" : of[row[s]]))]),
  };
}
