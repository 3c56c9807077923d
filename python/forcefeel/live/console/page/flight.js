// The flight of the aircraft beside the loop: what its instruments show, and its levers.

import { Row } from "./feel.js";
import { text } from "./numbers.js";

export class Flight {
  constructor(readings, levers, { readings: shown, levers: moved }, send) {
    this.readings = shown;
    readings.replaceChildren(...shown.map(({ name, label }) => {
      const reading = document.createElement("div");
      reading.append(
        Object.assign(document.createElement("dt"), { textContent: label }),
        Object.assign(document.createElement("dd"), { id: `flight-${name}`, textContent: "–" }),
      );
      return reading;
    }));
    levers.replaceChildren();
    this.rows = moved.map((lever) => {
      const command = (position) => ({ do: "lever", name: lever.key, position });
      return new Row(levers, { ...lever, command }, send);
    });
  }

  show(now) {
    if (!now) return;
    for (const { name, unit, scale } of this.readings) {
      document.getElementById(`flight-${name}`).textContent = `${text(now[name] * scale)} ${unit}`;
    }
    document.getElementById("flight-refused").hidden = !now.refused;
    for (const row of this.rows) row.show(now[row.slider.key]);
  }

  enable(allowed) {
    for (const row of this.rows) for (const input of [row.range, row.number]) input.disabled = !allowed;
  }
}
