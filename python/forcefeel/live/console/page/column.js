// The column as it moves, and the hand that drags it: by mouse, touch or game pad.

const KEEP_MS = 150; // a hand of which nothing is heard lets go
const PAD_DEAD = 0.12;
const REACH = 190; // of the grip, in the drawing
const PULL = 120; // in the drawing, at full force

export class Column {
  constructor({ angle, force, hand }, send, mode) {
    this.svg = document.getElementById("column");
    Object.assign(this, { angle, force, send, mode, full: 100, now: 0, pulled: 0, hand: null, sent: 0 });
    Object.assign(this, { allowed: false, mine: false, centered: false });
    this.svg.onpointerdown = (event) => hand && this.allowed && this.grab(event);
    this.svg.onpointermove = (event) => this.hand?.pointer === event.pointerId && this.drag(event);
    this.svg.onpointerup = this.svg.onpointercancel = (event) => this.hand?.pointer === event.pointerId && this.letGo();
    const turn = (at) => `${REACH * Math.sin(at)} ${-REACH * Math.cos(at)}`;
    const [low, high] = [angle.low / angle.scale, angle.high / angle.scale];
    document.getElementById("arc").setAttribute("d", `M ${turn(low)} A ${REACH} ${REACH} 0 0 1 ${turn(high)}`);
  }

  place(event) {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    return { x: at.x, angle: Math.atan2(at.x, Math.max(-at.y, 20)) };
  }

  grab(event) {
    const from = this.place(event);
    this.svg.setPointerCapture(event.pointerId);
    this.svg.classList.add("held");
    this.hand = { pointer: event.pointerId, from, off: this.now / this.angle.scale - from.angle };
    this.drag(event);
  }

  drag(event) {
    const at = this.place(event);
    if (this.mode() === "hold") {
      const wanted = at.angle + this.hand.off;
      const held = Math.min(Math.max(wanted, this.angle.low / this.angle.scale), this.angle.high / this.angle.scale);
      this.wish({ angle_rad: held });
    } else {
      this.wish({ force_n: (clip((at.x - this.hand.from.x) / PULL) * this.full) / this.force.scale });
    }
  }

  wish(hand) {
    this.hand.wish = { do: "hand", ...hand };
    this.hand.fresh = true;
  }

  letGo() {
    this.drop();
    this.send({ do: "hand" });
  }

  drop() {
    this.hand = null;
    this.svg.classList.remove("held");
  }

  // Who gives control up, or loses it, has no hand any more: a wish sent on would take control again.
  allow(allowed, mine) {
    if (!allowed || (this.mine && !mine)) {
      this.drop();
      this.centered = false;
    }
    Object.assign(this, { allowed, mine });
  }

  // Each time that the screen is drawn: what the hand wishes, once; and again before it lapses.
  tick(time) {
    this.pad();
    if (!this.hand?.wish || (!this.hand.fresh && time - this.sent < KEEP_MS)) return;
    this.send(this.hand.wish);
    this.hand.fresh = false;
    this.sent = time;
  }

  pad() {
    const axis = [...(navigator.getGamepads?.() ?? [])].find(Boolean)?.axes ?? [];
    const pushed = axis.slice(0, 2).reduce((most, value) => (Math.abs(value) > Math.abs(most) ? value : most), 0);
    document.getElementById("pad").textContent = axis.length ? "a game pad pulls too" : "";
    // A stick that is pushed when control comes, or that rests elsewhere, has to be seen in its middle first.
    this.centered ||= axis.length > 0 && Math.abs(pushed) <= PAD_DEAD;
    if (Math.abs(pushed) > PAD_DEAD && this.allowed && this.centered && (!this.hand || this.hand.pointer === "pad")) {
      this.hand ??= { pointer: "pad" };
      this.wish({ force_n: (pushed * this.full) / this.force.scale });
    } else if (this.hand?.pointer === "pad") {
      this.letGo();
    }
  }

  draw(angle, programmed, force) {
    this.now = angle;
    const turned = (shown) => `rotate(${((shown / this.angle.scale) * 180) / Math.PI})`;
    document.getElementById("stick").setAttribute("transform", turned(angle));
    document.getElementById("ghost").setAttribute("transform", turned(programmed ?? angle));
    const at = angle / this.angle.scale;
    const long = clip((force ?? 0) / this.full) * PULL;
    const head = Math.sign(long) * Math.min(10, Math.abs(long));
    const [x, y] = [168 * Math.sin(at), -168 * Math.cos(at)];
    const arrow = Math.abs(long) < 2 ? "" : `M ${x} ${y} h ${long} m ${-head} ${-8} l ${head} 8 l ${-head} 8`;
    document.getElementById("pull").setAttribute("d", arrow);
  }
}

const clip = (share) => Math.min(Math.max(share, -1), 1);
