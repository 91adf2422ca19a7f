// The strain of a pressed element as colours, on the mesh of the finite elements, with its scale.
const EXAGGERATED = 5;  // deflections in the picture: at the rated force a tip gives way by a tenth of a millimetre

// From blue (pressed) over grey to red (stretched): both ends differ in lightness too little for one to hide.
function strainShade(share) {
  const [low, middle, high] = [[33, 102, 172], [232, 232, 228], [178, 24, 43]];
  const end = share < 0 ? low : high;
  const s = Math.min(Math.abs(share), 1) ** 0.8;
  return middle.map((m, k) => Math.round(m + (end[k] - m) * s));
}

const strainColour = (share) => `rgb(${strainShade(share).join(' ')})`;

// `body` also shows it in three dimensions: `shown()`, and `show(newton, full)` or `show(null)`.
function strainPicture(field, estimate, body) {
  if (!field) return el('p', {}, 'No finite elements of this part.');
  if (field.why_not) return el('p', {}, field.why_not);
  const rated = estimate?.rated_force ?? 1;
  const canvas = el('canvas', {className: 'strain', width: 720, height: 360, role: 'img'});
  const caption = el('p', {className: 'hint'});
  const force = el('input', {type: 'range', min: 0, max: rated, step: rated / 50, value: rated, 'aria-label': 'Force on the pad, N'});
  const hinge = el('input', {type: 'checkbox', checked: true});
  const solid = el('input', {type: 'checkbox', id: 'strain-body', checked: body.shown()});
  const most = field.strain.reduce((m, v) => Math.max(m, Math.abs(v)), 0);
  const draw = () => {
    const newton = Number(force.value);
    drawStrain(canvas, field, newton, most * rated, hinge.checked);
    const peak = figures(1e6 * most * newton, 3);
    if (solid.checked) body.show(newton, most * rated);
    canvas.setAttribute('aria-label', `Strain along the arm at ${figures(newton, 3)} N: at most ${peak} microstrain`);
    caption.textContent = `${figures(newton, 3)} N on the pad, at most ${peak} \u00b5\u03b5 along the arm. Plane-stress finite elements on the part\u2019s contour, `
      + `held at the clamp edge, pressed at the load line, load arm ${figures(field.load_arm)} mm; ${field.quads.length / 4} facets; deflection drawn ${EXAGGERATED} times.`;
  };
  force.addEventListener('input', draw);
  hinge.addEventListener('change', draw);
  solid.addEventListener('change', () => (solid.checked ? draw() : body.show(null)));
  draw();
  return el('div', {}, canvas, ...strainScale(most * rated), el('label', {}, 'Force ', force), el('label', {}, hinge, ' the hinge alone'),
    el('label', {}, solid, ' on the body'), caption);
}

// The colours from the largest strain pressed to the largest stretched, with figures below.
function strainScale(full) {
  const scale = el('canvas', {className: 'scale', width: 360, height: 14, 'aria-hidden': 'true'});
  drawScale(scale);
  return [scale, el('div', {className: 'ends'}, ...[-1, -0.5, 0, 0.5, 1].map((s) => el('span', {}, figures(1e6 * full * s, 3))))];
}

function drawScale(canvas) {
  const pen = canvas.getContext('2d');
  for (let x = 0; x < canvas.width; x++) {
    pen.fillStyle = strainColour(2 * x / (canvas.width - 1) - 1);
    pen.fillRect(x, 0, 1, canvas.height);
  }
}

function drawStrain(canvas, field, newton, full, hingeAlone) {
  const {points, moved, strain, quads} = field;
  const at = (n) => [0, 1].map((k) => points[2 * n + k] + EXAGGERATED * newton * moved[2 * n + k]);
  const near = (n) => !hingeAlone || Math.hypot(points[2 * n] - field.hinge_x, points[2 * n + 1]) < 4 * field.hinge;
  const shown = [];
  for (let q = 0; q < quads.length; q += 4) shown.push([...quads.subarray(q, q + 4)]);
  // the window is laid around these; the canvas cuts off the rest
  const all = [...Array(strain.length).keys()].filter(near).map(at);
  const [x0, x1] = [Math.min(...all.map((p) => p[0])), Math.max(...all.map((p) => p[0]))];
  const [z0, z1] = [Math.min(...all.map((p) => p[1])), Math.max(...all.map((p) => p[1]))];
  const size = 0.9 * Math.min(canvas.width / (x1 - x0), canvas.height / (z1 - z0));
  const px = ([x, z]) => [canvas.width / 2 + size * (x - (x0 + x1) / 2), canvas.height / 2 - size * (z - (z0 + z1) / 2)];
  const pen = canvas.getContext('2d');
  pen.clearRect(0, 0, canvas.width, canvas.height);
  for (const corners of shown) {
    const mean = corners.reduce((sum, n) => sum + strain[n], 0) / 4 * newton;
    pen.fillStyle = pen.strokeStyle = strainColour(full ? mean / full : 0);
    pen.beginPath();
    for (const n of corners) pen.lineTo(...px(at(n)));
    pen.closePath();
    pen.fill();
    pen.stroke();
  }
}
