// The controls of both pilots: columns, sticks and levers from the side, wheels from behind, pedals from above; links between them.

const PARTS = {
  pitch: { label: "column", draw: '<line class="rod" x1="0" y1="40" x2="0" y2="-28"></line><rect class="grip" x="-8" y="-44" width="16" height="26" rx="7"></rect>', move: (at) => `rotate(${at} 0 40)` },
  roll: { label: "wheel", draw: '<path class="rod" d="M -34 -18 V 6 Q -34 16 -24 16 H 24 Q 34 16 34 6 V -18"></path><line class="rod" x1="0" y1="16" x2="0" y2="2"></line>', move: (at) => `rotate(${at} 0 4)` },
  yaw: { label: "pedals", draw: '<g class="left"><rect class="grip" x="-34" y="-16" width="24" height="34" rx="4"></rect></g><g class="right"><rect class="grip" x="10" y="-16" width="24" height="34" rx="4"></rect></g>' },
  "stick-pitch": { label: "stick, pitch", draw: '<line class="rod" x1="0" y1="40" x2="0" y2="0"></line><rect class="grip" x="-7" y="-26" width="14" height="34" rx="6"></rect>', move: (at) => `rotate(${at} 0 40)` },
  "stick-roll": { label: "stick, roll", draw: '<line class="rod" x1="0" y1="40" x2="0" y2="0"></line><rect class="grip" x="-9" y="-26" width="18" height="34" rx="8"></rect>', move: (at) => `rotate(${at} 0 40)` },
  collective: { label: "collective", draw: '<line class="rod" x1="-38" y1="34" x2="18" y2="14"></line><rect class="grip" x="12" y="4" width="30" height="14" rx="6" transform="rotate(-20 27 11)"></rect>', move: (at) => `rotate(${-at} -38 34)` },
};
const SECOND = "-first-officer";
const [WIDTH, HEIGHT] = [170, 130];
const PEDALS_PX = 0.9; // of travel for each degree

const control = (axis) => axis.replace(SECOND, "");
const seat = (axis) => (axis.endsWith(SECOND) ? 1 : 0);

export class Controls {
  constructor(svg, axes) {
    this.svg = svg;
    const kinds = Object.keys(PARTS).filter((kind) => axes.some((axis) => control(axis) === kind));
    const seats = axes.some(seat) ? 2 : 1;
    this.place = (axis) => (seats === 2
      ? [WIDTH * (0.5 + seat(axis)), HEIGHT * (kinds.indexOf(control(axis)) + 0.55)]
      : [WIDTH * (kinds.indexOf(control(axis)) + 0.5), HEIGHT * 0.55]);
    const [columns, rows] = seats === 2 ? [2, kinds.length] : [kinds.length, 1];
    svg.setAttribute("viewBox", `0 0 ${WIDTH * columns} ${HEIGHT * rows}`);
    svg.style.maxHeight = `${150 * rows}px`;
    svg.innerHTML = axes.map((axis) => {
      const [x, y] = this.place(axis);
      const { label, draw } = PARTS[control(axis)];
      const of = seats === 2 ? `${seat(axis) ? "first officer" : "captain"}: ${label}` : label;
      return `<g data-axis="${axis}" transform="translate(${x} ${y})"><line class="measure" x1="-40" y1="42" x2="40" y2="42"></line>`
        + `<g class="moves">${draw}</g><text y="57">${of}</text></g>`;
    }).join("");
    this.links = new Map();
  }

  // An angle in rad; what leans to the right is positive, pedals slide against each other.
  move(axis, angle, state) {
    const of = this.svg.querySelector(`[data-axis="${axis}"]`);
    of.dataset.state = state;
    const degrees = (angle * 180) / Math.PI;
    const part = PARTS[control(axis)];
    if (part.move) return of.querySelector(".moves").setAttribute("transform", part.move(degrees));
    const slides = Math.max(-24, Math.min(24, PEDALS_PX * degrees));
    of.querySelector(".left").setAttribute("transform", `translate(0 ${slides})`);
    return of.querySelector(".right").setAttribute("transform", `translate(0 ${-slides})`);
  }

  link(between, holds) {
    const key = between.join();
    if (!this.links.has(key)) {
      const [[x, y], [to]] = between.map(this.place).sort(([one], [other]) => one - other);
      const line = this.svg.appendChild(document.createElementNS("http://www.w3.org/2000/svg", "path"));
      line.setAttribute("d", `M ${x + 44} ${y + 30} H ${to - 44}`);
      this.links.set(key, line);
    }
    this.links.get(key).setAttribute("class", holds ? "shaft" : "shaft open");
  }
}
