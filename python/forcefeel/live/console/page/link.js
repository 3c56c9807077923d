// The connection to the server: notices by their kind, frames as numbers; opened again when it breaks.

const HEADER_BYTES = 16; // float64 time, uint32 rows, uint32 number
const AGAIN_MS = 1000;

export class Link {
  // `on` holds a function for each kind of notice, and `frame`, `opened`, `lost`.
  constructor(on) {
    this.on = on;
    this.owed = null;
    this.open();
  }

  open() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    this.socket = new WebSocket(`${scheme}://${location.host}${location.pathname}live`); // of this loader or axis
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => {
      this.on.opened();
      if (this.owed) this.send(this.owed);
      this.owed = null;
    };
    this.socket.onmessage = ({ data }) => (typeof data === "string" ? this.notice(JSON.parse(data)) : this.frame(data));
    this.socket.onclose = () => {
      this.on.lost();
      setTimeout(() => this.open(), AGAIN_MS);
    };
  }

  notice(notice) {
    this.on[notice.kind]?.(notice);
  }

  frame(data) {
    const head = new DataView(data, 0, HEADER_BYTES);
    this.on.frame(head.getFloat64(0, true), new Float32Array(data, HEADER_BYTES));
  }

  // Of what is asked without a connection a stop alone is not lost: it is the first thing that the next one carries.
  send(command) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(command));
    else if (command.do === "stop") this.owed = command;
  }
}
