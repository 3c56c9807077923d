// Parts of the live loaders: drawing, plot, slider, the column under a hand, a release. Needs core.js.
"use strict";

const DEGREES = 180 / Math.PI, LB = 4.4482216152605, LB_PER_IN = 175.12683524647636;
const RELEASE_RAD = 5 / DEGREES;
const LARGER = 4; // angles, as they are drawn
const STRETCH = 5; // of the link, beside them
const SVG = "http://www.w3.org/2000/svg";
const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
const BUSY_MS = 6; // of a frame, for a release
const LONGEST_FRAME_MS = 50; // what is longer is lost

/** An element of SVG or, without a name in it, of HTML. */
function element(parent, name, attributes = {}, text = "") {
  const made = parent instanceof SVGElement || name === "svg" ? document.createElementNS(SVG, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  parent.append(made);
  return made;
}

/** Column, link and drive of a loader, drawn. */
class Drawing {
  constructor(parent, label) {
    this.svg = element(parent, "svg", { viewBox: "0 0 480 300", role: "img", tabindex: 0, "aria-label": label });
    element(this.svg, "path", { class: "ground", d: "M205 190h70M390 225v50h70v-50z" });
    element(this.svg, "text", { x: 300, y: 225 }, "link");
    element(this.svg, "text", { x: 425, y: 215, "text-anchor": "middle" }, "drive");
    this.spring = element(this.svg, "path", { class: "link" });
    this.rod = element(this.svg, "path", { class: "rod" });
    this.hand = element(this.svg, "path", { class: "hand" });
    this.column = element(this.svg, "g");
    element(this.column, "path", { class: "column", d: "M240 250V45" });
    element(this.column, "circle", { class: "grip", cx: 240, cy: 38, r: 15 });
    element(this.svg, "circle", { class: "pivot", cx: 240, cy: 190, r: 6 });
    this.words = element(this.svg, "text", { class: "reading", x: 12, y: 288 });
  }

  /** Draws the loader, at the angles of column and drive in rad, under a hand that wants to be at `held`. */
  draw(angle, driveAngle, force, held) {
    const drawn = Math.max(-1.1, Math.min(1.1, LARGER * angle));
    this.column.setAttribute("transform", `rotate(${drawn * DEGREES} 240 190)`);
    const base = 240 - 60 * Math.sin(drawn), y = 190 + 60 * Math.cos(drawn);
    const end = base + 110 - 60 * LARGER * STRETCH * (driveAngle - angle);
    const zigzag = Array.from({ length: 9 }, (_, k) => `L${base + ((k + 1) / 10) * (end - base)} ${y + (k % 2 ? 9 : -9)}`);
    this.spring.setAttribute("d", `M${base} ${y}${zigzag.join("")}L${end} ${y}`);
    this.rod.setAttribute("d", `M${end} ${y}L395 250h30`);
    const at = (angle) => `${240 + 152 * Math.sin(angle)} ${190 - 152 * Math.cos(angle)}`;
    this.hand.setAttribute("d", Number.isNaN(held) ? "" : `M${at(drawn)}L${at(LARGER * held)}`);
    const [deg, lb] = [angle * DEGREES, force / LB].map((number) => (Math.abs(number) < 0.05 ? 0 : number).toFixed(1));
    this.words.textContent = `column ${deg} deg · hand ${lb} lb`;
  }

  /** Angle in rad to which a pointer pulls the column. */
  angle(event) {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    return Math.atan2(point.x - 240, Math.max(190 - point.y, 20)) / LARGER;
  }
}

/** Angle over time: the programmed feel dashed, the loader beside it. */
class Plot {
  constructor(parent, label, { degrees = 5, actual = "loader", ideal = "programmed feel" } = {}) {
    this.degrees = degrees;
    this.svg = element(parent, "svg", { viewBox: "0 0 480 300", role: "img", "aria-label": label });
    const inner = element(this.svg, "svg", { x: 46, y: 10, width: 424, height: 240, viewBox: "0 -1.2 1 2.4", preserveAspectRatio: "none" });
    element(inner, "path", { class: "axis", d: "M0 0H1M0 -1H1M0 1H1" });
    this.lines = Object.fromEntries(["actual", "ideal"].map((name) => [name, element(inner, "polyline", { class: name })]));
    for (const [deg, y] of [[degrees, 30], [0, 130], [-degrees, 230]]) {
      element(this.svg, "text", { x: 40, y: y + 5, "text-anchor": "end" }, `${deg}°`);
    }
    this.end = element(this.svg, "text", { x: 468, y: 270, "text-anchor": "end" });
    element(this.svg, "text", { x: 46, y: 270 }, "0");
    for (const [x, name, text] of [[60, "ideal", ideal], [260, "actual", actual]]) {
      element(this.svg, "path", { class: name, d: `M${x} 287h30` });
      element(this.svg, "text", { x: x + 38, y: 292 }, text);
    }
  }

  /** The samples of a line in rad, of a plot that shows so many of them. */
  draw(line, angles, shown) {
    const every = Math.ceil(shown / 400), points = [];
    for (let k = 0; k < Math.min(angles.length, shown); k += every) {
      points.push(`${k / shown},${-Math.max(-9, Math.min(9, (angles[k] * DEGREES) / this.degrees || 0))}`);
    }
    this.lines[line].setAttribute("points", points.join(" "));
  }
}

/** A slider with its value in words. */
function slider(parent, { name, range: [least, most, step], value, text, changed }) {
  const label = element(parent, "label", {}, name);
  const input = element(label, "input", { type: "range", min: least, max: most, step, value });
  const output = element(label, "output");
  const show = () => input.setAttribute("aria-valuetext", (output.textContent = text(Number(input.value))));
  input.addEventListener("input", () => (show(), changed(Number(input.value))));
  show();
  return input;
}

/** A live column under the hand of a pointer or of keys; `make(held)` gives the loader, let go at an angle in rad. */
class Live {
  constructor(parent, label, make) {
    this.drawing = new Drawing(parent, `${label} Left and right arrow keys pull the column, space lets go.`);
    [this.make, this.angle, this.held] = [make, 0, NOTHING];
    this.restart(0);
    this.listen();
    this.before = performance.now();
    requestAnimationFrame((now) => this.frame(now));
  }

  /** Another loader, at this angle. */
  restart(angle = this.angle) {
    this.loader?.forget();
    this.loader = this.make(angle);
    this.loader.hold(this.held);
  }

  /** The hand goes to an angle, or lets go. */
  take(angle) {
    this.held = Math.max(-0.25, Math.min(0.25, angle));
    this.loader.hold(this.held);
  }

  listen() {
    const { svg } = this.drawing, keys = { ArrowLeft: -1, ArrowRight: 1, " ": NOTHING, Escape: NOTHING };
    svg.addEventListener("pointerdown", (event) => {
      svg.setPointerCapture(event.pointerId);
      this.take(this.drawing.angle(event));
    });
    svg.addEventListener("pointermove", (event) => svg.hasPointerCapture(event.pointerId) && this.take(this.drawing.angle(event)));
    for (const name of ["pointerup", "pointercancel", "blur"]) svg.addEventListener(name, () => this.take(NOTHING));
    svg.addEventListener("keydown", (event) => {
      if (!(event.key in keys)) return;
      this.take((this.held || 0) + keys[event.key] / DEGREES);
      event.preventDefault();
    });
  }

  frame(now) {
    const steps = Math.round(Math.min(now - this.before, LONGEST_FRAME_MS) / 1000 / this.loader.step);
    if (steps > 0) {
      this.before = now;
      const { values } = forcefeelEngine.data.loaders.robust, { places } = forcefeelEngine.data;
      const [angle, , , , drive, , , , , force] = this.loader.run(steps).slice(-OUTPUTS.length);
      if (Number.isFinite(angle + drive)) {
        this.angle = angle;
        this.drawing.draw(angle, drive / values[places["linkage.ratio"]] / values[places["column.base_arm"]], force, this.held);
      } else this.restart(0);
    }
    requestAnimationFrame((later) => this.frame(later));
  }
}

/** A release beside the programmed feel's, some steps in each frame. */
class Release {
  constructor(plot, loader, ideal, sample, shown) {
    Object.assign(this, { plot, loader, ideal, sample, shown, angles: [] });
    plot.draw("ideal", ideal, shown);
    plot.end.textContent = `${(shown * sample).toFixed(1)} s`;
    this.done = new Promise((resolve) => requestAnimationFrame(() => this.go(resolve)));
  }

  go(resolve) {
    if (!this.loader) return;
    const every = Math.round(this.sample / this.loader.step), { length } = this.ideal;
    const until = performance.now() + (calm ? Infinity : BUSY_MS);
    while (this.angles.length < length && performance.now() < until) {
      for (let k = 0; k < 20 && this.angles.length < length; k++) this.angles.push(this.loader.run(every)[0]);
    }
    this.plot.draw("actual", this.angles, this.shown);
    if (this.angles.length < length) return requestAnimationFrame(() => this.go(resolve));
    this.stop();
    resolve(this.angles);
  }

  /** Stops, and forgets the loader. */
  stop() {
    this.loader?.forget();
    this.loader = null;
  }
}
