// The page: fills the parts from the data and connects them.
import { ANIMATION, drawBars } from './bars.js';
import { Chart, keysOfLines } from './charts.js';
import { readData } from './data.js';
import { bytes, length, number, percent, ratio, size } from './format.js';
import { Player } from './player.js';
import { spectrumOf } from './spectrum.js';
import { ClipTable } from './table.js';

const find = (id) => document.getElementById(id);
const data = readData(find('data').textContent);
const { report } = data;
const isVerify = report.command === 'verify';

/** Colours of the lines of single points; the largest error has the accent. */
const LINES = ['var(--keys)', 'var(--cold)', 'var(--json)', 'var(--soft)'];

function fileName(path) {
  return path.slice(path.lastIndexOf('/') + 1);
}

function addFact(title, value, more, tone) {
  const box = document.createElement('div');
  const term = document.createElement('dt');
  const number = document.createElement('dd');
  term.textContent = title;
  number.textContent = value;
  if (tone) number.className = tone;
  if (more) {
    const small = document.createElement('small');
    small.textContent = more;
    number.append(small);
  }
  box.append(term, number);
  find('facts').append(box);
}

function fillHead() {
  const [from, to] = isVerify ? [report.original, report.file] : [report.input, report.output];
  find('kind').textContent = `gltf-nmc ${report.version} · ${isVerify ? 'comparison of two files' : `compression, profile ${report.profile}`}`;
  find('name').textContent = `${fileName(from)} → ${fileName(to)}`;
  const sum = (which) => data.parts.reduce((total, part) => total + part[which], 0);
  const before = report.file_bytes_before ?? sum('before');
  const after = report.file_bytes_after ?? sum('after');
  const animations = (which) => data.parts.filter(({ name }) => ANIMATION.includes(name)).reduce((total, part) => total + part[which], 0);
  const [animationBefore, animationAfter] = report.totals
    ? [report.totals.bytes_before, report.totals.bytes_after]
    : [animations('before'), animations('after')];
  addFact('animations', ratio(animationBefore, animationAfter), `${bytes(animationBefore)} → ${bytes(animationAfter)} bytes`);
  addFact('whole file', ratio(before, after), `${bytes(before)} → ${bytes(after)} bytes`);
  const worst = isVerify ? Math.max(0, ...report.animations.map((row) => row.error.max_world_units)) : report.totals.max_world_units;
  addFact('largest error', percent(worst / data.size), `${length(worst)} on a character of ${length(data.size)}`);
  const tolerance = report.tolerance_world_units;
  const words = `${percent(tolerance / data.size)} = ${length(tolerance)}`;
  const joints = report.joints_alone || report.profile === 'paper' ? ', on joints alone' : '';
  if (isVerify) addFact('tolerance', report.holds ? 'kept' : 'not kept', words + joints, report.holds ? 'good' : 'bad');
  else addFact('tolerance', percent(tolerance / data.size), `${length(tolerance)}${joints}; ${report.totals.compressed} of ${number(report.totals.animations)} animations compressed`);
}

function fillNotes() {
  const groups = new Map();
  for (const row of report.animations) if (row.reason) groups.set(row.reason, [...(groups.get(row.reason) ?? []), row.name]);
  const notes = [...(report.notes ?? []), ...[...groups].map(([reason, names]) => `${names.join(', ')}: stays, ${reason}`)];
  for (const note of notes) {
    const item = document.createElement('li');
    item.textContent = note;
    find('notes').append(item);
  }
  find('download').href = URL.createObjectURL(new Blob([JSON.stringify(report, null, 2)], { type: 'application/json' }));
}

/** The list on wide screens, the select on narrow ones. */
class ClipList {
  constructor(clips, onChoose) {
    this.clips = clips;
    this.onChoose = onChoose;
    this.list = find('clip-list');
    this.items = clips.map((clip, i) => {
      const item = document.createElement('li');
      item.role = 'option';
      item.id = `clip-${i}`;
      const name = document.createElement('span');
      name.textContent = clip.name;
      item.title = clip.name;
      const share = document.createElement('span');
      const stays = clip.row?.outcome !== undefined && clip.row.outcome !== 'compressed';
      share.textContent = !clip.row || stays ? 'stays' : percent(clip.row.error.max_world_units / data.size);
      item.append(name, share);
      item.addEventListener('click', () => onChoose(clip));
      const option = document.createElement('option');
      option.value = i;
      option.textContent = clip.name;
      find('clip-select').append(option);
      return item;
    });
    this.list.append(...this.items);
    find('clip-select').addEventListener('change', (event) => onChoose(clips[Number(event.target.value)]));
    find('clip-filter').addEventListener('input', (event) => this.#filter(event.target.value.toLowerCase()));
    this.list.addEventListener('keydown', (event) => this.#key(event));
    if (clips.length < 8) find('clip-filter').hidden = true;
  }

  choose(clip) {
    this.chosen = this.clips.indexOf(clip);
    this.items.forEach((item, i) => item.setAttribute('aria-selected', i === this.chosen));
    this.list.setAttribute('aria-activedescendant', `clip-${this.chosen}`);
    find('clip-select').value = this.chosen;
    const { offsetTop, offsetHeight } = this.items[this.chosen];
    const { scrollTop, clientHeight } = this.list;
    const top = offsetTop - this.list.offsetTop;
    if (top < scrollTop) this.list.scrollTop = top;
    else if (top + offsetHeight > scrollTop + clientHeight) this.list.scrollTop = top + offsetHeight - clientHeight;
  }

  #filter(text) {
    this.items.forEach((item, i) => (item.hidden = !this.clips[i].name.toLowerCase().includes(text)));
  }

  #key(event) {
    const seen = this.clips.filter((_, i) => !this.items[i].hidden);
    const at = seen.indexOf(this.clips[this.chosen]);
    const to = { ArrowUp: at - 1, ArrowDown: at + 1, Home: 0, End: seen.length - 1 }[event.key];
    if (to === undefined || !seen[to]) return;
    event.preventDefault();
    this.onChoose(seen[to]);
  }
}

const charts = {
  error: new Chart(find('error-chart'), 220),
  spectrum: new Chart(find('spectrum-chart'), 200),
  candidates: new Chart(find('candidates-chart'), 200),
};

function drawErrors(clip) {
  const { seconds, max, worst } = clip.profile;
  const percentOf = (values) => Array.from(values, (v) => (100 * v) / data.size);
  const { tolerance_world_units: usual, finest_tolerance_world_units: finest, share_of_tolerance: used } = clip.row;
  const tolerances = [...new Set([usual, finest])].map((length) => (100 * length) / data.size);
  const tolerance = Math.max(...tolerances);
  const start = seconds[0] ?? 0;
  const x = Array.from(seconds, (v) => v - start);
  const most = Math.max(tolerance * 1.15, Math.min(1e6, Math.max(...percentOf(max)) * 1.05));
  const lines = worst.map((point, i) => ({ x, y: percentOf(point.error), colour: LINES[i], width: 1.2, opacity: 0.9 }));
  lines.push({ x, y: percentOf(max), colour: 'var(--accent)', width: 1.8 });
  charts.error.set({
    x: [0, Math.max(x[x.length - 1] ?? 0, 1e-3)],
    y: [0, most],
    xUnit: 'seconds',
    yUnit: '% of size',
    label: `The largest error over time stays ${used <= 1 ? 'under' : 'not under'} the tolerance of ${percent(tolerance / 100)}${tolerances.length > 1 ? ' and its exceptions' : ''}.`,
    lines,
    bounds: tolerances.map((y) => ({ y })),
    head: true,
  });
  find('error-caption').textContent = 'at every key and between; the line is where the player is';
  const names = worst.map(({ name }, i) => ({ name: `at ${name}`, colour: LINES[i] }));
  keysOfLines(find('error-chart').parentElement, [
    { name: 'worst of all points', colour: 'var(--accent)' },
    ...names,
    { name: tolerances.length > 1 ? 'tolerance, and the finest of an exception' : 'tolerance', colour: 'var(--bad)', dashed: true },
  ]);
}

function drawSpectrum(clip) {
  const caption = find('spectrum-caption');
  if (clip.set < 0) {
    charts.spectrum.set({ x: [0, 1], y: [0, 1], xUnit: 'Hz', yUnit: 'curves', label: 'no frequencies' });
    caption.textContent = 'this animation is not compressed';
    return;
  }
  const spectrum = spectrumOf(data.sets[clip.set].bytes, clip.clip);
  const highest = Math.max(spectrum.hertz[spectrum.hertz.length - 1] ?? 0, 1);
  const count = Math.min(60, Math.max(1, spectrum.hertz.length));
  const sums = new Array(count).fill(0);
  spectrum.hertz.forEach((hertz, i) => (sums[Math.min(count - 1, Math.floor((hertz / (highest * 1.001)) * count))] += spectrum.weights[i]));
  const bars = sums.map((y, i) => ({ x: ((i + 0.5) / count) * highest, y, width: Math.max(2, 300 / count), title: `${number(y)}` }));
  charts.spectrum.set({
    x: [0, highest],
    y: [0, Math.max(...sums, 1)],
    xUnit: 'Hz',
    yUnit: 'weights',
    label: `Weights by frequency, up to ${highest.toFixed(1)} Hz.`,
    bars: bars.filter(({ y }) => y > 0),
  });
  const total = spectrum.weights.reduce((a, b) => a + b, 0);
  const kinds = { cosine: 'cosines over the whole clip', periodic: 'whole cycles between two anchor poses', sine: 'sines between anchor poses', network: 'of the network' };
  caption.textContent = `${number(total)} weights, ${kinds[spectrum.basis]}, and ${number(spectrum.atoms)} corrections`;
}

function drawCandidates(clip) {
  const candidates = clip.candidates ?? [];
  find('candidates-figure').hidden = candidates.length === 0;
  if (candidates.length === 0) return;
  const share = (error) => (100 * error) / data.size;
  const tolerance = share(clip.row.tolerance_world_units);
  const shown = candidates.filter(({ error }) => Number.isFinite(error) && share(error) < tolerance * 20);
  const mostBytes = Math.max(...shown.map((c) => c.bytes));
  const mostError = Math.max(tolerance * 1.2, ...shown.map((c) => share(c.error)));
  const colourOf = ({ chosen, kept }) => (chosen ? 'var(--accent)' : kept ? 'var(--keys)' : 'var(--ghost)');
  charts.candidates.set({
    x: [0, mostError * 1.05],
    y: [Math.min(...shown.map((c) => c.bytes)) * 0.9, mostBytes * 1.05],
    xUnit: 'largest error, % of size',
    yUnit: 'bytes',
    label: `${shown.length} candidates by bytes and error; the smallest within the tolerance was taken.`,
    bounds: [{ x: tolerance }],
    dots: shown.map((c) => ({
      x: share(c.error),
      y: c.bytes,
      colour: colourOf(c),
      hollow: !c.chosen,
      radius: c.chosen ? 5.5 : 4,
      title: `${number(c.bytes)} bytes, ${percent(c.error / data.size)}`,
    })),
  });
  find('candidates-caption').textContent = 'bytes against error; the dashed line is the tolerance, the full dot was taken';
}

fillHead();
fillNotes();
drawBars(find('bars'), data.parts);

let player = null;
let list = null;
const table = new ClipTable(find('table'), report, (row) => {
  const clip = data.clips.find((one) => one.row === row);
  if (!clip) return;
  player.choose(clip);
  find('player').scrollIntoView({ block: 'start' });
});

if (data.clips.length > 0) {
  find('player').hidden = false;
  player = new Player(data, {
    onTime: (seconds) => charts.error.mark(seconds - (player?.start ?? 0)),
    onClip: (clip) => {
      list.choose(clip);
      table.choose(clip.row);
      drawErrors(clip);
      drawSpectrum(clip);
      drawCandidates(clip);
    },
  });
  list = new ClipList(data.clips, (clip) => player.choose(clip));
  if (window.matchMedia('(max-width: 520px)').matches) find('layout').value = 'over';
  player.choose(data.clips[0]);
  const chart = find('error-chart');
  const seek = (event) => player.seek(charts.error.at(event.clientX) + player.start);
  chart.addEventListener('pointerdown', (event) => {
    chart.setPointerCapture(event.pointerId);
    seek(event);
  });
  chart.addEventListener('pointermove', (event) => event.buttons > 0 && seek(event));
}

/** For tests and for people at the console. */
window.nmcReport = { data, player };
document.documentElement.dataset.ready = 'true';
