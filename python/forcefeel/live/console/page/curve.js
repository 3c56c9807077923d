// Force over position as it is traced, over the programmed curve and its tolerance.

import { Graph } from "./graph.js";
import { calm } from "./numbers.js";

const TRAIL = 60 * 6;

export class Curve {
  constructor({ angle, force }) {
    this.graph = new Graph(document.getElementById("curve"));
    Object.assign(this, { angle, force, curve: null, trail: [], neutral: 0 });
  }

  take(curve) {
    this.curve = curve;
  }

  // The largest force of the programmed curve.
  get full() {
    return this.curve ? Math.max(...[...this.curve.up, ...this.curve.down].map(Math.abs)) : null;
  }

  push(angle, force, neutral) {
    if (!Number.isFinite(angle) || !Number.isFinite(force)) return;
    this.neutral = neutral || 0;
    this.trail.push([angle, force]);
    if (this.trail.length > TRAIL) this.trail.shift();
  }

  draw() {
    const { graph, trail, curve } = this;
    const most = Math.max(this.full ?? 1, 1) * 1.15;
    const forces = trail.map(([, force]) => force);
    const y = calm(Math.min(-most, ...forces), Math.max(most, ...forces), 1);
    const angles = trail.map(([angle]) => angle);
    const x = [Math.min(1.05 * this.angle.low, ...angles), Math.max(1.05 * this.angle.high, ...angles)];
    graph.begin(x, y, `position, ${this.angle.unit}`, `force at the grip, ${this.force.unit}`);
    graph.inside(() => {
      if (curve) {
        const at = curve.angle.map((one) => one + this.neutral);
        graph.band(at, curve.up_low, curve.up_high);
        graph.band(at, curve.down_low, curve.down_high);
        for (const way of ["up", "down"]) graph.line(at, curve[way], "ink", { width: 1.6, dash: [2, 4] });
      }
      graph.line(angles, forces, "measured");
      if (trail.length) graph.dot(...trail.at(-1), "measured");
    });
  }
}
