// The facts beside the picture: of the chosen part, of the array, the findings and the bill.
const words = (text) => text.replaceAll('_', ' ');

// A table: heads, then rows of texts or elements; numbers are aligned by the class of their column.
function table(heads, rows, classes = []) {
  const cells = (tag, row) => row.map((c, i) => el(tag, {className: classes[i] ?? ''}, c instanceof Node ? c : String(c ?? '')));
  return el('div', {className: 'wide'}, el('table', {},
    el('thead', {}, el('tr', {}, ...cells('th', heads))),
    el('tbody', {}, ...rows.map((row) => el('tr', {}, ...cells('td', row))))));
}

// Name and value in two columns; entries without value are left out.
function list(pairs) {
  const known = pairs.filter(([, value]) => value !== '' && value !== null && value !== undefined);
  return el('dl', {}, ...known.flatMap(([name, value]) => [el('dt', {}, name), el('dd', {}, value)]));
}

function section(title, ...children) {
  return el('details', {open: true}, el('summary', {}, title), ...children);
}

// Numbers of a sentence, but not those of names such as E4 or AW-7075.
const NUMBER = /(?<![\w.-])\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.]*[A-Za-z_])/g;

// Sentences that differ only in numbers, joined: each differing number becomes a range.
function together(sentences) {
  const all = sentences.map((s) => s.match(NUMBER) ?? []);
  let n = 0;
  return sentences[0].replace(NUMBER, () => {
    const here = all.map((numbers) => numbers[n]).sort((a, b) => a - b);
    n += 1;
    return here[0] === here.at(-1) ? here[0] : `${here[0]} to ${here.at(-1)}`;
  });
}

class Panel {
  constructor(record, parts, on) {
    Object.assign(this, {record, parts, on});
    this.tab = 'Part';
    this.selected = null;
    this.pages = {
      Part: () => this.part(), Findings: () => this.findings(), Array: () => this.array(), Bill: () => this.bill(),
      Measure: () => this.on.measure(),
    };
    byId('tabs').addEventListener('click', (e) => e.target.dataset.tab && this.open(e.target.dataset.tab));
    byId('tabs').addEventListener('keydown', (e) => this.key(e));
  }

  show(scene) {
    this.scene = scene;
    this.placed = new Map(scene.placed.map((p) => [p.designator, p]));
    this.selected = null;
    this.open(this.tab);
  }

  key(event) {
    const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
    if (!step) return;
    const names = Object.keys(this.pages);
    this.open(names[(names.indexOf(this.tab) + step + names.length) % names.length]);
    byId('tabs').querySelector('[aria-selected=true]').focus();
  }

  open(tab) {
    this.tab = tab;
    byId('tabs').replaceChildren(...Object.keys(this.pages).map((name) => {
      const count = name === 'Findings' ? ` ${this.here().length}` : '';
      const made = el('button', {type: 'button', role: 'tab', tabIndex: name === tab ? 0 : -1, 'aria-controls': 'panel'}, name + count);
      made.setAttribute('aria-selected', String(name === tab));
      made.dataset.tab = name;
      return made;
    }));
    byId('panel').setAttribute('aria-label', tab);
    byId('panel').replaceChildren(...this.pages[tab]());
    byId('panel').scrollTop = 0;
  }

  select(designator) {
    this.selected = designator;
    if (this.tab === 'Measure') this.open('Measure');
    else this.open('Part');
  }

  // Findings that belong to this scene: to one of its parts, or to no part at all.
  here() {
    return this.record.findings.filter((f) => (f.scene ? f.scene === this.scene.name
      : !f.designators.length || f.designators.some((d) => this.placed.has(d))));
  }

  part() {
    const placed = this.placed.get(this.selected);
    if (!placed) {
      return [el('p', {className: 'hint'}, 'Choose a part: click on it in the picture or in the tree.'), ...this.overview()];
    }
    const part = this.parts.get(placed.part_no);
    const row = this.scene.bill.find((r) => r.part_no === part.part_no);
    const found = this.here().filter((f) => f.designators.includes(placed.designator));
    const swatch = el('i', {className: 'swatch'});
    swatch.style.background = part.colour;
    return [
      el('h2', {id: 'chosen'}, swatch, placed.designator, ' ', el('small', {}, part.name)),
      list([
        ['Part number', el('span', {id: 'part-number'}, part.part_no)], ['Material', part.material], ['Made by', part.process],
        ['Mass', `${figures(part.mass_g)} g`], ['Volume', `${figures(part.volume_mm3)} mm\u00b3`], ['Finish', part.finish],
        ['Ordered as', part.designation], ['Belongs to', placed.under.join(', ')],
      ]),
      this.buttons(placed),
      ...this.element(placed, part),
      ...(found.length ? [section(`Findings (${found.length})`, this.findingList(found))] : []),
      ...this.limits(part),
      ...this.shares(part),
      ...(row ? [section('Bill', this.billRow(row))] : []),
      ...(part.notes.length ? [section('Notes', el('ul', {}, ...part.notes.map((note) => el('li', {}, note))))] : []),
      ...this.sheet(part),
    ];
  }

  overview() {
    const d = this.record.design;
    const fit = this.record.array.fit;
    return [section('This design', list([
      ['Design', d.name], ['Revision', d.revision], ['Date', d.date], ['Author', d.author], ['Organisation', d.organisation], ['Overall size', d.size],
      ['Scenes', this.record.scenes.map((s) => s.name).join(', ')], ['Parts in this scene', `${this.scene.placed.length}`],
      ['Different parts', `${new Set(this.scene.placed.map((p) => p.part_no)).size}`],
      ['Findings', this.record.live ? 'not looked for while live' : `${this.record.findings.filter((f) => f.severity === 'fail').length} failed, `
        + `${this.record.findings.filter((f) => f.severity !== 'fail').length} flagged`],
      ['Arrays that go together', Object.entries(fit.kept).map(([name, share]) => `${percent(share)} (${name})`).join(', ')],
    ]))];
  }

  buttons(placed) {
    const made = (text, act) => {
      const button = el('button', {type: 'button'}, text);
      button.addEventListener('click', act);
      return button;
    };
    return el('div', {className: 'bar'},
      made('Zoom to it', () => this.on.zoom(placed.designator)),
      made('Show alone', () => this.on.isolate([placed.designator])),
      made('Measure', () => this.open('Measure')));
  }

  element(placed, part) {
    const facts = this.record.array.elements[placed.designator];
    if (!facts) return [];
    const e = facts.estimate;
    const b = facts.built;
    const micro = (perNewton, at) => (perNewton === null ? 'not estimated'
      : `${figures(1e6 * perNewton * at.rated_force)} \u00b5\u03b5 at the rated force`);
    const within = (share) => (share === null ? '' : `, within ${percent(share)}`);
    const pairs = this.record.array.pairs.filter((p) => p.measuring === placed.designator || p.reference === placed.designator);
    const made = [];
    if (e) {
      made.push(section('Estimate', list([
        ['Stiffness K', `${figures(e.stiffness)} N/mm${within(e.expected_error)}`],
        ['Rated force', `${figures(e.rated_force, 3)} N`], ['Rated deflection', `${figures(1e3 * e.rated_deflection, 3)} \u00b5m at most`],
        ['Strain under the gauge', micro(facts.gauge_per_newton, e) + within(e.gauge_strain_error)],
        ['Strain at the fillet', micro(facts.fillet_per_newton, e) + within(e.peak_strain_error)],
        ['Yields at', `${figures(e.yield_force, 3)} N, ${figures(1e3 * e.yield_deflection, 3)} \u00b5m`],
        ['Goodman factor', e.goodman_factor === null ? '' : figures(e.goodman_factor, 3)], ['Arm, load arm', `${figures(e.arm)}, ${figures(e.load_arm)} mm`],
        ['By', `closed form, rung ${this.record.array.rung}; against refined solid elements`],
      ])));
    } else {
      made.push(section('Estimate', el('p', {}, this.record.array.why_not)));
    }
    if (b) {
      const fit = this.record.array.fit;
      made.push(section('Fit, as built', list([
        ['Arrays that go together', percent(Math.min(fit.kept.normal, fit.kept.uniform))],
        ['K as built', b.stiffness.includes(null) ? 'not estimated'
          : `${figures(b.stiffness[0])} \u00b1 ${figures(b.stiffness[1], 2)} N/mm (one standard deviation)`],
        ['Load arm', `${mm(b.load_arm[0])} \u00b1 ${mm(b.load_arm[1])} mm`], ['Stop gap', `${mm(b.stop_gap[0])} \u00b1 ${mm(b.stop_gap[1])} mm`],
        ['Stop closes at least at', b.stop_closes_at_least === null ? 'not estimated' : `${figures(b.stop_closes_at_least, 3)} N`],
      ]), el('p', {className: 'hint'}, `${fit.count} arrays built virtually, normal parts, seed ${fit.seed}.`)));
    }
    if (pairs.length) made.push(section('Pairs', this.pairTable(pairs)));
    made.push(section('Strain when pressed', strainPicture(this.on.strain(part.part_no), e, this.on.strainBody(placed))));
    return made;
  }

  pairTable(pairs) {
    const chosen = (d) => {
      const button = el('button', {type: 'button', className: 'link'}, d);
      button.addEventListener('click', () => this.on.select(d));
      return button;
    };
    return table(['measures', 'with', 'K_m', 'K_r', 'K_r/K_m', 'best for', 'error x'],
      pairs.map((p) => [chosen(p.measuring), chosen(p.reference), figures(p.K_m), figures(p.K_r), figures(p.ratio, 3), figures(p.best_for, 3), figures(p.condition, 3)]),
      ['', '', 'n', 'n', 'n', 'n', 'n']);
  }

  limits(part) {
    const made = [];
    if (part.limits.length) {
      made.push(section('Limits, mm', table(['', 'nominal', 'from', 'to', 'between'],
        part.limits.map((c) => [c.key ? el('b', {}, c.name) : c.name, mm(c.nominal), mm(c.lower), mm(c.upper), c.between.map(words).join(', ')]),
        ['', 'n', 'n', 'n', 'small']), el('p', {className: 'hint'}, 'Bold: key characteristics.')));
    }
    if (part.geometric.length) {
      made.push(section('Geometric tolerances, mm', table(['', 'kind', 'zone', 'of', 'datums'],
        part.geometric.map((g) => [g.name, g.symbol, `${g.round ? '\u2300' : ''}${figures(g.zone)}`, g.features.map(words).join(', '), g.datums.join(' ')]),
        ['', '', 'n', 'small', ''])));
    }
    if (part.datums.length) {
      made.push(section('Datums', table(['', 'feature'], part.datums.map(([letter, feature]) => [letter, words(feature)]))));
    }
    return made;
  }

  shares(part) {
    if (!part.shares.length) return [];
    return [section('What the sensor needs of it', table(['requirement', 'share', 'kept', 'by'],
      part.shares.map((s) => [s.requirement, percent(s.share, 2), percent(s.kept), s.limits.map(([name]) => name).join(', ')]), ['', 'n', 'n', 'small']),
    el('p', {className: 'hint'}, 'Share: of the requirement\u2019s variance. Kept: arrays that meet it, normal parts.'))];
  }

  sheet(part) {
    const sheet = this.record.sheets[part.part_no];
    if (!sheet) return [];
    const picture = el('img', {className: 'sheet', alt: `Drawing sheet of ${part.part_no}`, src: pictureOf(sheet)});
    picture.addEventListener('click', () => picture.classList.toggle('large'));
    return [section('Sheet', picture)];
  }

  findings() {
    const found = this.here();
    const others = this.record.findings.length - found.length;
    return [
      el('h2', {}, found.length ? `${found.length} findings` : 'No findings'),
      el('p', {className: 'hint'}, `Every check ran on ${this.record.scenes.length === 1 ? 'this scene' : 'these scenes'}; a flag is for whoever quotes or reviews.`
        + (others ? ` ${others} more in other scenes.` : '')),
      this.findingList(found),
    ];
  }

  // Findings that differ in their numbers alone are one sentence, with a button for each.
  findingList(found) {
    const groups = new Map();
    for (const f of found) {
      const key = [f.severity, f.check, f.scene, f.message.replace(NUMBER, '#')].join('\u0000');
      groups.set(key, [...(groups.get(key) ?? []), f]);
    }
    return el('ul', {className: 'findings'}, ...[...groups.values()].map((group) => {
      const {severity, check} = group[0];
      return el('li', {className: `finding ${severity === 'fail' ? 'fail' : 'flag'}`},
        el('b', {}, group.length > 1 ? `${group.length} ${severity}s` : severity), el('small', {}, words(check).replaceAll('-', ' ')),
        el('p', {}, together(group.map((f) => f.message))),
        el('div', {}, ...group.flatMap((f) => [this.findingLink(f), ' '])));
    }));
  }

  findingLink(f) {
    const button = el('button', {type: 'button', className: 'link', title: `${f.about}: ${f.message}`}, f.designators.slice(0, 6).join(' ') || f.about);
    button.addEventListener('click', () => this.on.finding(f));
    return button;
  }

  array() {
    const {elements, pairs, fit, why_not: whyNot} = this.record.array;
    const rows = Object.entries(elements).filter(([, e]) => e.estimate);
    const missed = Object.entries(fit.failures).flatMap(([name, failed]) => Object.entries(failed).map(([r, n]) => [name, r, n]));
    return [
      el('h2', {}, 'The array'),
      ...(whyNot ? [el('p', {}, whyNot)] : [section('Elements', table(['element', 'arm, mm', 'K, N/mm', 'rated force, N', 'gauge strain, \u00b5\u03b5', 'yield force, N'],
        rows.map(([d, {estimate: e, gauge_per_newton: g}]) => [this.link(d), figures(e.arm),
          e.expected_error === null ? figures(e.stiffness) : el('span', {}, figures(e.stiffness), el('small', {}, `\u00b1${percent(e.expected_error)}`)),
          figures(e.rated_force, 3), g === null ? '' : figures(1e6 * g * e.rated_force), figures(e.yield_force, 3)]),
        ['', 'n', 'n', 'n', 'n', 'n'])),
      section('Pair by pair', pairs.length ? this.pairTable(pairs) : el('p', {}, 'All elements are equally stiff: no pair tells an object.'),
        el('p', {className: 'hint'}, 'An element measures with the stiffest one. Best for: the object, N/mm, that the pair finds best; '
          + 'error x: its relative error there over that of the ratio of deflections. Gauge: strain at the rated force.'))]),
      ...(fit.count ? [section('Fit', list(Object.entries(fit.kept).map(([name, share]) => [`${name} parts`, `${percent(share)} of ${fit.count} arrays go together`])),
        ...(missed.length ? [table(['parts', 'missed', 'arrays'], missed, ['', '', 'n'])] : []))] : []),
    ];
  }

  link(designator) {
    if (!this.placed.has(designator)) return designator;
    const button = el('button', {type: 'button', className: 'link'}, designator);
    button.addEventListener('click', () => this.on.select(designator));
    return button;
  }

  bill() {
    const part = (r) => el('span', {}, r.description, el('small', {}, r.part_no), el('small', {}, [r.make_buy, r.material].filter(Boolean).join(', ')));
    const rows = this.scene.bill.map((r) => [r.item, `${r.qty} ${r.unit}`, part(r), this.designators(r)]);
    return [el('h2', {}, `Bill of ${this.scene.name}`), table(['item', 'quantity', 'part', 'designators'], rows, ['n', 'n', 'part', 'small'])];
  }

  designators(row) {
    return el('span', {}, ...row.designators.split(' ').filter(Boolean).flatMap((d) => [this.link(d), ' ']));
  }

  billRow(row) {
    return list([
      ['Item', `${row.item}`], ['Quantity', `${row.qty} ${row.unit}${row.spares ? `, ${row.spares} spare` : ''}`], ['Description', row.description],
      ['Make or buy', row.make_buy], ['Process', row.process], ['Finish', row.finish], ['Designation', row.standard_designation],
      ['Maker', [row.manufacturer, row.mpn].filter(Boolean).join(' ')], ['Supplier', row.supplier], ['Alternates', row.alternates],
      ['Designators', row.designators],
    ]);
  }
}

const pictures = new Map();
function pictureOf(svg) {
  if (!pictures.has(svg)) pictures.set(svg, URL.createObjectURL(new Blob([svg], {type: 'image/svg+xml'})));
  return pictures.get(svg);
}
