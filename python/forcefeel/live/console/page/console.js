// The page: what the server says goes to its place, what somebody does goes to the server.

import { Column } from "./column.js";
import { Curve } from "./curve.js";
import { Feel } from "./feel.js";
import { Flight } from "./flight.js";
import { Judged } from "./judged.js";
import { Link } from "./link.js";
import { text } from "./numbers.js";
import { Timing } from "./timing.js";
import { Traces } from "./traces.js";

const MESSAGE_MS = 8000;
const by = (id) => document.getElementById(id);
const main = document.querySelector("main"); // inert until the first status arrives; the stop is outside it

let told = null; // what the server told of the loop
let column, curve, feel, flight, traces, status;
let numbers = null; // the newest frame
let shown = {}; // where each column is in a frame
const judged = new Judged();
const timing = new Timing();

const link = new Link({
  opened: () => state("connected", ""),
  lost: () => {
    state("no connection", "lost");
    main.inert = by("take").disabled = true;
  },
  hello: begin,
  status: show,
  timing: (notice) => timing.draw(notice),
  curve: ({ curve: given, reason }) => {
    curve?.take(given);
    by("tolerance").textContent = given?.tolerance ?? "";
    if (column && curve.full) column.full = curve.full;
    if (reason) message(reason);
  },
  test: (notice) => judged.show(notice),
  refused: ({ reason }) => message(reason),
  frame: (time, values) => {
    numbers = values;
    traces?.push(time, values);
    curve?.push(last("column_angle_rad"), force(), last("neutral_rad"));
    by("clock").textContent = `${time.toFixed(1)} s`;
  },
});
const send = (command) => link.send(command);

const last = (name) => (name in shown && numbers ? numbers[3 * shown[name] + 2] : null);

// At the grip: of the hand, where it is measured, else as the law finds it.
function force() {
  const measured = last("pilot_force_n");
  return Number.isFinite(measured) && measured !== null ? measured : last("feel_torque_n_m");
}

function begin(hello) {
  told = hello;
  shown = Object.fromEntries(hello.channels.map((channel, k) => [channel.column, k]));
  document.title = `${hello.loader} · forcefeel run`;
  by("loader").textContent = hello.loader;
  by("law").textContent = hello.law ? `law ${hello.law}` : "";
  by("period").textContent = `${text(hello.period_ms)} ms`;
  column = new Column(hello, send, () => document.querySelector("input[name=hand]:checked").value);
  curve = new Curve(hello);
  traces = new Traces(by("traces"), hello.channels);
  feel = new Feel(by("sliders"), hello.sliders, hello.angle, send);
  by("flight-section").hidden = !hello.flight;
  flight = hello.flight && new Flight(by("flight-readings"), by("levers"), hello.flight, send);
  by("faults").hidden = by("hand").hidden = by("tests-section").hidden = !hello.hand;
  options(by("fault"), hello.faults);
  options(by("sensor"), hello.sensors);
  by("fault").onchange = () => { by("sensor").hidden = !fault().of; };
  by("fault").onchange();
  if (status) show(status);
}

function show(now) {
  status = now;
  if (!told) return;
  main.inert = by("take").disabled = false;
  state(now.ended ? "ended" : now.state, now.ended ? "lost" : now.state);
  const mine = now.holder === told.you;
  const free = now.holder === null;
  by("holder").textContent = mine ? "You have control." : free ? "No client has control." : `Watcher ${now.holder} has control.`;
  by("take").hidden = told.role !== "control" || !(mine || free);
  by("take").textContent = mine ? "Give up" : "Take control";
  by("missed").textContent = now.missed.toLocaleString("en");
  by("record").hidden = !now.record_ended;
  by("record").textContent = `The record has ended, and the loop goes on: ${now.record_ended}.`;
  by("watchers").textContent = now.watchers;
  by("softened").hidden = !now.softened;
  by("softened").textContent = now.softened;
  by("simulator").hidden = !now.host;
  by("programmed").textContent = now.host ? "programmed without the aircraft, both ways" : "programmed, both ways";
  if (now.host) {
    by("host").textContent = `${now.host.status}; share in the feel ${text(now.host.share)}${now.host.softened ? `; ${now.host.softened.toLocaleString("en")} packets softened` : ""}`;
    by("accept").hidden = !now.host.waiting || told.role !== "control";
    by("accept").textContent = `Accept ${now.host.waiting}`;
  }
  feel.show(now);
  flight?.show(now.flight);
  judged.progress(now.test);
  by("drive").hidden = !now.drive_fault;
  if (by("drive").textContent !== `Drive: ${now.drive_fault}.`) by("drive").textContent = `Drive: ${now.drive_fault}.`;
  trips(now.trips, mine || free);
  const allowed = told.role === "control" && (mine || free);
  feel.enable(allowed);
  flight?.enable(allowed);
  column.allow(allowed && told.hand, mine);
  for (const button of document.querySelectorAll("main button, main select, main input[type=radio]")) button.disabled = !allowed;
  for (const button of document.querySelectorAll("[data-test]")) button.disabled = !allowed || Boolean(now.test) || now.state !== "active";
  by("on").setAttribute("aria-pressed", String(now.state === "active"));
  by("off").setAttribute("aria-pressed", String(now.state === "passive" || now.state === "off"));
  by("break").setAttribute("aria-pressed", String(Boolean(now.fault)));
}

function trips(found, allowed) {
  const asText = JSON.stringify([found, allowed]);
  if (by("trips").dataset.shown === asText) return; // a button under somebody's finger stays where it is
  by("trips").dataset.shown = asText;
  by("trips").replaceChildren(
    ...found.map(({ name, sentence }) => {
      const item = document.createElement("li");
      const words = item.appendChild(document.createElement("span"));
      words.append(Object.assign(document.createElement("b"), { textContent: `${name}. ` }), sentence);
      const button = item.appendChild(document.createElement("button"));
      Object.assign(button, { type: "button", textContent: "Acknowledge", disabled: !allowed });
      button.onclick = () => send({ do: "acknowledge" });
      return item;
    }),
  );
}

function state(name, kind) {
  by("state").textContent = name;
  by("state").className = `badge ${kind}`;
}

let silence;
function message(reason) {
  by("message").textContent = reason;
  by("message").hidden = false;
  clearTimeout(silence);
  silence = setTimeout(() => { by("message").hidden = true; }, MESSAGE_MS);
}

function options(into, from) {
  into.replaceChildren(...from.map(({ name, text: what }) => new Option(what, name)));
}

const fault = () => told.faults.find(({ name }) => name === by("fault").value);

function breakIt() {
  const { name, of } = fault();
  const sensor = told.sensors.find((one) => one.name === by("sensor").value);
  send({ do: "break", fault: name, sensor: of ? sensor.name : null, by: ["jump", "spike"].includes(name) ? sensor.jump : 0 });
}

by("stop").onclick = () => send({ do: "stop" });
by("accept").onclick = () => send({ do: "accept_host" });
by("take").onclick = () => {
  const mine = status.holder === told.you;
  if (mine) column.allow(false, false);
  send({ do: mine ? "give" : "take" });
};
by("restart").onclick = () => send({ do: "restart_flight" });
for (const what of ["on", "off", "repair", "abort"]) by(what).onclick = () => send({ do: what });
by("break").onclick = breakIt;
for (const button of document.querySelectorAll("[data-test]")) {
  button.onclick = () => send({ do: "test", test: button.dataset.test, side: button.dataset.side });
}
// Wherever one is on the page, on a button too, which Enter then presses.
window.addEventListener("keydown", (event) => {
  if (event.key !== "Escape" && event.key !== " ") return;
  event.preventDefault();
  send({ do: "stop" });
}, { capture: true });
window.addEventListener("keyup", (event) => event.key === " " && event.preventDefault(), { capture: true });
window.addEventListener("blur", () => column?.hand && column.hand.pointer !== "pad" && column.letGo());

function draw(time) {
  if (column && numbers) {
    const [angle, programmed, pulled] = [last("column_angle_rad"), last("feel_angle_rad"), force()];
    column.tick(time);
    column.draw(angle, programmed, pulled);
    curve.draw();
    traces.draw();
    by("angle").textContent = `${text(angle)} ${told.angle.unit}`;
    by("force").textContent = `${text(pulled)} ${told.force.unit}`;
  }
  requestAnimationFrame(draw);
}
requestAnimationFrame(draw);

// In the page of a cockpit this is a panel, from which that page takes what it shows of the axis.
document.body.classList.toggle("panel", window.parent !== window);
window.axis = {
  send,
  last,
  force,
  get told() { return told; },
  get status() { return link.socket.readyState === WebSocket.OPEN ? status : null; },
};
// A page that draws slowly still holds the grip; one that is hidden lets go, since a browser then calls once a second.
setInterval(() => column?.tick(performance.now()), 100);
