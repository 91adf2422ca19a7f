// Sliders below the picture: the exploded view by the guide's steps, motions, and cuts.
class Controls {
  constructor(box, on) {
    Object.assign(this, {box, on});
  }

  show(scene, low, high) {
    this.scene = scene;
    this.exploded = 0;
    this.shares = scene.motions.map((m) => m.rest);
    this.pose = 0;
    const steps = scene.steps.length;
    const made = [];
    if (steps) made.push(this.explode(steps));
    const moves = [...(scene.poses.length ? [this.poses()] : []), ...scene.motions.map((m, n) => this.motion(m, n))];
    if (moves.length) made.push(el('fieldset', {}, el('legend', {}, 'Motions'), ...moves));
    made.push(el('fieldset', {}, el('legend', {}, 'Cut'), ...['x', 'y', 'z'].map((name, axis) => this.cut(name, axis, low[axis], high[axis]))));
    this.box.replaceChildren(...made);
  }

  slider(id, label, least, most, step, value, changed) {
    const said = el('output', {for: id});
    const input = el('input', {type: 'range', id, min: least, max: most, step, value});
    input.addEventListener('input', () => changed(Number(input.value), said));
    return [el('label', {for: id}, label), input, said];
  }

  // The last step's parts leave first, as in the guide read backwards.
  explode(steps) {
    const [label, input, said] = this.slider('explode', 'Apart', 0, steps, 0.02, 0, (value, output) => {
      this.exploded = value;
      this.told(output);
      this.on.moved(true);
    });
    this.told(said);
    return el('fieldset', {}, el('legend', {}, 'Assembly'), el('div', {className: 'slider'}, label, input, said));
  }

  told(output) {
    const steps = this.scene.steps;
    const n = Math.min(Math.max(Math.ceil(steps.length - this.exploded), 1), steps.length);
    const [title, text] = steps[n - 1];
    output.textContent = this.exploded === 0 ? 'together' : `step ${n} of ${steps.length}: ${title}`;
    output.title = text;
  }

  // The element under the force sensor; motions start at the first.
  poses() {
    const pick = el('select', {id: 'pose'}, ...this.scene.poses.map((pose, n) => el('option', {value: n}, pose.name)));
    pick.addEventListener('input', () => {
      this.pose = Number(pick.value);
      this.atRest();
      this.on.moved(false);
    });
    return el('div', {className: 'slider'}, el('label', {for: 'pose'}, 'under the sensor'), pick);
  }

  // Takes all motions back but that of a number.
  atRest(but = null) {
    this.shares = this.scene.motions.map((m, k) => (k === but ? this.shares[k] : m.rest));
    for (const [k, slider] of [...this.box.querySelectorAll('[id^=motion-]')].entries()) {
      if (k === but) continue;
      slider.value = this.scene.motions[k].rest ?? 0;
      slider.nextElementSibling.textContent = this.scene.motions[k].rest === null ? 'off' : 'at rest';
    }
  }

  motion(motion, n) {
    const rest = motion.rest;
    const [label, input, said] = this.slider(`motion-${n}`, motion.name, 0, 1, 0.01, rest ?? 0, (share, output) => {
      this.shares[n] = share;
      this.atRest(n);
      this.pose = 0;
      if (byId('pose')) byId('pose').value = 0;
      output.textContent = this.far(motion, share);
      this.on.moved(false);
    });
    said.textContent = rest === null ? 'off' : 'at rest';
    return el('div', {className: 'slider'}, label, input, said);
  }

  // Distance of the motion's groups from rest, of the farthest one.
  far(motion, share) {
    const offsets = motion.ways.map(([, from, to]) => plus(from, times(minus(to, from), share)));
    const names = offsets.map((v) => ['x', 'y', 'z'].filter((_, k) => Math.abs(v[k]) > 1e-9).map((axis) => `${axis} ${figures(v['xyz'.indexOf(axis)], 3)}`).join(' '));
    return [...new Set(names.filter(Boolean))].join('; ') + (names.some(Boolean) ? ' mm' : 'at rest');
  }

  cut(name, axis, low, high) {
    const margin = 0.01 * (high - low);
    const start = (low + high) / 2;
    const on = el('input', {type: 'checkbox', id: `cut-${name}-on`, 'aria-label': `Cut along ${name}`});
    const round = el('input', {type: 'checkbox', id: `cut-${name}-round`, 'aria-label': `Keep the other side of ${name}`});
    const [label, input, said] = this.slider(`cut-${name}`, name, low - margin, high + margin, (high - low) / 200, start, () => {
      on.checked = true;
      changed();
    });
    const changed = () => {
      said.textContent = on.checked ? `${figures(Number(input.value), 4)} mm` : 'off';
      this.on.cut(axis, on.checked ? Number(input.value) : null, round.checked);
    };
    said.textContent = 'off';
    on.addEventListener('change', changed);
    round.addEventListener('change', changed);
    return el('div', {className: 'slider'}, el('span', {}, on, label), input, el('span', {}, said, el('label', {className: 'round'}, round, ' turn')));
  }

  // Removes all cuts.
  uncut() {
    for (const on of this.box.querySelectorAll('[id^=cut-][id$=-on]:checked')) on.click();
  }

  // Every part's offset from its place: by the motion that is not at rest, and by the exploded view.
  offsets() {
    const found = new Map();
    const add = (designator, by) => found.set(designator, plus(found.get(designator) ?? [0, 0, 0], by));
    const steps = this.scene.steps.length;
    for (const p of this.scene.placed) {
      const share = Math.min(Math.max(this.exploded - (steps - 1 - p.step), 0), 1);
      if (share > 0) add(p.designator, times(p.way, share));
    }
    for (const [designators, by] of this.scene.poses[this.pose]?.ways ?? []) {
      for (const d of designators) add(d, by);
    }
    this.scene.motions.forEach((motion, n) => {
      if (this.shares[n] === null || this.shares[n] === motion.rest) return;
      for (const [designators, from, to] of motion.ways) {
        for (const d of designators) add(d, plus(from, times(minus(to, from), this.shares[n])));
      }
    });
    return found;
  }
}
