// A test of the rule, while it is made and when it is judged.

import { Graph } from "./graph.js";
import { calm } from "./numbers.js";

const DOES = {
  pulls: "the hand pulls the column to the release angle",
  holds: "the hand holds it",
  "let go": "let go: the column swings freely",
  sweeps: "the hand sweeps the column slowly to both sides",
  judges: "what was recorded is judged",
};

export class Judged {
  constructor() {
    this.body = document.getElementById("judged");
    this.graph = new Graph(document.getElementById("judged-plot"));
    this.plot = null;
    new ResizeObserver(() => this.draw()).observe(this.graph.canvas);
  }

  progress(test) {
    const line = document.getElementById("progress");
    line.hidden = !test;
    document.getElementById("abort").hidden = !test;
    if (!test) return;
    line.querySelector("progress").value = test.share;
    line.querySelector("span").textContent = DOES[test.what] ?? test.what;
  }

  show({ judged, reason }) {
    const [verdict, head, told] = ["p.verdict", "strong", "span"].map((what) => this.body.querySelector(what));
    this.body.hidden = false;
    document.getElementById("no-test").hidden = true;
    head.textContent = judged ? `${judged.title}: ${judged.outcome}` : "Not judged";
    told.textContent = judged ? [judged.sentence, ...judged.remarks, judged.rule].join(" ") : reason;
    verdict.classList.toggle("bad", !judged?.passed);
    const rows = judged?.verdicts ?? [];
    this.body.querySelector("tbody").replaceChildren(...rows.map(tableRow));
    this.body.querySelector("table").hidden = !rows.length;
    this.plot = judged?.plot ?? null;
    this.graph.canvas.hidden = !this.plot;
    this.draw();
  }

  draw() {
    if (!this.plot) return;
    const { graph, plot } = this;
    const lines = Object.keys(plot).filter((key) => Array.isArray(plot[key]) && key !== "x" && key !== "marks");
    const values = lines.flatMap((key) => plot[key]).filter((value) => value !== null);
    graph.begin([plot.x[0], plot.x.at(-1)], calm(Math.min(...values), Math.max(...values), 0.1), plot.x_label, plot.y_label);
    graph.inside(() => (plot.kind === "release" ? release(graph, plot) : sweep(graph, plot)));
  }
}

function release(graph, plot) {
  const flat = (value) => plot.x.map(() => value);
  graph.band(plot.x, flat(-plot.band), flat(plot.band));
  graph.line(plot.x, plot.reference, "ink", { dash: [2, 4] });
  graph.line(plot.x, plot.measured, "measured", { width: 2.2 });
  for (const { x, y, by = 0, along = 0 } of plot.marks) {
    graph.line([x - along, x + along], [y - by, y + by], "soft", { width: 3 });
  }
}

function sweep(graph, plot) {
  for (const way of ["up", "down"]) graph.band(plot.x, plot[`${way}_low`], plot[`${way}_high`]);
  for (const way of ["up", "down"]) {
    graph.line(plot.x, plot[`reference_${way}`], "ink", { width: 1.6, dash: [2, 4] });
    graph.line(plot.x, plot[`measured_${way}`], "measured");
  }
}

function tableRow(verdict) {
  const row = document.createElement("tr");
  for (const key of ["quantity", "measured", "reference", "tolerance", "outcome"]) {
    const cell = row.appendChild(document.createElement(key === "quantity" ? "th" : "td"));
    cell.textContent = key === "quantity" && verdict.unit ? `${verdict.quantity}, ${verdict.unit}` : verdict[key];
    if (["measured", "reference", "tolerance"].includes(key)) cell.className = "number";
    if (key === "outcome" && verdict[key] === "failed") cell.className = "bad";
  }
  return row;
}
