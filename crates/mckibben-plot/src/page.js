// Draws the figures of a page so that they can be zoomed, read at the cursor and thinned out. It loads nothing.
"use strict";
const WIDTH = 860, LEFT = 70, RIGHT = 16, TOP = 8, HEIGHT = 170, BOTTOM = 24;
const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
const written = (value) => (Number.isFinite(value) ? Number(value.toPrecision(5)).toString().replace("-", "−") : "–");

// A scale from values to places on the page.
function scale(axis, low, high, from, to) {
  const f = axis.log ? Math.log10 : (v) => v;
  const [a, b] = [f(low), f(high)];
  return {
    low, high,
    place: (v) => from + ((f(v) - a) / (b - a)) * (to - from),
    value: (p) => { const v = a + ((p - from) / (to - from)) * (b - a); return axis.log ? 10 ** v : v; },
  };
}

// Round values between two ends.
function ticks(axis, low, high, most) {
  if (axis.words.length) return axis.words.filter(([v]) => v >= low && v <= high);
  if (axis.log && Math.log10(high / low) > 1) {
    const all = [];
    for (let k = Math.ceil(Math.log10(low) - 1e-9); k <= Math.log10(high) + 1e-9; k += 1) all.push([10 ** k, `1e${k}`]);
    return all.filter((_, i) => i % Math.ceil(all.length / most) === 0);
  }
  const least = (high - low) / most, power = 10 ** Math.floor(Math.log10(least));
  const step = power * [1, 2, 5, 10].find((m) => m * power >= least * (1 - 1e-9));
  const all = [];
  for (let n = Math.ceil(low / step - 1e-9); n <= Math.floor(high / step + 1e-9); n += 1) all.push([n * step, written(n * step)]);
  return all;
}

const usable = (axis, v) => v !== null && Number.isFinite(v) && (!axis.log || v > 0);

// The least and the greatest of what is seen of a panel, with a margin.
function range(panel, hidden, x) {
  let low = Infinity, high = -Infinity;
  const see = (at, v) => { if (at >= x.low && at <= x.high && usable(panel.y, v)) { low = Math.min(low, v); high = Math.max(high, v); } };
  for (const s of panel.series) if (!hidden.has(s.key)) s.x.forEach((at, i) => see(at, s.y[i]));
  for (const b of panel.bands) if (!hidden.has(b.key)) b.x.forEach((at, i) => { see(at, b.lower[i]); see(at, b.upper[i]); });
  const full = x.low === x.first && x.high === x.last;
  if (full && panel.y.min !== null) low = panel.y.min;
  if (full && panel.y.max !== null) high = panel.y.max;
  if (!(low < high)) return Number.isFinite(low) ? [low - Math.abs(low || 1) / 20, low + Math.abs(low || 1) / 20] : [0.1, 1];
  if (full && panel.y.min !== null && panel.y.max !== null) return [low, high];
  return panel.y.log ? [low / 1.2, high * 1.2] : [low - 0.05 * (high - low), high + 0.05 * (high - low)];
}

// The path of a curve, which is broken where a value is missing.
function path(panel, series, x, y) {
  let text = "", pen = false, last = 0;
  series.x.forEach((at, i) => {
    const v = series.y[i];
    if (!usable(panel.y, v) || !usable(x.axis, at)) { pen = false; return; }
    const [px, py] = [x.place(at), y.place(v)];
    if (pen && series.steps) text += `L${px.toFixed(1)} ${last.toFixed(1)}`;
    text += `${pen ? "L" : "M"}${px.toFixed(1)} ${py.toFixed(1)}`;
    last = py;
    pen = true;
  });
  return text;
}

function draw(panel, index, x, hidden) {
  const [low, high] = range(panel, hidden, x);
  const y = scale(panel.y, low, high, TOP + HEIGHT, TOP);
  // What leaves the axes is cut off by a picture in the picture.
  const [across, down] = [WIDTH - RIGHT - LEFT, HEIGHT];
  const clip = `x="${LEFT}" y="${TOP}" width="${across}" height="${down}" viewBox="${LEFT} ${TOP} ${across} ${down}"`;
  let out = "", inner = "";
  for (const [v, word] of ticks(x.axis, x.low, x.high, 10))
    out += `<path class="grid" d="M${x.place(v)} ${TOP}V${TOP + HEIGHT}"/><text x="${x.place(v)}" y="${TOP + HEIGHT + 15}" text-anchor="middle">${escaped(word)}</text>`;
  for (const [v, word] of ticks(panel.y, low, high, 6))
    out += `<path class="grid" d="M${LEFT} ${y.place(v)}H${WIDTH - RIGHT}"/><text x="${LEFT - 6}" y="${y.place(v) + 4}" text-anchor="end">${escaped(word)}</text>`;
  panel.strips.forEach((s, row) => s.intervals.forEach(([a, b]) => {
    const [from, to] = [Math.max(x.place(a), LEFT), Math.min(x.place(b), WIDTH - RIGHT)];
    if (to > from) out += `<rect x="${from}" y="${TOP + 4 * row}" width="${to - from}" height="3" fill="${s.colour}"/>`;
  }));
  for (const b of panel.bands.filter((b) => !hidden.has(b.key))) {
    const edge = (values) => b.x.map((at, i) => `${x.place(at).toFixed(1)} ${y.place(values[i]).toFixed(1)}`);
    inner += `<path d="M${edge(b.upper).concat(edge(b.lower).reverse()).join("L")}Z" fill="${b.colour}" opacity="0.2"/>`;
  }
  for (const r of panel.references) inner += `<path class="rule" d="M${LEFT} ${y.place(r.y)}H${WIDTH - RIGHT}"/><text class="muted" x="${WIDTH - RIGHT - 4}" y="${y.place(r.y) - 3}" text-anchor="end">${escaped(r.label)}</text>`;
  for (const s of panel.series.filter((s) => !hidden.has(s.key))) {
    if (s.points) s.x.forEach((at, i) => { if (usable(panel.y, s.y[i])) inner += `<circle cx="${x.place(at).toFixed(1)}" cy="${y.place(s.y[i]).toFixed(1)}" r="1.8" fill="${s.colour}"/>`; });
    else inner += `<path d="${path(panel, s, x, y)}" fill="none" stroke="${s.colour}" stroke-width="1.5" stroke-dasharray="${s.dash}"/>`;
  }
  for (const m of panel.marks) m.x.forEach((at, i) => {
    const py = m.y.length ? y.place(m.y[i]) : TOP + 8;
    inner += `<circle cx="${x.place(at).toFixed(1)}" cy="${py.toFixed(1)}" r="3.5" fill="${m.filled ? m.colour : "none"}" stroke="${m.colour}"><title>${escaped(m.label)} at ${written(at)}</title></circle>`;
  });
  out += `<svg ${clip}>${inner}</svg><path class="axis" fill="none" d="M${LEFT} ${TOP}V${TOP + HEIGHT}H${WIDTH - RIGHT}"/>`;
  out += `<text transform="translate(14 ${TOP + HEIGHT / 2}) rotate(-90)" text-anchor="middle">${escaped(panel.y.title)}</text>`;
  return `<svg data-panel="${index}" viewBox="0 0 ${WIDTH} ${TOP + HEIGHT + BOTTOM}">${out}<path class="cursor" d=""/></svg>`;
}

// The value of a curve at a place of the horizontal axis.
function at(series, value) {
  const i = series.x.findIndex((v) => v >= value);
  if (i < 0) return NaN;
  if (i === 0 || series.steps) return series.y[Math.max(0, series.x[i] > value ? i - 1 : i)];
  const part = (value - series.x[i - 1]) / (series.x[i] - series.x[i - 1] || 1);
  return series.y[i - 1] + part * (series.y[i] - series.y[i - 1]);
}

function show(figure, place) {
  const hidden = new Set(), { min, max } = figure.x;
  let view = [min, max], from = null;
  const box = document.createElement("section"), read = document.createElement("p");
  read.className = "read";
  const axis = () => Object.assign(scale(figure.x, view[0], view[1], LEFT, WIDTH - RIGHT), { axis: figure.x, first: min, last: max });
  const names = [];
  for (const s of figure.panels.flatMap((p) => p.series).filter((s) => s.label)) {
    const known = names.find((name) => name.key === s.key);
    if (!known) names.push({ key: s.key, colour: s.colour, label: s.label });
    else if (!known.label.split(", ").includes(s.label)) known.label += `, ${s.label}`;
  }
  const redraw = () => {
    const buttons = names.map((s) => `<button data-key="${escaped(s.key)}" class="${hidden.has(s.key) ? "off" : ""}"><i style="background:${s.colour}"></i>${escaped(s.label)}</button>`).join("");
    box.innerHTML = `<div class="names">${buttons}</div>${figure.panels.map((p, i) => draw(p, i, axis(), hidden)).join("")}<p class="muted">${escaped(figure.x.title)}</p>`;
    box.append(read);
  };
  const value = (event) => {
    const svg = event.target.closest("svg[data-panel]");
    if (!svg) return null;
    const frame = svg.getBoundingClientRect();
    const px = ((event.clientX - frame.left) / frame.width) * WIDTH;
    return axis().value(Math.min(Math.max(px, LEFT), WIDTH - RIGHT));
  };
  box.addEventListener("click", (event) => {
    const key = event.target.closest("button")?.dataset.key;
    if (key === undefined) return;
    if (!hidden.delete(key)) hidden.add(key);
    redraw();
  });
  box.addEventListener("mousedown", (event) => { from = value(event); if (from !== null) event.preventDefault(); });
  box.addEventListener("mouseup", (event) => {
    const to = value(event);
    if (from !== null && to !== null && Math.abs(axis().place(to) - axis().place(from)) > 4) { view = [Math.min(from, to), Math.max(from, to)]; redraw(); }
    from = null;
  });
  box.addEventListener("dblclick", () => { view = [min, max]; redraw(); });
  box.addEventListener("mousemove", (event) => {
    const now = value(event);
    if (now === null) return;
    const line = `M${axis().place(now)} ${TOP}v${HEIGHT}` + (from === null ? "" : `M${axis().place(from)} ${TOP}v${HEIGHT}`);
    box.querySelectorAll(".cursor").forEach((cursor) => cursor.setAttribute("d", line));
    const words = figure.panels.map((p) => `${p.y.title}: ` + p.series.filter((s) => s.x.length && !hidden.has(s.key)).map((s) => written(at(s, now))).join(", "));
    read.textContent = [`${figure.x.title}: ${written(now)}`].concat(words).join(" · ");
  });
  redraw();
  place.append(box);
}

const page = JSON.parse(document.getElementById("data").textContent);
page.figures.forEach((figure) => show(figure, document.querySelector("main")));
