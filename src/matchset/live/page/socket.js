// The WebSocket to the server: packets down, messages up, and a new try where it breaks.

const HEADER = 28; // u32 sequence, u32 flags, f64 time, f64 shown age, u32 length
const OF_SESSION = 2; // bit of the flags: the JSON is that of the session
const WAITS = [500, 1000, 2000]; // ms before each new try; the last one again and again
const SILENT = 2000; // ms without a word, after which a connection counts as broken; the server says something each second

export function parsePacket(buffer) {
  const view = new DataView(buffer);
  const length = view.getUint32(24, true);
  const flags = view.getUint32(4, true);
  const state = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, HEADER, length)));
  return {
    sequence: view.getUint32(0, true),
    stream: (flags >> 8) & 255,
    feed: flags >>> 16,
    ofSession: Boolean(flags & OF_SESSION),
    shownAge: view.getFloat64(16, true),
    state,
    jpeg: buffer.byteLength > HEADER + length ? new Blob([new Uint8Array(buffer, HEADER + length)], { type: "image/jpeg" }) : null,
  };
}

export class Connection {
  constructor(onPicture, onSession, onChange) {
    this.onPicture = onPicture;
    this.onSession = onSession;
    this.onChange = onChange;
    this.tries = 0;
    this.heard = performance.now();
    this.connect();
    setInterval(() => this.watch(), 250);
  }

  connect() {
    if (!("WebSocket" in window)) {
      this.onChange("this browser has no WebSocket, through which the pictures come: open the page in another one");
      return;
    }
    this.onChange(this.tries ? "connecting again …" : "connecting …");
    this.connections = (this.connections || 0) + 1;
    const number = this.connections;
    this.heard = performance.now();
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/ws`);
    socket.binaryType = "arraybuffer";
    socket.onmessage = (event) => {
      if (this.socket !== socket) return;
      this.heard = performance.now();
      this.tries = 0;
      const packet = parsePacket(event.data);
      packet.feed = `${number}.${packet.feed}`; // a server that was started again counts from the beginning
      if (packet.ofSession) this.onSession(packet.state); else this.onPicture(packet);
    };
    socket.onopen = () => { this.heard = performance.now(); this.onChange(""); };
    socket.onclose = (event) => {
      if (this.socket === socket) this.again(event.code === 4403 ? "open the address that matchset printed" : "no connection: trying again");
    };
    this.socket = socket;
  }

  again(words) {
    this.socket = null;
    this.onChange(words);
    setTimeout(() => this.connect(), WAITS[Math.min(this.tries++, WAITS.length - 1)]);
  }

  // A connection that says nothing is dead, though nobody closed it: a radio out of reach, a server that was stopped.
  watch() {
    const { socket } = this;
    if (!socket || document.hidden || performance.now() - this.heard < (socket.readyState === WebSocket.OPEN ? 1 : 3) * SILENT) return;
    this.again("no connection: trying again");
    socket.close();
  }

  // Answers whether the server can hear it.
  send(message) {
    if (!this.socket || this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }
}
