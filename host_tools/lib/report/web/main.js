// Draws every chart, and again when the width, the colour scheme or the medium changes.

const KINDS = {
  curves: { prepare: countFromStart, draw: drawCurves, table: curvesTable },
  bars: { prepare: (data) => data, draw: drawBars, table: barsTable },
};

const PAPER = { width: 660, height: 270, zoom: 3 }; // fits A4 and Letter; 3 dots a CSS pixel

function screenSize(plot) {
  const width = Math.max(240, Math.floor(plot.clientWidth));
  return { width, height: Math.round(Math.min(360, Math.max(240, width * 0.45))), zoom: 1 };
}

function makeFrame(figure) {
  const kind = KINDS[figure.dataset.chart];
  const data = kind.prepare(JSON.parse(figure.querySelector("script").textContent));
  const frame = {
    figure,
    data,
    kind,
    legend: figure.querySelector(".legend"),
    plot: figure.querySelector(".plot"),
    drawing: null,
  };
  fillTableOnDemand(figure.querySelector("details"), () => frame.kind.table(data));
  return frame;
}

function draw(frame, size) {
  frame.drawing?.remove();
  frame.drawing = frame.kind.draw(frame, size);
  frame.width = size.width;
}

const frames = [...document.querySelectorAll("figure.chart")].map(makeFrame);
const drawForScreen = () => frames.forEach((frame) => draw(frame, screenSize(frame.plot)));

drawForScreen();

const observer = new ResizeObserver((entries) => {
  for (const { target } of entries) {
    const frame = frames.find(({ plot }) => plot === target);
    const size = screenSize(target);
    const printing = "printing" in document.documentElement.dataset;
    if (printing || size.width === frame.width) continue;
    frame.width = size.width;
    frame.drawing.resize(size);
  }
});
frames.forEach(({ plot }) => observer.observe(plot));

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawForScreen);

addEventListener("beforeprint", () => {
  document.documentElement.dataset.printing = "";
  frames.forEach((frame) => draw(frame, PAPER));
  // uPlot paints in a microtask of its own, queued before this one.
  queueMicrotask(() => frames.forEach(({ drawing }) => drawing.settle()));
});
addEventListener("afterprint", () => {
  delete document.documentElement.dataset.printing;
  drawForScreen();
});
