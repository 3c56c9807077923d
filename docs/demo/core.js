// The compiled model (crates/browser): numbers in, numbers out. Needs engine.js.
"use strict";

const OUTPUTS = ["angle", "rate", "feel", "feelRate", "drive", "cell", "pressure", "flow", "current", "force"];
const NOTHING = NaN; // an angle at which no hand holds

/** The model, unpacked: `new Core(await Core.unpack())`. */
class Core {
  static async unpack() {
    const packed = Uint8Array.from(atob(forcefeelEngine.wasm), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const { instance } = await WebAssembly.instantiate(await new Response(stream).arrayBuffer());
    return instance.exports;
  }

  constructor(wasm) {
    this.wasm = wasm;
    this.rooms = {};
  }

  /** A lasting room of so many numbers, by its name; larger ones replace it. */
  room(name, size) {
    if (!(this.rooms[name]?.size >= size)) this.rooms[name] = { at: this.wasm.forcefeel_room(size), size };
    return this.rooms[name].at;
  }

  view(at, size) {
    return new Float64Array(this.wasm.memory.buffer, at, size);
  }

  put(name, numbers) {
    const at = this.room(name, numbers.length);
    this.view(at, numbers.length).set(numbers);
    return at;
  }

  /** A loader of a setup's numbers. */
  loader(setup) {
    const step = setup[forcefeelEngine.data.loaders.robust.values.length];
    return new Loader(this, this.wasm.forcefeel_loader(this.put("setup", setup)), step);
  }

  /** The programmed feel's release of a setup, a sample every so many seconds. */
  ideal(setup, sample, samples) {
    const at = this.room("ideal", samples);
    this.wasm.forcefeel_ideal(this.put("setup", setup), sample, samples, at);
    return this.view(at, samples).slice();
  }

  /** The verdict on a release: the first quantity that fails or null, and the share of the tolerance that is used. */
  judge(angles, ideal, sample) {
    const verdict = this.room("verdict", 2);
    const [rule, one, other] = [["rule", forcefeelEngine.data.rule], ["angles", angles], ["ideal", ideal]].map(
      ([name, numbers]) => this.put(name, numbers)
    );
    this.wasm.forcefeel_judge(rule, sample, angles.length, one, other, verdict);
    const [first, margin] = this.view(verdict, 2);
    return { fails: first < 0 ? null : forcefeelEngine.data.quantities[first], used: 1 - margin };
  }
}

/** A loader between two steps. */
class Loader {
  constructor(core, at, step) {
    Object.assign(this, { core, at, step });
  }

  /** So many steps: rows of OUTPUTS, one after another. */
  run(steps) {
    const rows = this.core.room("rows", steps * OUTPUTS.length);
    this.core.wasm.forcefeel_run(this.at, steps, rows);
    return this.core.view(rows, steps * OUTPUTS.length);
  }

  /** A hand holds the grip at an angle in rad, or NOTHING. */
  hold(angle) {
    this.core.wasm.forcefeel_hold(this.at, angle);
  }

  /** A host adds a force in N and a spring rate in N m/rad. */
  add(force, stiffness) {
    this.core.wasm.forcefeel_add(this.at, force, stiffness);
  }

  forget() {
    this.core.wasm.forcefeel_forget(this.at);
  }
}

/** The numbers of a loader that was held at an angle: law and feel of engine.js, other values of the machine by their names. */
function setup(law, feel, values = {}, { delay, held = 0 } = {}) {
  const { places, loaders, numbers } = forcefeelEngine.data;
  const machine = loaders[law].values.slice();
  const [step, period, own] = loaders[law].timing;
  const changed = { "feel.damping": feel.values[0], "feel.stiffness": feel.values[1], ...values };
  for (const [name, value] of Object.entries(changed)) machine[places[name]] = value;
  const [kind, lawNumbers] = feel.laws[law];
  const padding = new Array(numbers - lawNumbers.length).fill(0);
  return [...machine, step, period, period && (delay ?? own), held, kind, ...lawNumbers, ...padding];
}
