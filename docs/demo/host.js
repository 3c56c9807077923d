// A spring that a host closes over the network, beside one in the loader. Needs parts.js.
"use strict";

const LATE = 1.5; // host periods from the angle to its force; held for one more, its mean age is two
const HOST_NOTE =
  "Both have the same feel and law; most of the spring comes from the host. Dashed: the host sends its rate once, and the loader closes " +
  "the spring. Solid: the host reads the angle and sends a force, two of its periods old on average. Stops at 10°.";

/** A loader whose host sends a force for each angle it reads. */
class HostLoader {
  constructor(loader, held, stiffness, rate) {
    Object.assign(this, { loader, stiffness, rate, angle: held, asked: 0, steps: 0, sent: [], step: loader.step });
    loader.add(this.force(), 0);
  }

  force() {
    const { loaders, places } = forcefeelEngine.data;
    return (-this.stiffness * this.angle) / loaders.robust.values[places["column.grip_arm"]];
  }

  run(steps) {
    const rows = new Float64Array(steps * OUTPUTS.length);
    for (let k = 0; k < steps; k++) {
      const now = this.steps++ * this.step;
      if (now >= this.asked / this.rate) this.sent.push({ at: (this.asked++ + LATE) / this.rate, force: this.force() });
      while (this.sent[0]?.at <= now) this.loader.add(this.sent.shift().force, 0);
      rows.set(this.loader.run(1), k * OUTPUTS.length);
      this.angle = rows[k * OUTPUTS.length];
    }
    return rows;
  }

  hold(angle) {
    this.loader.hold(angle);
  }

  forget() {
    this.loader.forget();
  }
}

/** Column and release under a host. */
class HostBench {
  constructor(parent, core) {
    this.core = core;
    const { feels } = forcefeelEngine.data, of = (frequency, damping) => feels.find((feel) => feel.frequency === frequency && feel.damping === damping);
    this.feel = of(0.5, 0.7);
    this.stiffness = of(2, 0.2).values[1] - this.feel.values[1];
    this.rate = 60;
    element(parent, "h3", {}, "The spring closed by a host");
    const pictures = element(parent, "div", { class: "pictures" });
    this.live = new Live(pictures, "Column whose spring a host closes.", (held) => this.closed(held));
    this.plot = new Plot(pictures, "Release from 5 degrees: spring closed by the host and by the loader.", { degrees: 10, actual: "by the host", ideal: "by the loader" });
    this.verdict = element(parent, "p", { class: "verdict", role: "status" });
    const rates = [30, 60, 120, 240, 500, 1000];
    slider(element(parent, "div", { class: "sliders" }), {
      name: "Rate of the host", range: [0, rates.length - 1, 1], value: rates.indexOf(this.rate), text: (k) => `${rates[k]} Hz`,
      changed: (k) => this.change(rates[k]),
    });
    element(parent, "button", { type: "button" }, "Let go from 5°").addEventListener("click", () => this.live.restart(RELEASE_RAD));
    element(parent, "p", { class: "note" }, HOST_NOTE);
    this.change(this.rate);
  }

  open(held) {
    const stop = 10 / DEGREES;
    return this.core.loader(setup("robust", this.feel, { "column.stop_low": -stop, "column.stop_high": stop }, { held }));
  }

  closed(held) {
    return new HostLoader(this.open(held), held, this.stiffness, this.rate);
  }

  change(rate) {
    this.rate = rate;
    this.live.restart();
    this.release?.stop();
    const sample = 4e-3, samples = 1500, own = this.open(RELEASE_RAD);
    own.add(0, this.stiffness);
    const ideal = Array.from({ length: samples }, () => own.run(Math.round(sample / own.step))[0]);
    own.forget();
    this.release = new Release(this.plot, this.closed(RELEASE_RAD), ideal, sample, samples);
    this.release.done.then((angles) => this.judged(angles.slice(-250)));
  }

  judged(angles) {
    const swing = DEGREES * Math.max(...angles.map(Math.abs)), swings = swing > 1;
    this.verdict.className = `verdict ${swings ? "failed" : "passed"}`;
    this.verdict.textContent = `${swings ? "Does not settle" : "Settles"}: ±${swing.toFixed(1)}° after 5 s.`;
  }
}

demoCore.then((core) => new HostBench(element(demoPlace, "section"), core), () => {});
