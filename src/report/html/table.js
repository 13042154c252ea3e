// The table of animations: sorts by any column, and a row's name shows that animation in the player.
import { bytes, degrees, length, number, percent, ratio, seconds } from './format.js';

const errorOf = (row) => row.error;

/** Per column: title, its number or text, and how to write it. */
function columnsOf(report) {
  const share = (value) => `${percent(value / report.size_world_units)} · ${length(value)}`;
  const stays = (row) => row.outcome !== undefined && row.outcome !== 'compressed';
  const error = (title, key, write = share, none = '') => ({
    title,
    value: (row) => (stays(row) ? -1 : (errorOf(row)[key] ?? -1)),
    write: (value) => (value < 0 ? none : write(value)),
  });
  const worst = [
    { title: 'worst joint', text: true, value: (row) => (stays(row) ? '' : (errorOf(row).worst_name ?? '')), write: (value) => value },
    error('at', 'worst_seconds', seconds),
  ];
  if (report.command === 'verify') {
    return [
      error('max error', 'max_world_units'),
      error('max joint error', 'max_joint_world_units'),
      error('mean error', 'mean_world_units'),
      error('99 %', 'percentile_99_world_units', (value) => percent(value / report.size_world_units)),
      error('rotation', 'max_rotation_degrees', degrees),
      error('jitter', 'jitter_world_units', length),
      error('loop seam', 'loop_seam_world_units', length, '-'),
      error('drift', 'contact_drift_world_units', length),
      ...worst,
      { title: 'holds', text: true, value: (row) => (row.holds ? 'yes' : 'no'), write: (value) => value },
    ];
  }
  return [
    { title: 'frames', value: (row) => row.frames, write: number },
    { title: 'joints', value: (row) => row.joints, write: number },
    { title: 'length', value: (row) => row.duration_seconds, write: seconds },
    { title: 'bytes before', value: (row) => row.bytes_before, write: bytes },
    { title: 'after', value: (row) => row.bytes_after, write: bytes },
    {
      title: 'ratio',
      value: (row) => (row.bytes_after > 0 ? row.bytes_before / row.bytes_after : 0),
      write: (_, row) => (stays(row) ? 'stays' : ratio(row.bytes_before, row.bytes_after)),
    },
    error('max error', 'max_world_units'),
    error('mean error', 'mean_world_units'),
    ...worst,
  ];
}

export class ClipTable {
  constructor(table, report, onChoose) {
    this.table = table;
    this.columns = [{ title: 'animation', text: true, value: (row) => row.name, write: (value) => value }, ...columnsOf(report)];
    this.rows = report.animations.map((row, index) => ({ row, index, element: null }));
    this.order = { column: -1, sign: 1 };
    this.onChoose = onChoose;
    this.#build(report);
  }

  /** Marks the row of an animation. */
  choose(row) {
    for (const one of this.rows) one.element.classList.toggle('chosen', one.row === row);
  }

  #build(report) {
    const head = this.table.createTHead().insertRow();
    this.heads = this.columns.map(({ title, text }, i) => {
      const cell = document.createElement('th');
      cell.scope = 'col';
      if (text) cell.className = 'text';
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = title;
      button.addEventListener('click', () => this.#sort(i));
      cell.append(button);
      head.append(cell);
      return cell;
    });
    this.body = this.table.createTBody();
    for (const one of this.rows) {
      one.element = document.createElement('tr');
      one.element.dataset.animation = one.row.name;
      this.columns.forEach((column, i) => one.element.append(this.#cell(column, one, i === 0)));
    }
    this.#show();
    if (report.totals && this.rows.length > 1) this.#addTotals(report);
  }

  #cell(column, { row, index }, isName) {
    const cell = document.createElement(isName ? 'th' : 'td');
    const value = column.value(row);
    cell.dataset.value = value;
    if (column.text) cell.className = 'text';
    if (!isName) {
      cell.textContent = column.write(value, row);
      return cell;
    }
    cell.scope = 'row';
    if (row.reason) cell.title = row.reason;
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = value;
    button.addEventListener('click', () => this.onChoose(row, index));
    cell.append(button);
    return cell;
  }

  #addTotals({ totals, size_world_units: size }) {
    const cells = {
      frames: number(totals.frames),
      length: seconds(totals.duration_seconds),
      'bytes before': bytes(totals.bytes_before),
      after: bytes(totals.bytes_after),
      ratio: ratio(totals.bytes_before, totals.bytes_after),
      'max error': totals.compressed > 0 ? `${percent(totals.max_world_units / size)} · ${length(totals.max_world_units)}` : '',
    };
    const row = this.table.createTFoot().insertRow();
    this.columns.forEach(({ title, text }, i) => {
      const cell = document.createElement(i === 0 ? 'th' : 'td');
      if (i === 0) cell.scope = 'row';
      if (text) cell.className = 'text';
      cell.textContent = i === 0 ? `all ${totals.animations}` : (cells[title] ?? '');
      row.append(cell);
    });
  }

  #sort(column) {
    // Numbers are most wanted from the largest down, text from A to Z.
    const first = this.columns[column].text ? 1 : -1;
    this.order = { column, sign: this.order.column === column ? -this.order.sign : first };
    const { value, text } = this.columns[column];
    const compare = text ? (a, b) => value(a.row).localeCompare(value(b.row)) : (a, b) => value(a.row) - value(b.row);
    this.rows.sort((a, b) => this.order.sign * compare(a, b) || a.index - b.index);
    this.heads.forEach((head, i) => {
      if (i === column) head.setAttribute('aria-sort', this.order.sign > 0 ? 'ascending' : 'descending');
      else head.removeAttribute('aria-sort');
    });
    this.#show();
  }

  #show() {
    this.body.append(...this.rows.map(({ element }) => element));
  }
}
