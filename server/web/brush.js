// An orbit that follows a window while it is brushed: painted over its picture, which plotly takes several frames to draw anew.

/** Share of the picture that the whole motion fills. */
const FILLED = 0.9;

export class Brush {
  #canvas = document.createElement("canvas");
  #trace;
  #time;
  #place;

  /**
   * @param {HTMLElement} place the picture of the orbit
   * @param {any} trace of the whole history, as plotly takes it
   * @param {number[]} time of its samples
   */
  constructor(place, trace, time) {
    this.#place = place;
    this.#trace = trace;
    this.#time = time;
    this.#canvas.className = "brush";
    place.append(this.#canvas);
    place.classList.add("brushed");
  }

  /** What shows the whole motion, so that nothing that is brushed lies outside: changes of the layout. */
  layout() {
    const ends = (/** @type {number[]} */ values) => values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
    const [x, y] = [ends(this.#trace.x), ends(this.#trace.y)];
    const half = Math.max(x[1] - x[0], y[1] - y[0]) / (2 * FILLED) || 1;
    const about = (/** @type {number[]} */ [low, high]) => [(low + high) / 2 - half, (low + high) / 2 + half];
    return { "xaxis.range": about(x), "yaxis.range": about(y) };
  }

  /** @param {[number, number]} range of time, half-open */
  paint([from, to]) {
    const { xaxis, yaxis } = /** @type {any} */ (this.#place)._fullLayout;
    const scale = devicePixelRatio;
    const { clientWidth: width, clientHeight: height } = this.#place;
    [this.#canvas.width, this.#canvas.height] = [width * scale, height * scale];
    const pen = this.#canvas.getContext("2d");
    if (!pen) return;
    pen.scale(scale, scale);
    pen.beginPath();
    pen.rect(xaxis._offset, yaxis._offset, xaxis._length, yaxis._length);
    pen.clip();
    pen.beginPath();
    this.#time.forEach((time, row) => {
      if (time >= from && time < to) pen.lineTo(xaxis._offset + xaxis.l2p(this.#trace.x[row]), yaxis._offset + yaxis.l2p(this.#trace.y[row]));
    });
    pen.strokeStyle = this.#trace.line.color;
    pen.lineWidth = 1;
    pen.stroke();
    this.#place.dispatchEvent(new CustomEvent("brushed"));
  }

  /** Gives the picture back. */
  end() {
    this.#canvas.remove();
    this.#place.classList.remove("brushed");
  }
}
