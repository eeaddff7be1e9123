// Numbers as a reader expects them: a true minus, narrow spaces, powers of ten with superscripts.

const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

function powerOfTen(exponent) {
  const digits = [...String(Math.abs(exponent))].map((digit) => SUPERSCRIPTS[digit]).join("");
  return `10${exponent < 0 ? "⁻" : ""}${digits}`;
}

function typeset(text) {
  const [integer, fraction] = text.replace("-", "−").split(".");
  const grouped = integer.length < 5 ? integer : integer.replace(/\B(?=(\d{3})+$)/g, "\u202f");
  return fraction === undefined ? grouped : `${grouped}.${fraction}`;
}

// With five significant digits, for read-outs and tables.
function formatNumber(value) {
  if (value === null || value === undefined) return "–";
  const magnitude = Math.abs(value);
  if (magnitude === 0 || (magnitude >= 1e-3 && magnitude < 1e6)) {
    return typeset(String(Number(value.toPrecision(magnitude < 1e5 ? 5 : 6))));
  }
  const [mantissa, exponent] = value.toExponential(3).split("e");
  return `${typeset(String(Number(mantissa)))} × ${powerOfTen(Number(exponent))}`;
}

// All ticks of a linear axis with the decimals that their spacing needs.
function formatTicks(ticks, spacing) {
  if (spacing < 1e-4 || Math.max(...ticks.map(Math.abs)) >= 1e7) return ticks.map(formatNumber);
  let decimals = 0;
  while (decimals < 6 && Math.abs(spacing * 10 ** decimals % 1) > 1e-6 * decimals) decimals += 1;
  return ticks.map((tick) => typeset((Math.round(tick / spacing) * spacing).toFixed(decimals)));
}

// All ticks of a logarithmic axis, null for those without a label: plain, or all as powers of ten.
function formatMagnitudes(ticks) {
  const isPlain = (tick) => tick === null || (tick > 0.99e-3 && tick < 1e5);
  const format = ticks.every(isPlain) ? (tick) => typeset(String(Number(tick.toPrecision(5)))) : formatPower;
  return ticks.map((tick) => (tick === null ? "" : format(tick)));
}

function formatPower(tick) {
  const exponent = Math.floor(Math.log10(tick) + 1e-9);
  const mantissa = Number((tick / 10 ** exponent).toPrecision(3));
  return mantissa === 1 ? powerOfTen(exponent) : `${mantissa} × ${powerOfTen(exponent)}`;
}

// Ticks of a linear axis at 1, 2 or 5 times a power of ten, about `count` of them.
function linearTicks(least, greatest, count) {
  const rough = (greatest - least) / count;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const spacing = decade * [1, 2, 5, 10].find((step) => step * decade >= rough * 0.999);
  const ticks = [];
  for (let i = Math.ceil(least / spacing - 1e-9); i * spacing <= greatest + 1e-9 * spacing; i += 1) {
    ticks.push(i * spacing);
  }
  return { ticks, spacing };
}
