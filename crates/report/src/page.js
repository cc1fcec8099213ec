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
    const box = this.svg.getBoundingClientRect();
    const factor = this.svg.viewBox.baseVal.width / box.width;
    const x = (event.clientX - box.left) * factor, y = (event.clientY - box.top) * factor;
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
    tip.replaceChildren(...rows.map(([ink, text]) => {
      const row = document.createElement("div");
      if (ink) row.append(Object.assign(document.createElement("i"), { style: `background:var(--${ink})` }));
      row.append(text);
      return row;
    }));
    tip.hidden = rows.length === 0;
    const right = event.clientX + 16 + tip.offsetWidth > innerWidth;
    tip.style.left = `${Math.max(4, right ? event.clientX - 16 - tip.offsetWidth : event.clientX + 16)}px`;
    tip.style.top = `${clamp(event.clientY - 12, 4, innerHeight - tip.offsetHeight - 4)}px`;
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
  const { walk, figures } = JSON.parse(script.textContent);
  const section = script.closest("section");
  const player = walk ? new Player(section, walk) : null;
  for (const name in figures) {
    const element = section.querySelector(`[data-figure="${script.dataset.of}/${name}"]`);
    const plot = new Plot(element, figures[name], time => { player?.stop(); player?.seek(time); });
    if (figures[name].time && player) player.followers.push(plot);
  }
  player?.draw();
}
