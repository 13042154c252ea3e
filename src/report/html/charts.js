// Small charts as SVG: lines, bars and dots between two axes, drawn for the width that there is.
const SVG = 'http://www.w3.org/2000/svg';

function svg(tag, attributes, text) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

/** Round numbers from 0 or `low` to `high`, about `count` of them. */
export function ticks(low, high, count) {
  const span = high - low || 1;
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough * 0.999);
  const out = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; ++k) out.push(Number((k * step).toPrecision(12)));
  return out;
}

/** A chart that draws itself again when its width changes. */
export class Chart {
  constructor(container, height, label) {
    this.container = container;
    this.height = height;
    this.label = label;
    this.content = null;
    this.head = null;
    new ResizeObserver(() => this.draw()).observe(container);
  }

  /**
   * @param content {x: [low, high], y: [low, high], xUnit, yUnit, label, lines: [{x, y, colour, width}], bars: [{x, y}], dots: [{x, y, ...}],
   *   bounds: [{x} or {y}]}
   */
  set(content) {
    this.content = content;
    this.draw();
  }

  /** The number on the x axis at a place of the screen. */
  at(clientX) {
    const { left, width } = this.place;
    const box = this.root.getBoundingClientRect();
    const [low, high] = this.content.x;
    return low + (Math.min(Math.max((clientX - box.left - left) / width, 0), 1) || 0) * (high - low);
  }

  /** Moves the line that marks a time. */
  mark(x) {
    this.marked = x;
    if (!this.head || !this.content) return;
    const [low, high] = this.content.x;
    const { left, width } = this.place;
    this.head.style.transform = `translateX(${left + ((x - low) / (high - low || 1)) * width}px)`;
  }

  draw() {
    const total = this.container.clientWidth;
    if (!this.content || total === 0) return;
    const { x, y, lines = [], bars = [], dots = [], bounds = [] } = this.content;
    const place = { left: 46, top: 22, width: total - 46 - 12, height: this.height - 22 - 36 };
    this.place = place;
    const toX = (v) => place.left + ((v - x[0]) / (x[1] - x[0] || 1)) * place.width;
    const toY = (v) => place.top + (1 - (v - y[0]) / (y[1] - y[0] || 1)) * place.height;
    const root = svg('svg', { viewBox: `0 0 ${total} ${this.height}`, height: this.height, role: 'img', 'aria-label': this.content.label });
    const bottom = place.top + place.height;
    for (const v of ticks(y[0], y[1], 4)) {
      root.append(svg('line', { class: 'axis', x1: place.left, x2: place.left + place.width, y1: toY(v), y2: toY(v) }));
      root.append(svg('text', { x: place.left - 8, y: toY(v) + 4, 'text-anchor': 'end' }, String(v)));
    }
    for (const v of ticks(x[0], x[1], Math.max(3, Math.floor(place.width / 90)))) {
      root.append(svg('line', { class: 'axis', x1: toX(v), x2: toX(v), y1: bottom, y2: bottom + 4 }));
      root.append(svg('text', { x: toX(v), y: bottom + 17, 'text-anchor': 'middle' }, String(v)));
    }
    root.append(svg('text', { x: place.left + place.width, y: bottom + 31, 'text-anchor': 'end' }, this.content.xUnit));
    root.append(svg('text', { x: 0, y: 11, 'text-anchor': 'start' }, this.content.yUnit));
    for (const { x: bx, y: by, width = 3, colour = 'var(--accent)', title } of bars) {
      const bar = svg('rect', { x: toX(bx) - width / 2, width, y: toY(by), height: Math.max(0, bottom - toY(by)), fill: colour });
      if (title) bar.append(svg('title', {}, title));
      root.append(bar);
    }
    for (const { x: xs, y: ys, colour, width = 1.5, opacity = 1 } of lines) {
      let path = '';
      for (let i = 0; i < xs.length; ++i) path += `${i ? 'L' : 'M'}${toX(xs[i]).toFixed(1)} ${toY(Math.min(ys[i], y[1])).toFixed(1)}`;
      root.append(svg('path', { d: path, fill: 'none', stroke: colour, 'stroke-width': width, opacity, 'stroke-linejoin': 'round' }));
    }
    for (const bound of bounds) {
      const across = bound.y !== undefined;
      const [x1, x2] = across ? [place.left, place.left + place.width] : [toX(bound.x), toX(bound.x)];
      const [y1, y2] = across ? [toY(bound.y), toY(bound.y)] : [place.top, bottom];
      root.append(svg('line', { class: 'bound', x1, x2, y1, y2 }));
    }
    for (const { x: dx, y: dy, colour, radius = 4, hollow, title } of dots) {
      const dot = svg('circle', { cx: toX(dx), cy: toY(dy), r: radius, fill: hollow ? 'none' : colour, stroke: colour, 'stroke-width': 1.5 });
      if (title) dot.append(svg('title', {}, title));
      root.append(dot);
    }
    this.root = root;
    this.container.replaceChildren(root);
    this.head = null;
    if (this.content.head) {
      // No part of the drawing, which would be painted anew at every frame.
      this.head = document.createElement('div');
      this.head.className = 'head';
      this.head.style.top = `${place.top}px`;
      this.head.style.height = `${place.height}px`;
      this.container.append(this.head);
    }
    if (this.marked !== undefined) this.mark(this.marked);
  }
}

/** A list that says which line is which. */
export function keysOfLines(container, entries) {
  const list = document.createElement('div');
  list.className = 'keys-of-lines';
  for (const { name, colour, dashed } of entries) {
    const item = document.createElement('span');
    const line = document.createElement('i');
    line.style.borderColor = colour;
    if (dashed) line.style.borderTopStyle = 'dashed';
    item.append(line, name);
    list.append(item);
  }
  container.querySelector('.keys-of-lines')?.remove();
  container.append(list);
}
