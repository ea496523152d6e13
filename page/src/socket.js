// The line to the server: questions with numbers, parts of answers as they come; it connects again by itself.

export class Line extends EventTarget {
  constructor() {
    super();
    this.waiting = new Map();
    this.last = 0;
    this.tries = 0;
    this.connect();
  }

  connect() {
    const socket = new WebSocket(`ws://${location.host}/socket`);
    this.socket = socket;
    socket.addEventListener("open", () => {
      this.tries = 0;
      this.dispatchEvent(new Event("open"));
    });
    socket.addEventListener("message", (event) => this.take(JSON.parse(event.data)));
    socket.addEventListener("close", () => this.closed());
  }

  closed() {
    const lost = [...this.waiting.values()];
    this.waiting.clear();
    for (const one of lost) one.fail(new Error("the connection was lost"));
    this.dispatchEvent(new Event("lost"));
    setTimeout(() => this.connect(), Math.min(500 * 2 ** this.tries++, 8000));
  }

  take(message) {
    const one = this.waiting.get(message.id);
    if (message.id === null) this.dispatchEvent(new CustomEvent("refused", { detail: message.data }));
    if (!one) return;
    if (message.part === "done") one.done(message.data);
    else if (["error", "busy", "cancelled"].includes(message.part)) one.fail(refusal(message));
    else return void one.part(message.part, message.data);
    this.waiting.delete(message.id);
  }

  // Asks for a task; `part` is called with each part of the answer. The promise has `id`, for `cancel`.
  ask(task, said, part = () => {}) {
    const id = ++this.last;
    const answer = new Promise((done, fail) => {
      if (this.socket.readyState !== WebSocket.OPEN) return void fail(new Error("not connected"));
      this.waiting.set(id, { done, fail, part });
      this.socket.send(JSON.stringify({ id, task, said }));
    });
    answer.id = id;
    return answer;
  }

  cancel(id) {
    if (this.waiting.has(id)) this.socket.send(JSON.stringify({ id: ++this.last, task: "cancel", said: { of: id } }));
  }
}

function refusal(message) {
  const error = new Error(message.data ?? "cancelled");
  error.kind = message.part;
  return error;
}

// One question in flight at most; of those that come in the meantime the newest is asked next.
export class Newest {
  constructor(does) {
    this.does = does;
    this.flying = false;
    this.wanted = null;
  }

  ask(given) {
    this.wanted = given;
    if (!this.flying) this.fly();
  }

  async fly() {
    this.flying = true;
    while (this.wanted !== null) {
      const given = this.wanted;
      this.wanted = null;
      await this.does(given);
    }
    this.flying = false;
  }
}
