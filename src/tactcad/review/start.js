// Puts the page together.
const DIRECTIONS = [['iso', 'Corner'], ['under', 'Corner below'], ['front', 'Front'], ['rear', 'Back'], ['left', 'Left'], ['right', 'Right'], ['top', 'Above'], ['bottom', 'Below']];

// One column on a narrow screen and inside another page.
function columns() {
  const narrow = matchMedia('(max-width: 60rem)');
  const set = () => document.documentElement.classList.toggle('column', narrow.matches || self !== top);
  narrow.addEventListener('change', set);
  set();
}

async function start() {
  columns();
  const record = JSON.parse(new TextDecoder().decode(await unpacked('data')));
  const [parts, meshes, strains] = [new Map(), new Map(), new Map()];

  // Replaces the record and its block.
  function take(given, block) {
    Object.assign(record, given);
    titles(record);
    for (const known of [parts, meshes, strains]) known.clear();
    for (const part of given.parts) {
      parts.set(part.part_no, part);
      meshes.set(part.part_no, arrays(block, part.mesh));
    }
    const stiffness = colouredByStiffness(given, parts);
    byId('stiffness-scale').hidden = !stiffness;
    if (stiffness) byId('stiffness-scale').replaceChildren(...stiffnessScale(stiffness));
    for (const [number, s] of Object.entries(given.strains)) {
      strains.set(number, s.why_not ? s : {...s, ...arrays(block, {points: s.points, moved: s.moved, strain: s.strain, quads: s.quads})});
    }
  }
  take(record, await unpacked('block'));
  const library = await module(await unpacked('viewer'));
  const view = new View(library, byId('canvas'), meshes, parts);
  let scene = record.scenes[0];

  const select = (designator) => {
    if (view.strainOf !== designator) showStrain(null);
    view.select(designator);
    tree.select(designator);
    view.mark(null);
    panel.select(designator);
  };
  const tree = new Tree(byId('tree'), parts, {select, hide: (hidden) => view.hide(hidden), fit: () => view.fit()});
  const controls = new Controls(byId('controls'), {
    moved: (fit) => {
      view.place(controls.offsets());
      if (fit) view.fit();
      if (panel.tab === 'Measure') panel.open('Measure');
    },
    cut: (axis, at, round) => view.clip(axis, at, round),
  });
  const measure = new Measure(parts, {
    changed: () => panel.open('Measure'),
    mark: (designator, place) => view.mark(place, designator),
    toScene: (point, placed) => view.toScene(point, placed),
  });
  const panel = new (record.changes ? ChangePanel : Panel)(record, parts, {
    select,
    isolate: (designators) => tree.isolate(designators),
    zoom: (designator) => view.fit([designator], 0.6),
    measure: () => measure.page(panel.selected),
    strain: (number) => strains.get(number),
    strainBody: (placed) => ({
      shown: () => view.strainOf === placed.designator,
      show: (newton, full) => showStrain(newton === null ? null : placed, newton, full),
    }),
    finding: (finding) => showFinding(finding),
  });

  // The strain on a placed element's body, alone and close at first; null removes it.
  function showStrain(placed, newton, full) {
    const first = placed && view.strainOf !== placed.designator;
    const field = placed && strains.get(placed.part_no);
    view.strained(placed && placed.designator, placed && strainBody(field, meshes.get(placed.part_no), newton, full));
    byId('strain-scale').hidden = !placed;
    if (!first) return;
    byId('strain-scale').replaceChildren(el('p', {}, 'Strain along the arm, \u00b5\u03b5'), ...strainScale(full));
    tree.isolate([placed.designator]);
    view.select(null);
    view.closeUp(view.toScene([field.hinge_x, 0, 0], placed), placed.designator, 1 / 10);
  }

  function showFinding(finding) {
    const who = finding.designators.filter((d) => panel.placed.has(d));
    const one = who[0] ?? null;
    controls.uncut();
    if (who.length) tree.isolate(finding.scene ? [...panel.placed.keys()] : who);
    view.select(one);
    tree.select(one);
    if (one) view.fit(finding.scene ? [one] : who, 0.6);
    const place = finding.place.length ? [...finding.place, ...[0, 0, 0].slice(finding.place.length)] : null;
    if (place && one && !finding.scene && finding.place.length === 2) {
      // on the profile: on the face that is seen
      place[2] = view.nearer(parts.get(panel.placed.get(one).part_no).box.map((corner) => corner[2]), panel.placed.get(one));
    }
    view.mark(place, finding.scene ? null : one);
    if (place && one) view.closeUp(finding.scene ? place : view.toScene(place, panel.placed.get(one)), one);
    byId('status').textContent = `${finding.severity}: ${finding.about}: ${finding.message}`;
  }

  function showScene(name) {
    showStrain(null);
    scene = record.scenes.find((s) => s.name === name) ?? scene;
    view.show(scene);
    tree.show(scene);
    measure.show(scene);
    controls.show(scene, ...view.rest);
    panel.show(scene);
    byId('open-cover').hidden = scene.cover.length === 0;
    byId('open-cover').setAttribute('aria-pressed', 'false');
    for (const tab of byId('scenes').children) tab.setAttribute('aria-selected', String(tab.dataset.scene === scene.name));
    byId('status').textContent = `${scene.placed.length} ${record.changes ? 'pieces' : 'parts'}`;
  }

  head(record, showScene);
  for (const [direction, text] of DIRECTIONS) {
    const button = el('button', {type: 'button'}, text);
    button.addEventListener('click', () => view.lookFrom(direction));
    byId('views').append(button);
  }
  byId('show-all').addEventListener('click', () => {
    tree.hide([]);
    byId('open-cover').setAttribute('aria-pressed', 'false');
    view.mark(null);
    view.fit();
  });
  byId('open-cover').addEventListener('click', () => {
    const open = byId('open-cover').getAttribute('aria-pressed') !== 'true';
    byId('open-cover').setAttribute('aria-pressed', String(open));
    tree.hide(open ? scene.cover : []);
    view.fit();
  });
  view.onPick = (designator) => select(designator);
  view.onDraw = () => {
    const at = view.markedAt();
    byId('marker').hidden = at === null;
    if (at) byId('marker').style.transform = `translate(${at[0]}px, ${at[1]}px)`;
  };
  addEventListener('beforeprint', () => { byId('printed').src = view.picture(); });
  showScene(scene.name);
  document.documentElement.dataset.ready = 'true';
  return {record, parts, meshes, view, tree, controls, measure, panel, select, take, showScene};
}

function titles(record) {
  const d = record.design;
  byId('title').textContent = d.title;
  byId('subtitle').textContent = [`${d.name}, revision ${d.revision}`, d.date, d.organisation].filter(Boolean).join(' \u00b7 ');
  byId('made').textContent = `Made by tactcad ${record.tactcad} from ${d.name}, revision ${d.revision}. One file; nothing is fetched.`;
}

function head(record, showScene) {
  byId('show-about').addEventListener('click', () => byId('about').showModal());
  const names = record.scenes.map((s) => s.name);
  byId('scenes').hidden = names.length < 2;
  for (const name of names) {
    const tab = el('button', {type: 'button', role: 'tab'}, name);
    tab.dataset.scene = name;
    tab.addEventListener('click', () => showScene(name));
    byId('scenes').append(tab);
  }
}

const started = start();
started.catch((error) => {
  byId('status').textContent = `This page cannot be shown: ${error.message}`;
  document.documentElement.dataset.ready = 'failed';
  throw error;
});
