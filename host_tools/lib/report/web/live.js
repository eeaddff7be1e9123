"use strict";

// The page of a running node. Events of the program carry the moment and new rows of the history.

const AXES = ["x", "y", "z"];
const MOTIONS = { moving: "Driving", settling: "Stopping", still: "Standing still" };
// What each flag means, and what to do about it.
const FLAGS = {
  calibrated: ["No bias is known yet", "Stand still for half a minute. Until then the rate is not corrected."],
  sample_refused: ["The gyro gave an impossible value", "It was left out. If it happens often, check the wiring."],
  time_refused: ["A sample came out of order", "It was left out. If it happens often, check the clock of the node."],
  saturated: ["The vehicle turns faster than the gyro can measure", "The rate shown is too small. Choose a larger full_scale_dps."],
  model_inconsistent: ["This sensor behaves like none that the node knows",
    "Do not rely on ±. Record the gyro at rest for an hour and run 'zerorate diagnose' on the recording."],
  odometer_fault: ["The odometer cannot be read", "Check its line. Until it is back, nothing counts as standing still."],
  sensor_fault: ["The gyro gives no samples", "Check its supply and its wires; 'zerorate probe' looks for it."],
  measurement_rejected: ["A knock or a turn at rest was left out", "Nothing to do. It passes when the vehicle is quiet."],
  temperature_missing: ["The thermometer is silent", "The interval widens. Check the gyro's temperature reading."],
  odometer_disagreement: ["Gyro and odometer contradict each other",
    "Check that the odometer counts whenever the wheels turn, and only then."],
  acceleration_missing: ["The accelerometer is silent", "The interval widens. Check that the node reads it (acceleration = true)."],
  reference_disagreement: ["References and gyro contradict each other", "Is the reference's sense that of the axis that points up? Is its time right?"],
  sample_rate_off: ["Samples are lost, or too many come", "Does another program read the chip? Is the data-ready edge the right one?"],
  odometer_dead_band: ["The odometer is silent while the vehicle creeps",
    "The node leaves that motion out. Set dead_band_mps, so that it knows."],
};
const MOST_POINTS = 3600;
const SILENT_AFTER_MS = 5000; // the program says something every second

const byId = (id) => document.getElementById(id);
const fixed = (number, digits) => (number === null ? "–" : number.toFixed(digits));
// A figure to the second digit of its standard deviation.
function withSigma(figure, sigma) {
  const digits = sigma > 0 ? Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(sigma)))) : 6;
  return `${figure.toFixed(digits)} ± ${sigma.toFixed(digits)}`;
}
const counted = (count, one, many) => `${count} ${count === 1 ? one : many}`;

function element(name, className, words = "") {
  const node = document.createElement(name);
  if (className) node.className = className;
  node.textContent = words;
  return node;
}

// Words of the head, its colour, and what to do: pairs of what is wrong and its remedy.
function showState(className, motion, verdict, wrong) {
  byId("state").className = `state ${className}`;
  byId("motion").textContent = motion;
  byId("verdict").textContent = verdict;
  byId("health").replaceChildren(...wrong.flatMap(([what, remedy]) => [element("dt", "", what), element("dd", "", remedy)]));
}

function duration(seconds) {
  const whole = Math.round(seconds);
  return whole < 60 ? `${whole} s` : `${Math.floor(whole / 60)} min ${whole % 60} s`;
}

// Time since the vehicle last came to rest or left, where the history reaches back so far.
function since(now) {
  const still = now.motion === "still" ? 1 : 0;
  let first = points.length;
  while (first > 0 && points[first - 1][STILL] === still) --first;
  if (first === 0 || first === points.length) return "";
  return `for ${duration(points.at(-1)[0] - points[first][0])}`;
}

function showHealth(now) {
  if (now.silent_s !== null) {
    showState("lost", now.messages === 0 ? "Waiting for the node" : "The node is silent",
      `no message for ${duration(now.silent_s)}`,
      [["No rate is known now", "Is zerorated running, and does it send here? See [[sink]] in its configuration. " +
        "This page goes on by itself as soon as messages come."]]);
    return;
  }
  const wrong = now.wrong.map((flag) => FLAGS[flag] ?? [flag, ""]);
  const motion = now.wrong.includes("odometer_fault") ? "Standing or driving: not known" : MOTIONS[now.motion];
  showState(wrong.length === 0 ? "well" : now.wrong.includes("sensor_fault") ? "lost" : "look", motion,
    wrong.length === 0 ? "✓ All is well" : `! ${counted(wrong.length, "thing", "things")} to look at`, wrong);
}

// A bias of the past is called so.
function dim(isStale) {
  byId("axes").classList.toggle("stale", isStale);
  cards.forEach((card) => { card.biasName.textContent = isStale ? "last bias " : "bias "; });
}

function showAxes(now) {
  dim(now.silent_s !== null);
  cards.forEach((card, i) => {
    const { rate_dps: rate, bias_dps: bias, half95_dps: half, turn_deg: turn, turn_half95_deg: turnHalf } = now.axes[i];
    card.rate.textContent = fixed(rate, 2).replace(/^-(0\.00)$/, "$1");
    card.turn.textContent = turn === null ? "–" : `${fixed(turn, 1)} ± ${fixed(turnHalf, 1)}`;
    card.bias.textContent = half === null ? "–" : `${fixed(bias, 4)} ± ${fixed(half, 4)}`;
  });
}

// Counter-clockwise seen from above, as the node counts.
function showVertical(vertical) {
  const line = byId("vertical");
  line.hidden = vertical === null;
  if (vertical === null) return;
  const { rate_dps: rate, heading_deg: heading, heading_half95_deg: half } = vertical;
  const course = heading === null ? "not known before a reference" : `${fixed(heading, 1)} ± ${fixed(half, 1)} deg`;
  line.textContent = `About the vertical: ${fixed(rate, 2)} deg/s. Heading: ${course}, counter-clockwise.`;
}

// Roll about x and pitch about y turn a level sensor, whose z axis points up, to its place.
function showAttitude(now) {
  const words = [];
  if (now.attitude !== null) {
    const { tilt_deg: tilt, roll_deg: roll, pitch_deg: pitch } = now.attitude;
    words.push(`The sensor leans by ${fixed(tilt, 1)} deg: roll ${fixed(roll, 1)} deg, pitch ${fixed(pitch, 1)} deg.`);
  }
  if (now.vibration_g !== null) words.push(`Vibration: ${fixed(now.vibration_g, 4)} g.`);
  byId("attitude").hidden = words.length === 0;
  byId("attitude").textContent = words.join(" ");
}

function showExplained(explained) {
  byId("inputs").hidden = explained === null;
  if (explained === null) return;
  byId("explained").tBodies[0].replaceChildren(...explained.map(({ input, rate_dps: rates }) => {
    const row = element("tr");
    row.append(element("th", "", input), ...rates.map((rate) => element("td", "", fixed(rate, 5))));
    return row;
  }));
}

function showStops(now) {
  const calm = now.calm_percent === null ? "" : ` Of the newest one, ${now.calm_percent} % was calm enough to learn from.`;
  byId("stops").textContent = `${counted(now.stops, "stop", "stops")} since the monitor was started.${calm}`;
}

function showLearnt(learnt) {
  byId("learnt").hidden = byId("legend").hidden = learnt === null;
  if (learnt === null) {
    byId("lesson").textContent = "Nothing yet. It learns whenever the vehicle stands still.";
    return;
  }
  const loosest = Math.max(...AXES.map((_, i) => learnt.bias_instability_sigma_dph[i] / learnt.bias_instability_dph[i]));
  byId("lesson").textContent = `Learnt from ${counted(Number(learnt.stops.toFixed(1)), "stop", "stops")}` +
    ` (older ones count in part). The wander of the bias is known to ± ${Math.ceil(100 * loosest)} %.`;
  byId("learnt").tBodies[0].replaceChildren(...AXES.map((axis, i) => {
    const row = element("tr");
    row.append(element("th", "", axis),
      element("td", "", withSigma(learnt.bias_instability_dph[i], learnt.bias_instability_sigma_dph[i])),
      element("td", "", withSigma(learnt.angle_random_walk_dps_per_sqrt_hz[i], learnt.angle_random_walk_sigma_dps_per_sqrt_hz[i])),
      element("td", "", withSigma(learnt.order[i], learnt.order_sigma[i])));
    return row;
  }));
}

function showNow(now) {
  showHealth(now);
  showAxes(now);
  byId("since").textContent = now.silent_s === null && !now.wrong.includes("odometer_fault") ? since(now) : "";
  showVertical(now.vertical);
  showAttitude(now);
  showExplained(now.explained);
  showStops(now);
  showLearnt(now.learnt);
  byId("link").textContent = `From ${now.source}: ${now.messages} messages, ${now.lost} lost, ${now.damaged} damaged, ` +
    `${counted(now.restarts, "restart", "restarts")} of the node.`;
}

// Rows of the history: time, for each axis bias and half-width of its interval, whether it stood.
const STILL = 7;
let points = [];

const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

function paintRests(plot) {
  const { left, top, width, height } = plot.bbox;
  const bar = 4 * devicePixelRatio;
  plot.ctx.fillStyle = ink("green");
  points.forEach((point, i) => {
    if (point[STILL] !== 1) return;
    const begin = Math.round(plot.valToPos(point[0], "x", true));
    const end = i + 1 < points.length ? Math.round(plot.valToPos(points[i + 1][0], "x", true)) : begin + 1;
    plot.ctx.fillRect(Math.max(begin, left), top + height - bar, Math.min(end, left + width) - Math.max(begin, left), bar);
  });
}

function clock(plot, times) {
  const isLong = plot.scales.x.max - plot.scales.x.min > 600;
  return times.map((time) => new Date(time * 1000).toTimeString().slice(0, isLong ? 5 : 8));
}

const CHART_HEIGHT = 150;

function makeChart(place) {
  const line = { stroke: () => ink("blue"), width: 2, points: { show: false } };
  const bound = { stroke: "transparent", points: { show: false } };
  const axis = { font: "13px system-ui, sans-serif", stroke: () => ink("muted"), grid: { stroke: () => ink("grid"), width: 1 }, ticks: { show: false } };
  return new uPlot({
    width: place.clientWidth,
    height: CHART_HEIGHT,
    padding: [8, 30, 0, 0],
    legend: { show: false },
    cursor: { show: false },
    series: [{}, { ...bound }, { ...bound }, line],
    bands: [{ series: [2, 1], fill: () => ink("band") }],
    axes: [{ ...axis, space: 90, size: 28, values: clock },
      { ...axis, space: 34, size: 62, values: (_, numbers) => numbers.map(String) }],
    hooks: { draw: [paintRests] },
  }, [[], [], [], []], place);
}

function makeCard(name) {
  const card = element("div", "axis");
  const rate = element("span", "", "–");
  const rateLine = element("p", "rate");
  rateLine.append(rate, element("small", "", " deg/s"));
  const bias = element("span", "", "–");
  const biasLine = element("p", "bias");
  const biasName = element("small");
  biasLine.append(biasName, bias, element("small", "", " deg/s"));
  const turn = element("span", "", "–");
  const turnLine = element("p", "bias");
  turnLine.append(element("small", "", "turned since departure "), turn, element("small", "", " deg"));
  const place = element("div", "chart");
  card.append(element("h2", "", `${name}: turning at`), rateLine, biasLine, turnLine, place);
  byId("axes").append(card);
  return { rate, bias, biasName, turn, place };
}

const cards = AXES.map(makeCard);
const charts = cards.map((card) => makeChart(card.place));

function drawCharts() {
  const times = points.map((point) => point[0]);
  charts.forEach((chart, i) => {
    const [bias, half] = [1 + 2 * i, 2 + 2 * i];
    const at = (sign) => points.map((point) => (point[half] === null ? null : point[bias] + sign * point[half]));
    chart.setData([times, at(-1), at(1), points.map((point) => point[bias])]);
  });
  byId("axes").dataset.points = points.length;
}

addEventListener("resize", () => charts.forEach((chart, i) =>
  chart.setSize({ width: cards[i].place.clientWidth, height: CHART_HEIGHT })));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => charts.forEach((chart) => chart.redraw()));

// Nothing of the past may look like the present.
function lose(remedy) {
  document.documentElement.dataset.live = "false";
  showState("lost", "No connection", "the monitor does not answer", [["No rate is known now", remedy]]);
  byId("since").textContent = "";
  dim(true);
  cards.forEach((card) => { card.rate.textContent = "–"; });
}

let watch = 0;
function isAlive() {
  clearTimeout(watch);
  watch = setTimeout(() => lose("Is 'zerorate monitor' still running? This page goes on by itself as soon as it answers."), SILENT_AFTER_MS);
}

const events = new EventSource("/events");
events.onmessage = (event) => {
  isAlive();
  const message = JSON.parse(event.data);
  if (message.anew) points = [];
  points = points.concat(message.points).slice(-MOST_POINTS);
  showNow(message.now);
  if (message.points.length > 0) drawCharts();
  document.documentElement.dataset.live = "true";
};
events.addEventListener("alive", isAlive);
events.onerror = () => {
  clearTimeout(watch);
  lose(events.readyState === EventSource.CLOSED
    ? "Too many pages are open. Close one and reload this one."
    : "Is 'zerorate monitor' still running? This page goes on by itself as soon as it answers.");
};
isAlive();
