// The strain of a pressed element on its body: the field of the finite elements through the thickness, between
// load line and clamp edge, and the rest as the part is drawn, without strain. The part's
// frame: x along the arm, then across it, then through the thickness.

// For a field at a force, each node's place and colour: [x, z] and [r, g, b].
function strained(field, newton, full) {
  const {points, moved, strain} = field;
  const nodes = [...Array(strain.length).keys()];
  return {
    at: nodes.map((n) => [0, 1].map((k) => points[2 * n + k] + EXAGGERATED * newton * moved[2 * n + k])),
    colour: nodes.map((n) => linear(strainShade(full ? strain[n] * newton / full : 0))),
  };
}

// As the graphics card mixes colours, from sRGB of 0 to 255.
const linear = (shade) => shade.map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));

const on = (points, n, line) => Math.abs(points[2 * n] - line) < 1e-4;  // mm; lengths are single precision

// How the arm beyond the load line moves, with that section of it: a displacement and a small turn.
function rigid(field, end, newton) {
  const {points, moved} = field;
  const section = [...Array(points.length / 2).keys()].filter((n) => on(points, n, end));
  const mean = (f) => section.reduce((sum, n) => sum + f(n), 0) / section.length;
  const [z, u, w] = [mean((n) => points[2 * n + 1]), mean((n) => moved[2 * n]), mean((n) => moved[2 * n + 1])];
  const turn = -mean((n) => (moved[2 * n] - u) * (points[2 * n + 1] - z)) / mean((n) => (points[2 * n + 1] - z) ** 2);
  const by = EXAGGERATED * newton;
  return ([x, height, y]) => [x + by * (u - turn * (height - z)), height + by * (w + turn * (x - end)), y];
}

// The part of a polygon on one side of a place along an axis: its corners, in order.
function beyond(corners, axis, at, side) {
  const kept = [];
  corners.forEach((p, n) => {
    const q = corners[(n + 1) % corners.length];
    if (side * (p[axis] - at) >= 0) kept.push(p);
    if ((p[axis] - at) * (q[axis] - at) < 0) kept.push(plus(p, times(minus(q, p), (at - p[axis]) / (q[axis] - p[axis]))));
  });
  return kept;
}

// Positions and colours, three corners a triangle, seen from outside against the clock.
function strainBody(field, mesh, newton, full) {
  const {at, colour} = strained(field, newton, full);
  const [positions, colours] = [[], []];
  const add = (corners, shades) => {
    for (let n = 2; n < corners.length; n++) {
      for (const k of [0, n - 1, n]) {
        positions.push(...corners[k]);
        colours.push(...shades[k]);
      }
    }
  };
  const corner = (n) => [0, 1, 2].map((k) => mesh.vertices[3 * n + k]);
  let [front, back] = [Infinity, -Infinity];
  for (let n = 2; n < mesh.vertices.length; n += 3) [front, back] = [Math.min(front, mesh.vertices[n]), Math.max(back, mesh.vertices[n])];
  const place = (n, y) => [...at[n], y];
  const along = field.points.filter((_, n) => n % 2 === 0);
  const [tip, clamp] = [Math.min(...along), Math.max(...along)];

  const once = new Map();  // sides of one facet alone: the contour
  const {points, quads} = field;
  for (let q = 0; q < quads.length; q += 4) {
    const round = [...quads.subarray(q, q + 4)];
    const [[x0, z0], [x1, z1], [x2, z2], [x3, z3]] = round.map((n) => at[n]);
    if ((x2 - x0) * (z3 - z1) < (x3 - x1) * (z2 - z0)) round.reverse();  // its diagonals: it goes with the clock
    for (const [y, way] of [[front, [...round].reverse()], [back, round]]) add(way.map((n) => place(n, y)), way.map((n) => colour[n]));
    round.forEach((n, k) => {
      const m = round[(k + 1) % 4];
      const name = n < m ? `${n} ${m}` : `${m} ${n}`;
      if (!once.delete(name)) once.set(name, [n, m]);
    });
  }
  for (const [n, m] of once.values()) {
    if ([tip, clamp].some((line) => on(points, n, line) && on(points, m, line))) continue;  // the part goes on there
    add([place(n, front), place(m, front), place(m, back), place(n, back)], [n, m, m, n].map((k) => colour[k]));
  }

  const [pressed, none] = [rigid(field, tip, newton), linear(strainShade(0))];
  const low = Math.min(...points.filter((_, n) => n % 2 === 1));
  for (let t = 0; t < mesh.triangles.length; t += 3) {
    const corners = [0, 1, 2].map((k) => corner(mesh.triangles[t + k]));
    // the pad's half next to the load line protrudes from the arm
    const pad = beyond(beyond(beyond(corners, 0, tip, 1), 0, field.hinge_x, -1), 1, low, -1);
    const rests = [beyond(corners, 0, tip, -1).map(pressed), pad.map(pressed), beyond(corners, 0, clamp, 1)];
    for (const rest of rests) add(rest, rest.map(() => none));
  }
  return {positions: new Float32Array(positions), colours: new Float32Array(colours)};
}
