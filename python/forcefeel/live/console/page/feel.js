// Sliders and numbers of the feel; what somebody moves is not moved back under the hand.

import { text } from "./numbers.js";

const HELD_MS = 1500;
const EACH_MS = 60;
const STEPS = 1000;
const FIRST = 5; // the rest is folded away

const AROUND = [
  { key: "trim_rad", name: "trim", symbol: ["n", "", ""], around: true },
  { key: "stiffness_factor", name: "factor on the spring", symbol: ["", "", ""], unit: "", scale: 1, low: 0.25, high: 4, even: true, around: true },
  { key: "shaker", name: "stick shaker", symbol: ["", "", ""], unit: "%", scale: 100, low: 0, high: 1, around: true },
];

const command = ({ key, around }) => (value) => (around ? { do: "around", [key]: value } : { do: "feel", rows: { [key]: value } });

export class Feel {
  constructor(into, sliders, angle, send) {
    into.replaceChildren();
    const half = (angle.high / angle.scale) / 2;
    const trim = { ...AROUND[0], unit: angle.unit, scale: angle.scale, low: -half, high: half };
    const all = [...sliders.slice(0, FIRST), trim, ...sliders.slice(FIRST), ...AROUND.slice(1)];
    const more = document.createElement("details");
    more.innerHTML = "<summary>More of the feel</summary>";
    this.rows = all.map((slider, k) => new Row(k <= FIRST ? into : more, { ...slider, command: command(slider) }, send));
    into.append(more);
  }

  show({ feel, ...around }) {
    for (const row of this.rows) row.show(row.slider.around ? around[row.slider.key] : feel[row.slider.key]);
  }

  enable(allowed) {
    for (const row of this.rows) for (const input of [row.range, row.number]) input.disabled = !allowed;
  }
}

// A slider with its number; `slider.command` makes what the server is told.
export class Row {
  constructor(into, slider, send) {
    Object.assign(this, { slider, send, held: -Infinity, timer: null });
    const row = into.appendChild(document.createElement("div"));
    row.className = "slider";
    const label = row.appendChild(document.createElement("label"));
    const [base, index, dashes] = slider.symbol;
    label.append(slider.name);
    if (base) {
      const symbol = Object.assign(document.createElement("i"), { className: "symbol", textContent: ` ${base}` });
      label.append(symbol, Object.assign(document.createElement("sub"), { textContent: index }), dashes);
    }
    label.title = slider.meaning ?? "";
    label.htmlFor = `number-${slider.key}`;
    this.range = row.appendChild(Object.assign(document.createElement("input"), { type: "range", min: 0, max: STEPS, step: 1 }));
    this.range.setAttribute("aria-label", slider.name);
    this.number = row.appendChild(Object.assign(document.createElement("input"), { type: "number", step: "any", id: `number-${slider.key}` }));
    row.appendChild(Object.assign(document.createElement("span"), { className: "unit", textContent: slider.unit }));
    this.range.oninput = () => this.ask(this.fromRange());
    this.number.onchange = () => this.number.value !== "" && this.ask(Number(this.number.value) / slider.scale, true);
  }

  fromRange() {
    const { low, high, even } = this.slider;
    const share = this.range.value / STEPS;
    return even ? low * (high / low) ** share : low + share * (high - low);
  }

  toRange(value) {
    const { low, high, even } = this.slider;
    return STEPS * (even ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low));
  }

  ask(value, typed = false) {
    this.held = performance.now();
    this.wanted = value;
    if (typed) this.range.value = this.toRange(value);
    else this.number.value = plain(value * this.slider.scale);
    this.timer ??= setTimeout(() => {
      this.timer = null;
      this.held = performance.now();
      this.send(this.slider.command(this.wanted));
    }, EACH_MS);
  }

  show(value) {
    if (value === null || value === undefined) return;
    if (performance.now() - this.held < HELD_MS || document.activeElement === this.number) return;
    this.range.value = this.toRange(value);
    this.number.value = plain(value * this.slider.scale);
  }
}

const plain = (value) => text(value).replace("\u2212", "-");
