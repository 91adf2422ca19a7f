// Measuring between exact features: places are the descriptions', not the mesh's.
const PARALLEL = 1e-9;  // sine up to which directions count as parallel, as in the descriptions

// The distance or angle between two features, each {kind, point, direction, diameter} in the scene: a text.
function between(a, b) {
  const along = Math.abs(dot(a.direction, b.direction));
  const away = minus(b.point, a.point);
  const alike = a.kind === b.kind;
  if (alike && 1 - along > PARALLEL) return `at ${figures(Math.acos(Math.min(along, 1)) * 180 / Math.PI)}\u00b0 to each other`;
  if (!alike && along > PARALLEL) return `not parallel: ${figures(90 - Math.acos(Math.min(along, 1)) * 180 / Math.PI)}\u00b0`;
  const plane = [a, b].find((f) => f.kind === 'plane');
  if (plane) return `${mm(Math.abs(dot(plane.direction, away)))} mm`;
  const beside = dot(a.direction, away);
  return `${mm(Math.sqrt(Math.max(dot(away, away) - beside * beside, 0)))} mm`;
}

class Measure {
  constructor(parts, on) {
    Object.assign(this, {parts, on});
    this.ends = [null, null];  // each {designator, n}: the n-th feature of its part
  }

  show(scene) {
    this.placed = new Map(scene.placed.map((p) => [p.designator, p]));
    this.ends = [null, null];
  }

  features(designator) {
    const placed = this.placed.get(designator);
    return placed ? this.parts.get(placed.part_no).features : [];
  }

  // Offers a designator for the end that is still free, or for the second one.
  offer(designator) {
    if (!this.features(designator).length) return;
    const at = this.ends[0] === null || this.ends[0].designator === designator ? 0 : 1;
    if (this.ends[at]?.designator !== designator) this.ends[at] = {designator, n: 0};
  }

  page(selected) {
    if (selected) this.offer(selected);
    const part = this.placed.has(selected) ? this.parts.get(this.placed.get(selected).part_no) : null;
    const made = [el('h2', {}, 'Measure'), el('p', {className: 'hint'},
      'Between exact features of the descriptions, at the present places of the parts, not of the mesh.')];
    made.push(this.end(0, 'From'), this.end(1, 'To'), el('p', {id: 'measured', 'aria-live': 'polite'}, this.result()));
    if (part?.limits.length) {
      made.push(section(`Exact sizes of ${selected}, mm`, table(['', 'nominal'], part.limits.map((c) => [c.name, mm(c.nominal)]), ['', 'n'])));
    }
    return made;
  }

  end(at, label) {
    const end = this.ends[at];
    const withFeatures = [...this.placed.keys()].filter((d) => this.features(d).length);
    const parts = this.select(`${label}: part`, ['', ...withFeatures], end?.designator ?? '', (value) => {
      this.ends[at] = value ? {designator: value, n: 0} : null;
      this.on.changed();
    });
    const names = end ? this.features(end.designator).map((f, n) => [n, this.name(end.designator, f, n)]) : [];
    const features = this.select(`${label}: feature`, names, end?.n ?? '', (value) => {
      this.ends[at] = {designator: end.designator, n: Number(value)};
      this.on.changed();
      this.on.mark(end.designator, this.features(end.designator)[Number(value)].middle);
    });
    return el('div', {className: 'end'}, el('b', {}, label), parts, features);
  }

  // A feature's name; of several pieces of one name with their place.
  name(designator, feature, n) {
    const alike = this.features(designator).filter((f) => f.name === feature.name);
    const size = feature.diameter === null ? '' : ` \u2300${figures(feature.diameter, 6)}`;
    const at = alike.length > 1 ? ` at ${feature.middle.map((v) => figures(v, 4)).join(', ')}` : '';
    return `${words(feature.name)}${size}${at}`;
  }

  select(label, options, value, chosen) {
    const made = el('select', {'aria-label': label, disabled: options.length === 0});
    for (const option of options) {
      const [key, text] = Array.isArray(option) ? option : [option, option || 'choose a part'];
      made.append(el('option', {value: String(key), selected: String(key) === String(value)}, text));
    }
    made.addEventListener('change', () => chosen(made.value));
    return made;
  }

  inScene({designator, n}) {
    const placed = this.placed.get(designator);
    const f = this.features(designator)[n];
    return {...f, point: this.on.toScene(f.point, placed), direction: turned(placed.rotation, f.direction)};
  }

  result() {
    const [a, b] = this.ends;
    if (a && b) return between(this.inScene(a), this.inScene(b));
    const one = a ?? b;
    const feature = one && this.features(one.designator)[one.n];
    return feature?.diameter ? `diameter ${mm(feature.diameter)} mm` : 'Choose two features.';
  }
}
