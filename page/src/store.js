// What the page is of: the muscle as opened, what was changed since, pressure and load; with undo.

const MOST = 200;

export class Store extends EventTarget {
  constructor() {
    super();
    this.now = null;
    this.past = [];
    this.future = [];
    this.settled = null;
  }

  // A muscle as the server tells it; the bench begins at the pressure it is meant for, or as given.
  open(told, bench = {}) {
    const pressure = bench.pressure ?? told.top;
    const now = { told, changes: {}, pressure, hold: bench.hold ?? "force", value: bench.value ?? 0 };
    this.put(now, { settle: true, opened: true });
  }

  // Something changed; `settle` where a step of undo ends, such as when a slider is let go.
  change(patch, settle) {
    this.put({ ...this.now, ...patch }, { settle });
  }

  changeField(name, value, settle) {
    this.change({ changes: { ...this.now.changes, [name]: value } }, settle);
  }

  put(now, { settle = false, opened = false } = {}) {
    this.now = now;
    if (settle && now !== this.settled) {
      if (this.settled) this.past.push(this.settled);
      if (this.past.length > MOST) this.past.shift();
      this.future = [];
      this.settled = now;
    }
    this.tell({ settled: settle, opened });
  }

  step(from, to) {
    if (!from.length) return;
    to.push(this.settled);
    const opened = from.at(-1).told !== this.now.told;
    this.settled = from.pop();
    this.now = this.settled;
    this.tell({ settled: true, opened, stepped: true });
  }

  undo() {
    this.step(this.past, this.future);
  }

  redo() {
    this.step(this.future, this.past);
  }

  tell(detail) {
    this.dispatchEvent(new CustomEvent("change", { detail }));
  }

  // The value that a control shows, in its own unit.
  shown(slider) {
    return this.now.changes[slider.name] ?? slider.value;
  }

  // The muscle as the server reads it: changed numbers as text with their units.
  muscle() {
    const { told, changes } = this.now;
    const units = Object.fromEntries(told.sliders.map((one) => [one.name, one]));
    const said = Object.entries(changes).map(([name, value]) => {
      const slider = units[name];
      return [name, slider && slider.unit ? `${value} ${slider.unit}` : value];
    });
    return { from: told.from, changes: Object.fromEntries(said) };
  }

  // What is to be looked at.
  asked() {
    const { told, pressure, hold, value } = this.now;
    return { muscle: this.muscle(), pressure, hold, value, top: told.top };
  }
}
