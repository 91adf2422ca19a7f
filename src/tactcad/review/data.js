// Reads the page's data, and makes elements: texts are only ever set as text.
const byId = (id) => document.getElementById(id);

// An element with properties (data-* and aria-* as attributes) and children; a string is text.
function el(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === null || value === undefined) continue;
    if (name.includes('-') || name === 'role' || name === 'for') made.setAttribute(name, value);
    else made[name] = value;
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

async function unpacked(id) {
  const holder = byId(id);
  const text = atob(holder.textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  holder.remove();  // so that the page holds it once
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Response(stream).arrayBuffer();
}

async function module(bytes) {
  const address = URL.createObjectURL(new Blob([bytes], {type: 'text/javascript'}));
  try {
    return await import(address);
  } finally {
    URL.revokeObjectURL(address);
  }
}

const INTEGERS = new Set(['triangles', 'triangles_per_face', 'segments_per_edge', 'face_types', 'edge_types', 'quads']);

// Views on the block, by the names in the table: {name: [start in bytes, count]}.
function arrays(block, table) {
  const found = {};
  for (const [name, [start, count]] of Object.entries(table)) {
    const Kind = INTEGERS.has(name) ? Uint32Array : Float32Array;
    found[name] = new Kind(block, start, count);
  }
  return found;
}

// Vectors and matrices as plain arrays: rotation rows times a vector, and so on.
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const turned = (rows, v) => rows.map((row) => dot(row, v));

// Unit quaternion (x, y, z, w) of a rotation's rows.
function quaternion([[a, b, c], [d, e, f], [g, h, i]]) {
  const q = [
    Math.sqrt(Math.max(0, 1 + a - e - i)) / 2 * (Math.sign(h - f) || 1),
    Math.sqrt(Math.max(0, 1 - a + e - i)) / 2 * (Math.sign(c - g) || 1),
    Math.sqrt(Math.max(0, 1 - a - e + i)) / 2 * (Math.sign(d - b) || 1),
    Math.sqrt(Math.max(0, 1 + a + e + i)) / 2,
  ];
  if (q[3] > 1e-9) return q;
  // half a turn: the axis is a column of R + 1
  const columns = [[a + 1, d, g], [b, e + 1, h], [c, f, i + 1]];
  const axis = columns.reduce((best, v) => (dot(v, v) > dot(best, best) ? v : best));
  return [...times(axis, 1 / Math.sqrt(dot(axis, axis))), 0];
}

// The least and largest corner of boxes, each turned and moved.
function boxOf(boxes) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const [corners, rows, origin] of boxes) {
    for (let n = 0; n < 8; n++) {
      const p = plus(turned(rows, [corners[n & 1][0], corners[(n >> 1) & 1][1], corners[n >> 2][2]]), origin);
      for (let k = 0; k < 3; k++) {
        low[k] = Math.min(low[k], p[k]);
        high[k] = Math.max(high[k], p[k]);
      }
    }
  }
  return [low, high];
}

// Colours of stiffness, soft to stiff, at equal steps of its logarithm: the scale viridis of matplotlib (CC0), turned round.
const STIFFNESS = [[253, 231, 37], [94, 201, 98], [33, 145, 140], [59, 82, 139], [72, 36, 117]];

function stiffnessColour(share) {
  const at = Math.round(50 * share) / 50 * (STIFFNESS.length - 1);  // in steps: a small change colours nothing anew
  const n = Math.min(Math.floor(at), STIFFNESS.length - 2);
  const mixed = STIFFNESS[n].map((v, k) => Math.round(v + (at - n) * (STIFFNESS[n + 1][k] - v)));
  return `#${mixed.map((v) => v.toString(16).padStart(2, '0')).join('')}`;
}

// Gives the parts of elements the colour of their stiffness; least and largest K, N/mm, null if none is known.
function colouredByStiffness(record, parts) {
  const known = Object.entries(record.array?.elements ?? {}).filter(([, e]) => e.estimate).map(([d, e]) => [d, e.estimate.stiffness]);
  if (!known.length) return null;
  const [low, high] = [Math.min(...known.map(([, k]) => k)), Math.max(...known.map(([, k]) => k))];
  const of = new Map(known);
  for (const {designator, part_no: number} of record.scenes.flatMap((s) => s.placed)) {
    const k = of.get(designator);
    if (k) Object.assign(parts.get(number), {senses: true, colour: stiffnessColour(high > low ? Math.log(k / low) / Math.log(high / low) : 0.5)});
  }
  return [low, high];
}

function stiffnessScale([low, high]) {
  const bar = el('div', {className: 'scale', 'aria-hidden': 'true'});
  bar.style.background = `linear-gradient(to right, ${STIFFNESS.map((c) => `rgb(${c.join(' ')})`).join(', ')})`;
  const ends = high > low ? [low, Math.sqrt(low * high), high] : [low];
  return [el('p', {}, 'Stiffness K, N/mm'), ...(high > low ? [bar] : []), el('div', {className: 'ends'}, ...ends.map((k) => el('span', {}, figures(k, 3))))];
}

// Numbers as the page shows them.
const mm = (value) => Number(value).toFixed(3);
const figures = (value, digits = 4) => (value === 0 ? '0' : Number(Number(value).toPrecision(digits)).toString());
const percent = (share, digits = 3) => `${figures(100 * share, digits)} %`;
