"use strict";
// The page's life: walks that play, cursors that follow them, values under the pointer. Data stands in the page.

const SVG = "http://www.w3.org/2000/svg";
const node = (name, attributes, parent) => {
  const element = document.createElementNS(SVG, name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (parent) parent.append(element);
  return element;
};
const clamp = (x, a, b) => Math.min(Math.max(x, a), b);
const digits = x => {
  const size = Math.abs(x);
  const text = x === 0 || (size >= 1e-3 && size < 1e6) ? Number(x.toPrecision(5)).toString() : x.toExponential(4).replace("+", "");
  return text.replaceAll("-", "−");
};

// ------------------------------------------------------------------------------------------------ figures

const tip = document.getElementById("tip");

/** Tells some rows, each with an ink or none, beside a place of the window. */
const tell = (rows, x, y) => {
  tip.replaceChildren(...rows.map(([ink, text]) => {
    const row = document.createElement("div");
    if (ink) row.append(Object.assign(document.createElement("i"), { style: `background:var(--${ink})` }));
    row.append(text);
    return row;
  }));
  tip.hidden = rows.length === 0;
  const right = x + 16 + tip.offsetWidth > innerWidth;
  tip.style.left = `${Math.max(4, right ? x - 16 - tip.offsetWidth : x + 16)}px`;
  tip.style.top = `${clamp(y - 12, 4, innerHeight - tip.offsetHeight - 4)}px`;
};

/** Where the pointer is in a drawing. */
const within = (svg, event) => {
  const box = svg.getBoundingClientRect();
  const factor = svg.viewBox.baseVal.width / box.width;
  return [(event.clientX - box.left) * factor, (event.clientY - box.top) * factor];
};

/** A drawn plot: tells values, and has a cursor where its first axis is time. */
class Plot {
  constructor(element, data, onTime) {
    this.svg = element.querySelector("svg");
    this.data = data;
    this.onTime = data.time ? onTime : null;
    // Along the first axis values are told where there are some; elsewhere of the nearest point of all.
    this.ordered = data.curves.every(c => c.x.every((x, k) => k === 0 || x >= c.x[k - 1]));
    element.dataset.live = "";
    const [a, b] = data.y.range;
    const line = name => node("line", { class: name, y1: b, y2: a, visibility: "hidden" }, this.svg);
    this.hair = line("s-muted");
    this.cursor = line("s-text");
    this.cursor.setAttribute("stroke-width", 1.2);
    this.dots = data.curves.map(c => node("circle", { r: 3.4, class: `f-${c.ink}`, visibility: "hidden" }, this.svg));
    let down = false;
    this.svg.addEventListener("pointermove", e => { this.point(e); if (down) this.seek(e); });
    this.svg.addEventListener("pointerdown", e => { down = true; this.point(e); this.seek(e); });
    this.svg.addEventListener("pointerleave", () => { down = false; this.leave(); });
    this.svg.addEventListener("pointerup", () => { down = false; });
  }

  place(axis, value) {
    const { domain: [a, b], range: [from, to] } = this.data[axis];
    return from + (value - a) / (b - a) * (to - from);
  }

  /** The point of any curve that is nearest on the first axis; `value` itself where there are no curves. */
  nearest(value) {
    let best = value, least = Infinity;
    for (const { x } of this.data.curves) for (const at of x) {
      if (Math.abs(at - value) < least) { least = Math.abs(at - value); best = at; }
    }
    return best;
  }

  /** Where the pointer is, in the drawing and on the first axis (at a point of the curves, if these run along it); nothing outside of the axes. */
  under(event) {
    const [x, y] = within(this.svg, event);
    const { domain: [a, b], range: [from, to] } = this.data.x;
    if (x < from - 8 || x > to + 8) return null;
    const value = clamp(a + (x - from) / (to - from) * (b - a), a, b);
    return { x, y, value: this.ordered ? this.nearest(value) : value };
  }

  seek(event) {
    const at = this.under(event);
    if (at && this.onTime) this.onTime(at.value);
  }

  point(event) {
    const at = this.under(event);
    if (!at) return this.leave();
    const { x: axis, y: { unit }, curves } = this.data;
    const hits = curves.map(c => {
      if (this.ordered) return { k: c.x.indexOf(at.value) };
      let found = { k: -1, least: Infinity };
      c.x.forEach((x, k) => {
        const dx = this.place("x", x) - at.x, dy = this.place("y", c.y[k]) - at.y, least = dx * dx + dy * dy;
        if (least < found.least) found = { k, least };
      });
      return found;
    });
    const best = Math.min(...hits.map(hit => hit.least));
    const rows = [];
    this.dots.forEach((dot, i) => {
      const { k, least } = hits[i], c = curves[i];
      const shown = k >= 0 && (this.ordered || least === best);
      dot.setAttribute("visibility", shown ? "visible" : "hidden");
      if (!shown) return;
      dot.setAttribute("cx", this.place("x", c.x[k]));
      dot.setAttribute("cy", this.place("y", c.y[k]));
      const pair = this.ordered ? "" : `${digits(c.x[k])} ${axis.unit}, `;
      rows.push([c.ink, `${c.name ? c.name + "  " : ""}${pair}${digits(c.y[k])} ${unit}`]);
    });
    if (this.ordered) {
      const x = this.place("x", at.value);
      this.hair.setAttribute("visibility", "visible");
      this.hair.setAttribute("x1", x);
      this.hair.setAttribute("x2", x);
      rows.unshift([null, `${axis.name} ${digits(at.value)} ${axis.unit}`]);
    }
    tell(rows, event.clientX, event.clientY);
  }

  leave() {
    tip.hidden = true;
    for (const mark of [this.hair, ...this.dots]) mark.setAttribute("visibility", "hidden");
  }

  show(time) {
    const x = this.place("x", time);
    this.cursor.setAttribute("x1", x);
    this.cursor.setAttribute("x2", x);
    this.cursor.setAttribute("visibility", "visible");
  }
}

// -------------------------------------------------------------------------------------------------- study

/** Farther from the pointer than this, in the drawing, nothing is meant. */
const NEAR = 14;
/** Who moves less does not drag. */
const CLICK = 3;

const distance = ([x, y], [ax, ay], [bx, by]) => {
  const [dx, dy] = [bx - ax, by - ay], length = dx * dx + dy * dy;
  const w = length > 0 ? clamp(((x - ax) * dx + (y - ay) * dy) / length, 0, 1) : 0;
  return Math.hypot(ax + w * dx - x, ay + w * dy - y);
};

/** The robots of a study: every line and every dot is one, told under the pointer and by keys; ranges of axes select some. */
class Space {
  constructor(section, space, figures, of) {
    this.numbers = space.numbers;
    this.units = space.units;
    this.all = space.designs;
    this.spots = space.spots.map(([design, gait, criterion, speed, costs, status, numbers]) =>
      ({ design, gait, criterion, speed, costs, status, numbers, marks: [] }));
    this.brushes = new Map();
    this.figures = [];
    for (const element of section.querySelectorAll("figure")) {
      if (element.querySelector("[data-k]")) this.figures.push(this.figure(element, figures[element.dataset.figure.slice(of.length + 1)]));
    }
    this.bar(section);
    this.select();
  }

  /** What is selected, in words, before the first figure. */
  bar(section) {
    const first = section.querySelector(".gallery"), bar = document.createElement("p");
    bar.className = "selection";
    this.words = document.createElement("output");
    this.words.setAttribute("role", "status");
    this.clear = Object.assign(document.createElement("button"), { type: "button", textContent: "Clear" });
    this.clear.addEventListener("click", () => { this.brushes.clear(); this.select(); });
    const note = Object.assign(document.createElement("span"), { className: "note" });
    note.textContent = "Drag along an axis to select, click it to let go. Point at a line or a dot, or use the arrow keys, to read a robot.";
    bar.append(this.words, this.clear, note);
    first.before(bar);
  }

  figure(element, data) {
    const svg = element.querySelector("svg"), figure = { svg, spots: [], axes: data?.axes ?? [], copies: [], at: -1 };
    element.dataset.live = "";
    svg.setAttribute("tabindex", "0");
    for (const mark of svg.querySelectorAll("[data-k]")) {
      const spot = this.spots[mark.dataset.k];
      const points = mark.tagName === "circle"
        ? [[+mark.getAttribute("cx"), +mark.getAttribute("cy")]]
        : mark.getAttribute("d").slice(1).split("L").map(p => p.split(" ").map(Number));
      spot.marks.push({ figure, mark });
      figure.spots.push({ spot, points, mark });
    }
    // Keys lead from the best to the worst.
    figure.spots.sort((a, b) => this.cost(a.spot) - this.cost(b.spot));
    for (const axis of figure.axes) this.axis(figure, axis);
    svg.addEventListener("pointermove", e => {
      if (figure.dragged) return;
      const [least, found] = this.nearest(figure, within(svg, e));
      if (least <= NEAR) this.show(found.spot, e.clientX, e.clientY); else this.hide();
    });
    svg.addEventListener("pointerleave", () => { if (!figure.dragged) this.hide(); });
    svg.addEventListener("focus", () => { if (svg.matches(":focus-visible")) this.step(figure, 0); });
    svg.addEventListener("blur", () => this.hide());
    svg.addEventListener("keydown", e => {
      const steps = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1, Home: -Infinity, End: Infinity };
      if (e.key in steps) { e.preventDefault(); this.step(figure, steps[e.key]); }
      if (e.key === "Escape") this.hide();
    });
    return figure;
  }

  /** An axis along which a range is dragged. */
  axis(figure, axis) {
    const [bottom, top] = axis.range, [a, b] = axis.domain;
    const value = y => a + (clamp(y, top, bottom) - bottom) / (top - bottom) * (b - a);
    axis.place = v => bottom + (v - a) / (b - a) * (top - bottom);
    axis.brush = node("rect", { class: "brush", x: axis.x - 7, width: 14, visibility: "hidden" }, figure.svg);
    const grip = node("rect", { class: "grip", x: axis.x - 12, width: 24, y: top - 6, height: bottom - top + 12, "data-axis": axis.key }, figure.svg);
    grip.addEventListener("pointerdown", e => {
      e.preventDefault();
      grip.setPointerCapture(e.pointerId);
      figure.dragged = { from: value(within(figure.svg, e)[1]), moved: false };
      this.hide();
    });
    grip.addEventListener("pointermove", e => {
      if (!figure.dragged) return;
      const to = value(within(figure.svg, e)[1]), range = [figure.dragged.from, to].sort((p, q) => p - q);
      figure.dragged.moved ||= Math.abs(axis.place(range[1]) - axis.place(range[0])) > CLICK;
      if (!figure.dragged.moved) return;
      this.brushes.set(axis.key, { axis, range });
      this.select();
      tell([[null, `${axis.name}: ${digits(range[0])} to ${digits(range[1])}`]], e.clientX, e.clientY);
    });
    const end = () => {
      if (!figure.dragged) return;
      if (!figure.dragged.moved) this.brushes.delete(axis.key);
      figure.dragged = null;
      tip.hidden = true;
      this.select();
    };
    grip.addEventListener("pointerup", end);
    grip.addEventListener("pointercancel", end);
  }

  cost(spot) {
    return spot.costs[spot.criterion === "energy" ? 0 : 1];
  }

  nearest(figure, at) {
    let least = Infinity, found = null;
    for (const entry of figure.spots) {
      if (entry.spot.faded) continue;
      const { points } = entry;
      let d = points.length === 1 ? Math.hypot(points[0][0] - at[0], points[0][1] - at[1]) : Infinity;
      for (let k = 1; k < points.length; k++) d = Math.min(d, distance(at, points[k - 1], points[k]));
      if (d < least) { least = d; found = entry; }
    }
    return [least, found];
  }

  /** By keys to the next of those that are selected. */
  step(figure, by) {
    const open = figure.spots.filter(({ spot }) => !spot.faded);
    if (open.length === 0) return this.hide();
    figure.at = clamp(figure.at + by, 0, open.length - 1);
    const { spot, mark } = open[figure.at], box = mark.getBoundingClientRect();
    this.show(spot, box.right, box.top);
  }

  show(spot, x, y) {
    this.hide();
    const { design, gait, criterion, speed, costs, status, numbers } = spot;
    tell([
      [null, `Design ${design}: ${gait.replaceAll("_", " ")}, least ${criterion} at ${digits(speed)} m/s`],
      ...numbers.map((value, k) => [null, `${this.numbers[k]} = ${digits(value)}`]),
      ...["energy", "torque"].map((name, k) => [null, `${name} ${digits(costs[k])} ${this.units[k]}`]),
      [null, status],
    ], x, y);
    // On top of all others, in every figure.
    for (const { figure, mark } of spot.marks) {
      const copy = mark.cloneNode();
      copy.removeAttribute("data-k");
      copy.classList.remove("faded");
      copy.classList.add("hot");
      figure.svg.append(copy);
      figure.copies.push(copy);
    }
  }

  hide() {
    tip.hidden = true;
    for (const figure of this.figures) {
      for (const copy of figure.copies) copy.remove();
      figure.copies = [];
    }
  }

  /** Fades what is outside of a range. A range of costs is one of robots: it holds for their other questions too. */
  select() {
    const has = (spot, { axis, range: [from, to] }) => {
      const value = axis.key === "speed" ? spot.speed : axis.name === "cost" ? this.cost(spot) : spot.numbers[axis.key];
      return value >= from && value <= to;
    };
    const isOf = (spot, { axis }) => axis.name !== "cost" || axis.key === `cost ${spot.gait} ${spot.criterion}`;
    const brushes = [...this.brushes.values()];
    const robots = brushes.map(brush => new Set(this.spots.filter(spot => isOf(spot, brush) && has(spot, brush)).map(spot => spot.design)));
    for (const spot of this.spots) {
      spot.faded = !brushes.every((brush, k) => isOf(spot, brush) ? has(spot, brush) : robots[k].has(spot.design));
      for (const { mark } of spot.marks) mark.classList.toggle("faded", spot.faded);
    }
    for (const { axes } of this.figures) for (const axis of axes) {
      const brush = this.brushes.get(axis.key);
      axis.brush.setAttribute("visibility", brush ? "visible" : "hidden");
      if (!brush) continue;
      const [y, end] = [axis.place(brush.range[1]), axis.place(brush.range[0])];
      axis.brush.setAttribute("y", y);
      axis.brush.setAttribute("height", Math.max(end - y, 1));
    }
    const count = spots => new Set(spots.map(spot => spot.design)).size;
    const drawn = count(this.spots), open = this.spots.filter(spot => !spot.faded);
    const of = drawn < this.all ? ` drawn, of ${this.all} asked about` : "";
    this.words.value = brushes.length === 0
      ? `${drawn} robots with an optimum${of}`
      : `${count(open)} of ${drawn} robots selected, ${open.length} of ${this.spots.length} optima`;
    this.clear.hidden = brushes.length === 0;
    for (const figure of this.figures) {
      figure.at = -1;
      figure.svg.classList.toggle("chosen", brushes.length > 0);
    }
  }
}

// --------------------------------------------------------------------------------------------------- walk

const VIEWS = { side: [0, 0], behind: [90, 0], space: [-38, 18] };
const WIDTH = 800, HEIGHT = 400, GROUND = 318;

/** The robot in parallel projection, seen from `yaw` about the vertical and `pitch` above the ground. */
class Robot {
  constructor(svg, walk) {
    Object.assign(this, { svg, walk, yaw: 0, pitch: 0, scale: .205 });
    this.floor = node("g", {}, svg);
    this.paths = node("g", {}, svg);
    this.body = node("g", {}, svg);
    this.forces = node("g", {}, svg);
    this.plate = node("path", { class: "f-axis s-muted", "stroke-width": 1.5, "stroke-linejoin": "round", "fill-opacity": .55 });
    this.legs = walk.legs.map(leg => {
      const g = node("g", {});
      const bones = node("path", { class: `s-leg${leg.leg}`, fill: "none", "stroke-width": 8, "stroke-linejoin": "round", "stroke-linecap": "round" }, g);
      const path = node("path", { class: `s-leg${leg.leg}`, fill: "none", "stroke-width": 2, "stroke-dasharray": "0 5", "stroke-linecap": "round" }, this.paths);
      const arrow = node("path", { class: "s-text", fill: "none", "stroke-width": 2.4, "stroke-linecap": "round", "stroke-linejoin": "round" }, this.forces);
      return { g, bones, path, arrow, joints: [] };
    });
    this.lines = Array.from({ length: 40 }, () => node("path", { class: "s-grid", fill: "none", "stroke-width": 1.5 }, this.floor));
    this.ground = node("path", { class: "s-axis", fill: "none", "stroke-width": 1.5 }, this.floor);
    this.labels = Array.from({ length: 16 }, () => node("text", { class: "f-muted", "font-size": 13, "text-anchor": "middle" }, this.floor));
  }

  look(yaw, pitch) {
    [this.yaw, this.pitch] = [yaw, pitch];
    const [a, b] = [yaw, pitch].map(x => x * Math.PI / 180);
    this.right = [Math.cos(a), 0, Math.sin(a)];
    this.up = [Math.sin(a) * Math.sin(b), Math.cos(b), -Math.cos(a) * Math.sin(b)];
    this.toward = [-Math.sin(a) * Math.cos(b), Math.sin(b), Math.cos(a) * Math.cos(b)];
    // Far legs first, then the platform, then near legs.
    const depth = leg => leg.mount.reduce((sum, m, k) => sum + m * this.toward[k], 0);
    const order = this.walk.legs.map((leg, k) => [depth(leg), k]).sort((p, q) => p[0] - q[0]);
    this.body.replaceChildren();
    let platform = false;
    for (const [d, k] of order) {
      if (d > 0 && !platform) { this.body.append(this.plate); platform = true; }
      this.legs[k].g.setAttribute("opacity", d < -1 ? .5 : 1);
      this.body.append(this.legs[k].g);
    }
    if (!platform) this.body.append(this.plate);
  }

  /** A point of the world (thousandths of a leg) in the drawing; `camera` is the x that stays in the middle. */
  at(x, y, z, camera) {
    const dot = v => v[0] * (x - camera) + v[1] * y + v[2] * z;
    return [WIDTH / 2 + this.scale * dot(this.right), GROUND - this.scale * dot(this.up)];
  }

  line(points, camera) {
    return points.map((p, k) => (k ? "L" : "M") + this.at(p[0], p[1], p[2], camera).map(v => v.toFixed(1)).join(" ")).join("");
  }

  draw(time, cycle) {
    const { frames, travel, duration, legs } = this.walk;
    const camera = (cycle + time / duration) * travel + this.offset();
    const shift = cycle * travel;
    let k = 1;
    while (k < frames.length - 1 && frames[k][0] < time) k++;
    const [before, after] = [frames[k - 1], frames[k]];
    const span = after[0] - before[0];
    const w = span > 0 ? clamp((time - before[0]) / span, 0, 1) : 1;
    const mix = (a, b) => a.map((v, i) => v + w * (b[i] - v));
    const platform = mix(before[2], after[2]);
    const forces = mix(before[3], after[3]);
    const stance = before[1];
    const triples = flat => flat.reduce((list, v, i) => (i % 3 ? list[list.length - 1].push(v) : list.push([v]), list), []);
    const hips = [[platform[0] + shift, platform[1], platform[2]]];
    legs.forEach((leg, i) => {
      const points = triples(mix(before[4][i], after[4][i])).map(([x, y, z]) => [x + shift, y, z]);
      const part = this.legs[i];
      hips.push(points[0]);
      part.bones.setAttribute("d", this.line(points, camera));
      points.forEach((p, n) => {
        part.joints[n] ||= node("circle", { r: n === points.length - 1 ? 6.5 : 4, class: n === points.length - 1 ? `f-leg${leg.leg}` : "f-paper" }, part.g);
        const [x, y] = this.at(...p, camera);
        part.joints[n].setAttribute("cx", x.toFixed(1));
        part.joints[n].setAttribute("cy", y.toFixed(1));
      });
      part.arrow.setAttribute("d", leg.leg === stance ? this.arrow(points[points.length - 1], forces.slice(3 * i, 3 * i + 3), camera) : "");
      const swing = frames.filter(f => f[1] !== leg.leg).map(f => {
        const foot = f[4][i].slice(-3);
        return [foot[0] + shift, foot[1], foot[2]];
      });
      part.path.setAttribute("d", this.line(swing, camera));
    });
    this.plate.setAttribute("d", this.hull(hips, camera));
    this.drawFloor(camera);
  }

  /** The middle of the robot relative to where a step begins. */
  offset() {
    return this.walk.frames[0][2][0];
  }

  arrow([x, y, z], force, camera) {
    // The robot's weight is an arrow of nine tenths of a leg.
    const tipAt = [x + .9 * force[0], y + .9 * force[1], z + .9 * force[2]];
    const [a, b] = [this.at(x, y, z, camera), this.at(...tipAt, camera)];
    const d = [b[0] - a[0], b[1] - a[1]], l = Math.hypot(...d);
    if (l < 6) return "";
    const [u, v] = [d[0] / l, d[1] / l];
    const barb = side => `${(b[0] - 9 * u + side * 5 * v).toFixed(1)} ${(b[1] - 9 * v - side * 5 * u).toFixed(1)}`;
    return `M${a.map(n => n.toFixed(1)).join(" ")}L${b.map(n => n.toFixed(1)).join(" ")}M${barb(1)}L${b.map(n => n.toFixed(1)).join(" ")}L${barb(-1)}`;
  }

  /** Outline of the platform. */
  hull(hips, camera) {
    const thick = 140;
    // The hips and the mass centre, which is a torso's middle where the robot is upright.
    const points = hips.flatMap(([x, y, z]) => [this.at(x, y, z, camera), this.at(x, y + thick, z, camera)]);
    points.sort((p, q) => p[0] - q[0] || p[1] - q[1]);
    const turn = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
    const half = list => list.reduce((chain, p) => {
      while (chain.length > 1 && turn(chain[chain.length - 2], chain[chain.length - 1], p) <= 0) chain.pop();
      chain.push(p);
      return chain;
    }, []);
    const outline = [...half(points).slice(0, -1), ...half(points.reverse()).slice(0, -1)];
    return "M" + outline.map(p => p.map(v => v.toFixed(1)).join(" ")).join("L") + "Z";
  }

  drawFloor(camera) {
    const { metre, half } = this.walk, step = this.walk.tick * metre, reach = Math.ceil(0.75 * WIDTH / this.scale / step);
    const middle = Math.round(camera / step);
    this.lines.forEach((line, i) => {
      const x = (middle - reach + i) * step;
      line.setAttribute("d", i <= 2 * reach ? this.line([[x, 0, -half], [x, 0, half]], camera) : "");
    });
    const [from, to] = [camera - reach * step, camera + reach * step];
    const edges = this.pitch === 0 ? [0] : [-half, half];
    this.ground.setAttribute("d", edges.map(z => this.line([[from, 0, z], [to, 0, z]], camera)).join(""));
    const every = 2, first = Math.ceil((camera - reach * step) / (every * step));
    this.labels.forEach((label, i) => {
      const x = (first + i) * every * step;
      const [px, py] = this.at(x, 0, half * (this.pitch === 0 ? 0 : 1), camera);
      const shown = Math.abs(this.right[0]) > .3 && px > 20 && px < WIDTH - 20 && py < HEIGHT - 26 && x <= to;
      label.textContent = shown ? `${digits(x / metre)} m` : "";
      label.setAttribute("x", px);
      label.setAttribute("y", py + 22);
    });
  }
}

/** Plays a walk over and over, and tells everybody the time. */
class Player {
  constructor(section, walk) {
    this.walk = walk;
    // Digits that tell a thousandth of the walk.
    this.places = Math.max(3, 2 - Math.floor(Math.log10(walk.duration)));
    this.time = 0;
    this.cycle = 0;
    this.playing = false;
    this.followers = [];
    this.robot = new Robot(section.querySelector(".stage svg"), walk);
    this.button = section.querySelector(".play");
    this.slider = section.querySelector(".time");
    this.clock = section.querySelector("output");
    this.rate = section.querySelector(".speed");
    this.views = [...section.querySelectorAll("[data-view]")];
    this.button.addEventListener("click", () => this.toggle());
    this.robot.svg.addEventListener("keydown", e => { if (e.key === " ") { e.preventDefault(); this.toggle(); } });
    this.slider.addEventListener("input", () => { this.stop(); this.seek(this.slider.value / 1000 * walk.duration); });
    for (const b of this.views) b.addEventListener("click", () => this.view(b.dataset.view));
    this.turnable();
    this.view("space");
  }

  /** Dragging turns the robot. */
  turnable() {
    const { svg } = this.robot;
    let last = null;
    svg.addEventListener("pointerdown", e => { last = e; svg.setPointerCapture(e.pointerId); });
    svg.addEventListener("pointerup", () => { last = null; });
    svg.addEventListener("pointercancel", () => { last = null; });
    svg.addEventListener("pointermove", e => {
      if (!last) return;
      const { yaw, pitch } = this.robot;
      this.robot.look(yaw - .5 * (e.clientX - last.clientX), clamp(pitch + .4 * (e.clientY - last.clientY), 0, 85));
      last = e;
      for (const b of this.views) b.setAttribute("aria-pressed", "false");
      this.draw();
    });
  }

  view(name) {
    this.robot.look(...VIEWS[name]);
    for (const b of this.views) b.setAttribute("aria-pressed", String(b.dataset.view === name));
    this.draw();
  }

  toggle() {
    if (this.playing) return this.stop();
    this.playing = true;
    this.button.textContent = "❚❚";
    this.button.setAttribute("aria-label", "Pause");
    let last = performance.now();
    const frame = now => {
      if (!this.playing) return;
      const t = this.time + (now - last) / 1000 * Number(this.rate.value);
      last = now;
      const { duration } = this.walk;
      this.cycle = (this.cycle + Math.floor(t / duration)) % 100;
      this.seek(t - Math.floor(t / duration) * duration);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  stop() {
    this.playing = false;
    this.button.textContent = "▶";
    this.button.setAttribute("aria-label", "Play");
  }

  seek(time) {
    this.time = clamp(time, 0, this.walk.duration);
    this.draw();
  }

  draw() {
    const { duration } = this.walk;
    this.robot.draw(this.time, this.cycle);
    this.slider.value = 1000 * this.time / duration;
    this.clock.value = `${this.time.toFixed(this.places)} of ${duration.toFixed(this.places)} s`;
    for (const plot of this.followers) plot.show(this.time);
  }
}

for (const script of document.querySelectorAll("script[data-of]")) {
  const { walk, space, figures } = JSON.parse(script.textContent);
  const section = script.closest("section");
  if (space) {
    new Space(section, space, figures, script.dataset.of);
    continue;
  }
  const player = walk ? new Player(section, walk) : null;
  for (const name in figures) {
    const element = section.querySelector(`[data-figure="${script.dataset.of}/${name}"]`);
    const plot = new Plot(element, figures[name], time => { player?.stop(); player?.seek(time); });
    if (figures[name].time && player) player.followers.push(plot);
  }
  player?.draw();
}
