// A plot on a canvas: axes with units, lines, bands, bars. For what is no function of time.

import { step, tick } from "./numbers.js";

const LEFT = 46;
const BOTTOM = 34;
const TOP = 8;
const RIGHT = 10;

export const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export class Graph {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
  }

  // Clears it and draws the axes; `x` and `y` are [low, high].
  // `marks` are the marks of x and their names, where they are not the usual ones.
  begin(x, y, xLabel, yLabel, marks) {
    const sharp = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (this.canvas.width !== Math.round(width * sharp)) this.canvas.width = Math.round(width * sharp);
    if (this.canvas.height !== Math.round(height * sharp)) this.canvas.height = Math.round(height * sharp);
    Object.assign(this, { x, y, width, height });
    const pen = this.pen;
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px system-ui, sans-serif";
    pen.lineWidth = 1;
    for (const [at, name] of marks ?? ticks(x, width < 400 ? 4 : 8)) this.rule([at, at], y, at === 0 && !marks, name, true);
    for (const [at, name] of ticks(y, height < 200 ? 3 : 5)) this.rule(x, [at, at], at === 0, name, false);
    pen.fillStyle = color("soft");
    pen.textAlign = "right";
    pen.textBaseline = "bottom";
    pen.fillText(xLabel, width - RIGHT, height - 2);
    pen.textAlign = "left";
    pen.textBaseline = "top";
    pen.fillText(yLabel, LEFT + 6, TOP + 2);
  }

  rule(x, y, zero, label, below) {
    const pen = this.pen;
    this.path(x, y);
    pen.strokeStyle = color(zero ? "edge" : "rule");
    pen.stroke();
    pen.fillStyle = color("soft");
    pen.textAlign = below ? "center" : "right";
    pen.textBaseline = below ? "top" : "middle";
    pen.fillText(label, below ? this.atX(x[0]) : LEFT - 6, below ? this.height - BOTTOM + 4 : this.atY(y[0]));
  }

  atX(value) {
    return LEFT + ((value - this.x[0]) / (this.x[1] - this.x[0])) * (this.width - LEFT - RIGHT);
  }

  atY(value) {
    return this.height - BOTTOM - ((value - this.y[0]) / (this.y[1] - this.y[0])) * (this.height - BOTTOM - TOP);
  }

  path(x, y) {
    this.pen.beginPath();
    let down = false;
    for (let k = 0; k < x.length; k += 1) {
      const there = Number.isFinite(y[k]) && y[k] !== null;
      if (there && down) this.pen.lineTo(this.atX(x[k]), this.atY(y[k]));
      if (there && !down) this.pen.moveTo(this.atX(x[k]), this.atY(y[k]));
      down = there;
    }
  }

  // Within the axes, whatever it draws.
  inside(draw) {
    this.pen.save();
    this.pen.beginPath();
    this.pen.rect(LEFT, TOP, this.width - LEFT - RIGHT, this.height - TOP - BOTTOM);
    this.pen.clip();
    draw();
    this.pen.restore();
  }

  line(x, y, name, { width = 2, dash = [] } = {}) {
    this.path(x, y);
    this.pen.strokeStyle = color(name);
    this.pen.lineWidth = width;
    this.pen.lineJoin = "round";
    this.pen.setLineDash(dash);
    this.pen.stroke();
    this.pen.setLineDash([]);
  }

  band(x, low, high) {
    const known = [...x.keys()].filter((k) => low[k] !== null && high[k] !== null);
    this.path([...known, ...known.toReversed()].map((k) => x[k]), [...known.map((k) => low[k]), ...known.toReversed().map((k) => high[k])]);
    this.pen.fillStyle = color("band");
    this.pen.fill();
  }

  dot(x, y, name) {
    this.pen.beginPath();
    this.pen.arc(this.atX(x), this.atY(y), 5, 0, 2 * Math.PI);
    this.pen.fillStyle = color(name);
    this.pen.fill();
  }

  box(x, y, name) {
    this.pen.fillStyle = color(name);
    this.pen.fillRect(this.atX(x[0]), this.atY(y[1]), this.atX(x[1]) - this.atX(x[0]), this.atY(y[0]) - this.atY(y[1]));
  }
}

export function ticks([low, high], parts) {
  const by = step(high - low, parts);
  const first = Math.ceil(low / by - 1e-9);
  const count = Math.floor(high / by + 1e-9) - first + 1;
  return Array.from({ length: Math.max(count, 0) }, (_, k) => [(first + k) * by, tick((first + k) * by, by)]);
}
