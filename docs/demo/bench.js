// The live loader: drag its column, change its parts, see its release and the verdict. Needs parts.js.
"use strict";

const LAW_NAMES = { original: "original (1974, analog)", published: "the report's (1974, analog)", robust: "robust (2 kHz, digital)" };
const NOTE =
  "The model and the law are those of the program, step by step. Each law was designed for the chosen feel and for the loader of the report: " +
  "6110 lb/in, no friction, and 0.5 ms of delay where it is digital. The three other sliders change the machine alone. Angles are drawn 4 times as large, the stretch of the link 20 times. Verdict: RULE.";
const FAILS = {
  "not measured": "the column diverges",
  "not settled": "the column does not come to rest",
  "first overshoot": "the first overshoot is missing",
  overshoots: "the number of overshoots is wrong",
  "steady state": "the column rests in the wrong place",
  "fall time": "the time from 90 % to 10 % of the way is wrong",
};

/** Why a release fails, in words. */
function reason(name) {
  if (name[0] === "P" && name.length === 2) return `period ${name} is out of tolerance`;
  return FAILS[name] ?? `overshoot ${name} is out of tolerance`;
}

/** The bench: controls, column, release. */
class Bench {
  constructor(parent, core) {
    this.core = core;
    const { data } = forcefeelEngine;
    this.state = { law: "original", frequency: data.frequencies.indexOf(2), damping: data.dampings.indexOf(0.2), link: 0, friction: 0, delay: 1 };
    this.laws(element(parent, "fieldset"));
    const pictures = element(parent, "div", { class: "pictures" });
    this.live = new Live(pictures, "Column, link and drive.", (held) => this.loader(held));
    this.plot = new Plot(pictures, "Release from 5 degrees: loader and programmed feel.");
    this.verdict = element(parent, "p", { class: "verdict", role: "status" });
    this.sliders(element(parent, "div", { class: "sliders" }));
    element(parent, "button", { type: "button" }, "Let go from 5°").addEventListener("click", () => this.live.restart(RELEASE_RAD));
    element(parent, "p", { class: "note" }, NOTE.replace("RULE", data.title));
    this.change({});
    if (!calm) this.live.restart(RELEASE_RAD);
  }

  laws(parent) {
    element(parent, "legend", {}, "Law");
    for (const [law, name] of Object.entries(LAW_NAMES)) {
      const label = element(parent, "label");
      const radio = element(label, "input", { type: "radio", name: "law", value: law });
      radio.checked = law === this.state.law;
      radio.addEventListener("change", () => this.change({ law }));
      label.append(` ${name}`);
    }
  }

  sliders(parent) {
    const { frequencies, dampings } = forcefeelEngine.data;
    const add = (key, name, range, text) =>
      slider(parent, { name, range, text, value: this.state[key], changed: (value) => this.change({ [key]: value }) });
    add("frequency", "Feel: natural frequency", [0, frequencies.length - 1, 1], (k) => `${frequencies[k]} Hz`);
    add("damping", "Feel: damping ratio", [0, dampings.length - 1, 1], (k) => `${dampings[k]}`);
    add("link", "Link stiffness", [-3, 2, 0.25], (k) => `${Number((this.stiffness(k) / LB_PER_IN).toPrecision(3))} lb/in`);
    add("friction", "Dry friction, at the grip", [0, 5, 0.25], (lb) => `${lb} lb`);
    this.delay = add("delay", "Delay of the digital controller", [0, 7, 1], (k) => `${0.5 * k} ms`);
  }

  /** Of the link in N/m, so many octaves from the report's. */
  stiffness(octaves) {
    const { loaders, places } = forcefeelEngine.data;
    return loaders.robust.values[places["linkage.stiffness"]] * 2 ** octaves;
  }

  get feel() {
    const { feels, dampings } = forcefeelEngine.data;
    return feels[this.state.frequency * dampings.length + this.state.damping];
  }

  /** The loader as the sliders have it; its law stays that of the machine it was designed for. */
  loader(held) {
    const { law, link, friction, delay } = this.state;
    const values = { "linkage.stiffness": this.stiffness(link), "column.coulomb_friction": friction * LB };
    return this.core.loader(setup(law, this.feel, values, { held, delay }));
  }

  change(change) {
    Object.assign(this.state, change);
    this.delay.disabled = this.state.law !== "robust";
    this.live.restart();
    this.release?.stop();
    this.verdict.className = "verdict";
    this.verdict.textContent = "Release runs …";
    const { feel } = this, samples = Math.round(feel.duration / feel.sample) + 1;
    const shown = Math.min(samples, Math.ceil(5 / feel.frequency / feel.sample));
    const ideal = this.core.ideal(setup("original", feel, {}, { held: RELEASE_RAD }), feel.sample, samples);
    this.release = new Release(this.plot, this.loader(RELEASE_RAD), ideal, feel.sample, shown);
    this.release.done.then((angles) => this.judged(this.core.judge(angles, ideal, feel.sample)));
  }

  judged({ fails, used }) {
    this.verdict.className = `verdict ${fails ? "failed" : "passed"}`;
    this.verdict.textContent = fails ? `Fails: ${reason(fails)}.` : `Passes: ${Math.round(100 * used)} % of the tolerance is used.`;
  }
}

const demoPlace = document.querySelector(".live-loader");
const demoCore = Core.unpack().then((exports) => new Core(exports));
demoCore.then(
  (core) => new Bench(element(demoPlace, "section"), core),
  () => (demoPlace.textContent = "The live loader needs a browser with WebAssembly and DecompressionStream.")
);
