// How late the loop woke and how long it worked.

import { Graph } from "./graph.js";
import { text } from "./numbers.js";

const MARKS = [1, 10, 100, 1000, 10000];
const COLUMNS = ["median", "p99", "p999", "most"];

export class Timing {
  constructor() {
    this.graph = new Graph(document.getElementById("timing"));
  }

  draw({ edges_us: edges, ...both }) {
    const logged = (us) => Math.log10(Math.max(us, edges[1] / 2));
    const filled = ["late", "work"].flatMap((of) => [...both[of].counts.keys()].filter((k) => both[of].counts[k]));
    const last = Math.max(Math.min(Math.max(...filled, 0) + 2, edges.length - 1), 8);
    const x = [logged(0), logged(edges[last])];
    const height = (count) => Math.log10(1 + count);
    const most = Math.max(...both.late.counts, ...both.work.counts, 9);
    const marks = MARKS.filter((us) => us < edges[last]).map((us) => [logged(us), us.toLocaleString("en")]);
    this.graph.begin(x, [0, height(most) * 1.1], "µs", "log₁₀ of cycles", marks);
    this.graph.inside(() => {
      for (const [of, name, from] of [["late", "hand", 0], ["work", "found", 0.5]]) {
        both[of].counts.forEach((count, k) => {
          const [low, high] = [logged(edges[k]), logged(edges[k + 1])];
          const left = low + from * (high - low);
          if (count) this.graph.box([left, left + 0.45 * (high - low)], [0, height(count)], name);
        });
      }
    });
    for (const of of ["late", "work"]) {
      const row = document.querySelector(`#timing-table tr[data-of="${of}"]`);
      COLUMNS.forEach((column, k) => {
        const cell = row.cells[k + 1] ?? row.insertCell();
        cell.className = "number";
        cell.textContent = text(both[of][column]);
      });
    }
  }
}
