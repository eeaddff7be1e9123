// What curves and bars share: inks, legend, axis titles, and the figures as a table.

function ink(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

function makeSvg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

function axisTitle(axis) {
  return axis.unit === "" ? axis.label : `${axis.label}, ${axis.unit}`;
}

// For whoever automates a browser: this chart has been painted at least once.
function markDrawn(figure) {
  figure.dataset.drawn = "true";
}

// The sample in a legend: what the series looks like in the plot.
function swatch(kind, colour) {
  const svg = makeSvg("svg", { width: 22, height: 12, "aria-hidden": "true" });
  if (kind === "area" || kind === "bar") {
    svg.append(makeSvg("rect", { x: 3, y: 0, width: 16, height: 12, style: `fill: var(--${colour})` }));
    return svg;
  }
  const stroke = `stroke: var(--${colour}); stroke-width: 2`;
  if (kind !== "points") {
    const dashes = kind === "dashed" ? "5 3.5" : "none";
    svg.append(makeSvg("line", { x1: 0, x2: 22, y1: 6, y2: 6, "stroke-dasharray": dashes, style: stroke }));
  }
  if (kind === "points" || kind === "marks") {
    svg.append(makeSvg("circle", { cx: 11, cy: 6, r: 3.5, style: `fill: var(--${colour})` }));
  }
  return svg;
}

// entries: {name, kind, ink, toggle}; with toggle(shown) the entry is a button.
function fillLegend(legend, entries) {
  legend.replaceChildren(...entries.map((entry) => {
    const sample = swatch(entry.kind, entry.ink);
    if (!entry.toggle) return make("span", {}, sample, entry.name);
    const button = make("button", { type: "button" }, sample, entry.name);
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      const shown = button.getAttribute("aria-pressed") === "false";
      button.setAttribute("aria-pressed", String(shown));
      entry.toggle(shown);
    });
    return button;
  }));
}

// Fills the table when it is first opened: most readers never ask for it.
function fillTableOnDemand(details, rowsOf) {
  details.addEventListener("toggle", () => {
    const { headings, rows } = rowsOf();
    const head = headings.map((text) => make("th", { scope: "col", className: "number" }, text));
    const body = rows.map((row) => make("tr", {}, ...row.map((cell) => make("td", {
      className: "number",
    }, typeof cell === "string" ? cell : formatNumber(cell)))));
    const table = make("table", {}, make("thead", {}, make("tr", {}, ...head)), make("tbody", {}, ...body));
    details.querySelector(".table").replaceChildren(table);
  }, { once: true });
}
