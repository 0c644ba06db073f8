// Questions and answers over the one WebSocket, and what a binary answer holds (docs/viewer.md has the table).

export const KINDS = { 1: 'water', 2: 'people', 3: 'depths', 4: 'paths', 5: 'walkers' };
const HEAD_BYTES = 56;

/** A binary message: its head, and `arrays` that look into the bytes as they came. */
export function decode(buffer) {
  const head = new DataView(buffer);
  const count = head.getUint32(8, true), fields = head.getUint32(12, true);
  const arrays = [];
  for (let k = 0; k < fields; ++k) arrays.push(new Float32Array(buffer, HEAD_BYTES + 4 * k * count, count));
  return {
    kind: KINDS[head.getUint32(4, true)], count, fields, arrays, bytes: buffer.byteLength,
    time: head.getFloat64(16, true), frame: head.getFloat64(24, true), stride: head.getUint32(32, true),
    columns: head.getUint32(36, true), x0: head.getFloat32(40, true), z0: head.getFloat32(44, true),
    cell: head.getFloat32(48, true),
  };
}

/** Asks one question of a kind at a time; a new one before the answer replaces the old one. */
export class Stream {
  constructor(handlers) {
    this.handlers = handlers; // by kind of message, and status, text, opened, closed
    this.waits = new Map(); // kind of question -> when it was asked
    this.bytes = 0; // received
    this.open();
  }

  open() {
    this.socket = new WebSocket(`ws://${location.host}/stream`);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => this.handlers.opened();
    this.socket.onclose = () => {
      this.waits.clear();
      this.handlers.closed();
      setTimeout(() => this.open(), 1000);
    };
    this.socket.onmessage = (event) => {
      this.handlers.came();
      this.take(event.data);
    };
  }

  take(data) {
    if (typeof data === 'string') {
      this.bytes += data.length;
      const answer = JSON.parse(data);
      if (answer.status) return this.handlers.status(answer.status);
      for (const kind of ['terms', 'changes', 'command']) if (kind in answer) this.waits.delete(kind);
      return this.handlers.text(answer);
    }
    this.bytes += data.byteLength;
    const message = decode(data);
    this.waits.delete(message.kind);
    if (message.kind === 'water') this.waits.delete('live');
    this.handlers[message.kind](message);
  }

  /** False while an answer of this kind is still out. */
  ask(kind, question = {}) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    const since = performance.now() - (this.waits.get(kind) ?? -1e9);
    if (since < 2000) return false;
    this.waits.set(kind, performance.now());
    this.socket.send(JSON.stringify({ get: kind, ...question }));
    return true;
  }

  command(line) {
    this.waits.delete('command');
    return this.ask('command', { line });
  }
}
