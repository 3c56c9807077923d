// The page of a cockpit: a panel with the page of each axis, and above them the controls, states and links that those pages know of.

import { Controls } from "./controls.js";
import { text } from "./numbers.js";

const by = (id) => document.getElementById(id);
const cell = (row, value, kind = "") => Object.assign(row.appendChild(document.createElement("td")), { textContent: value, className: kind });

const names = await (await fetch("/axes.json")).json();
const axes = names.map((name, k) => panel(name, k === 0));
const controls = new Controls(by("controls"), names);
const links = new Map(); // by name, once a page has told of it

// The page of an axis, open or closed; what it knows is read from it.
function panel(name, open) {
  const details = by("panels").appendChild(document.createElement("details"));
  details.open = open;
  const summary = details.appendChild(document.createElement("summary"));
  const frame = details.appendChild(document.createElement("iframe"));
  Object.assign(frame, { title: name, src: `/axis/${name}/` });
  frame.onload = () => {
    const body = frame.contentDocument.body;
    const fit = () => { frame.style.height = `${body.offsetHeight}px`; };
    new ResizeObserver(fit).observe(body);
    details.ontoggle = fit;
  };
  const row = by("axes").tBodies[0].insertRow();
  const head = row.appendChild(document.createElement("th"));
  Object.assign(head, { scope: "row", textContent: name });
  const cells = ["state", "position", "force", "trips"].map((what) => cell(row, "–", ["position", "force"].includes(what) ? "number" : ""));
  return { name, frame, summary, cells, get axis() { return frame.contentWindow?.axis; } };
}

const put = (node, value) => { if (node.textContent !== value) node.textContent = value; };

function show({ name, axis, summary, cells }) {
  const [told, status] = [axis?.told, axis?.status];
  const state = status ? (status.ended ? "ended" : status.state) : "no connection";
  put(summary, `${name} · ${told?.loader ?? ""} · ${state}`);
  const badge = status && !status.ended ? status.state : "lost";
  put(cells[0], state);
  cells[0].dataset.state = badge;
  if (!told || axis.last("column_angle_rad") === null) return;
  put(cells[1], `${text(axis.last("column_angle_rad"))} ${told.angle.unit}`);
  put(cells[2], `${text(axis.force())} ${told.force.unit}`);
  put(cells[3], [status?.drive_fault, ...(status?.trips.map((trip) => trip.name) ?? [])].filter(Boolean).join(", ") || "none");
  controls.move(name, axis.last("column_angle_rad") / told.angle.scale, state);
  if (told.link && !links.has(told.link.name)) links.set(told.link.name, linkRow(told.link));
}

function linkRow({ name, between, kind, dual_input_n: dual }) {
  by("links").hidden = false;
  const row = by("links").tBodies[0].insertRow();
  Object.assign(row.appendChild(document.createElement("th")), { scope: "row", textContent: name });
  cell(row, kind);
  const [difference, force] = [cell(row, "–", "number"), cell(row, "–", "number")];
  const buttons = cell(row, "");
  const add = (label, press) => Object.assign(buttons.appendChild(document.createElement("button")), { type: "button", textContent: label, onclick: press });
  const sides = between.map((axis) => axes.find((one) => one.name === axis));
  const holds = () => sides.every((side) => side.axis?.status?.link_holds ?? true);
  const button = add("", () => {
    const wish = holds() ? "disconnect" : "connect";
    sides.forEach((side) => side.axis?.send({ do: wish }));
  });
  const priority = kind !== "electronic" ? [] : sides.map((side) => add(`Priority ${side.name}`, () => {
    side.axis?.send({ do: side.axis.status?.priority ? "give_priority" : "take_priority" });
  }));
  const pushes = (axis) => Math.abs(axis.force()) / axis.told.force.scale > dual;
  return () => {
    const [one, other] = sides.map((side) => side.axis);
    if (!one?.told || !other?.told) return;
    const apart = one.last("column_angle_rad") - other.last("column_angle_rad");
    put(difference, `${text(apart)} ${one.told.angle.unit}`);
    const torque = one.last("link_torque_n_m");
    put(force, torque === null ? "not measured" : `${text(torque)} ${one.told.force.unit}`);
    if (dual !== null && pushes(one) && pushes(other)) put(force, "DUAL INPUT");
    put(button, holds() ? "Disconnect" : "Connect");
    priority.forEach((press, k) => press.setAttribute("aria-pressed", String(Boolean(sides[k].axis.status?.priority))));
    controls.link(between, holds());
  };
}

const all = (command) => axes.forEach(({ axis }) => axis?.send(command));
for (const what of ["on", "off", "acknowledge"]) by(what).onclick = () => all({ do: what });
by("stop").onclick = () => all({ do: "stop" });
window.addEventListener("keydown", (event) => {
  if (event.key !== "Escape" && event.key !== " ") return;
  event.preventDefault();
  all({ do: "stop" });
}, { capture: true });
window.addEventListener("keyup", (event) => event.key === " " && event.preventDefault(), { capture: true });

function draw() {
  axes.forEach(show);
  links.forEach((row) => row());
  requestAnimationFrame(draw);
}
requestAnimationFrame(draw);
