// What scrolls: ten seconds of each signal, with both extremes of every frame.

import { calm, tick } from "./numbers.js";
import { color } from "./graph.js";

const SECONDS = 10;
const POINTS = 2 * 60 * (SECONDS + 1);

const GROUPS = [
  { title: "Position", least: 1, of: { column_angle_rad: ["measured"], feel_angle_rad: ["soft", [4, 4]], neutral_rad: ["edge", [1, 3]] } },
  { title: "Force at the grip", least: 2, of: { pilot_force_n: ["hand"], feel_torque_n_m: ["found", [6, 3]], link_torque_n_m: ["soft"] } },
  { title: "Command", least: 0.02, of: { law_command: ["soft", [4, 4]], command: ["ink"] } },
];

export class Traces {
  constructor(into, channels) {
    into.replaceChildren();
    this.time = new Float64Array(POINTS).fill(NaN);
    this.values = channels.map(() => new Float64Array(POINTS).fill(NaN));
    this.last = 0;
    this.ahead = null;
    this.plots = GROUPS.map((group) => this.plot(into, group, channels)).filter(Boolean);
    new ResizeObserver(() => this.plots.forEach(({ plot, body, height }) => plot.setSize({ width: body.clientWidth, height }))).observe(into);
  }

  plot(into, { title, of, least }, channels) {
    const taken = [...channels.keys()].filter((k) => channels[k].column in of);
    if (!taken.length) return null;
    const body = document.createElement("div");
    body.className = "trace";
    const head = body.appendChild(document.createElement("h3"));
    head.append(`${title}, ${channels[taken[0]].unit}`);
    for (const k of taken) {
      const key = head.appendChild(document.createElement("span"));
      key.className = `key ${of[channels[k].column][0]}`;
      key.textContent = channels[k].label;
    }
    into.append(body);
    const height = Math.max(130, Math.min(190, window.innerHeight / 5));
    const axis = { stroke: () => color("soft"), grid: { stroke: () => color("rule"), width: 1 }, ticks: { show: false }, font: "12px system-ui, sans-serif" };
    const plot = new uPlot(
      {
        width: body.clientWidth,
        height,
        pxAlign: false,
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false, auto: false, range: () => this.range() }, y: { range: (_, low, high) => calm(low, high, least) } },
        axes: [
          { ...axis, size: 24, values: (_, at) => at.map((t) => `${Math.round(t)} s`) },
          { ...axis, size: 46, values: (_, at) => at.map((value) => tick(value, at.length > 1 ? at[1] - at[0] : 1)) },
        ],
        series: [{}, ...taken.map((k) => {
          const [name, dash] = of[channels[k].column];
          return { stroke: () => color(name), dash, width: 1.6, points: { show: false } };
        })],
      },
      [this.time, ...taken.map((k) => this.values[k])],
      body,
    );
    return { plot, taken, body, height };
  }

  // A frame: first and second extreme and last value of each channel.
  push(time, numbers) {
    if (time < this.last) this.time.fill(NaN); // the loop began anew
    const from = this.last || time - 1 / 60;
    shift(this.time, from + (time - from) / 2, time);
    this.values.forEach((row, k) => shift(row, numbers[3 * k], numbers[3 * k + 1]));
    this.last = time;
    const ahead = time - performance.now() / 1000;
    // The page's clock follows the loop's gently, so that what scrolls does not stutter with the network.
    this.ahead = this.ahead === null || Math.abs(ahead - this.ahead) > 0.5 ? ahead : this.ahead + 0.05 * (ahead - this.ahead);
  }

  range() {
    const now = Math.min(performance.now() / 1000 + (this.ahead ?? 0), this.last + 0.1);
    return [now - SECONDS, now];
  }

  draw() {
    const first = this.time.findIndex((at) => !Number.isNaN(at));
    if (first < 0) return;
    for (const { plot, taken } of this.plots) {
      plot.setData([this.time.subarray(first), ...taken.map((k) => this.values[k].subarray(first))]);
    }
  }
}

function shift(row, first, second) {
  row.copyWithin(0, 2);
  row[row.length - 2] = first;
  row[row.length - 1] = second;
}
