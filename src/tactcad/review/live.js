// Follows the design while it is edited: asks for changes, and shows them in the reader's present view.
const SLIDERS = '#controls input, #controls select';

function liveBar(live) {
  const shown = (value, digits) => (value === null ? '\u2013' : typeof value === 'number' ? figures(value, digits) : String(value));
  // Enough digits to show the difference: a thicker hinge is a ten-thousandth of the array's mass.
  const digits = ({before: a, after: b}) => [4, 6, 8, 10, 12].find((n) => shown(a, n) !== shown(b, n)) ?? 17;
  const moved = (a, b) => (typeof a === 'number' && typeof b === 'number' && a !== 0 ? percent((b - a) / Math.abs(a), 2) : '');
  const rows = live.changes.map((c) => [c.about, c.what, shown(c.before, digits(c)), '\u2192', shown(c.after, digits(c)), moved(c.before, c.after)]);
  const first = rows.length ? `${rows.length} changes: ${rows.map((row) => row.slice(0, 5).join(' ').trim()).join('; ')}` : 'No change yet.';
  byId('live').className = live.message ? 'broken' : '';
  byId('live-said').textContent = live.message ? `${live.message}. Shown is the last good model.`
    : `Live: ${live.file}, ${figures(live.seconds, 2)} s. Without checks, virtual builds and strain: tactcad review.`;
  byId('live-first').textContent = first;
  byId('live-all').replaceChildren(...(rows.length ? [table(['', '', 'before', '', 'after', ''], rows, ['small', '', 'n', '', 'n', 'n'])] : []));
}

const same = (a, b) => a.length === b.length && a.every((value, n) => value === b[n]);
const sameMesh = (a, b) => Object.keys(b).every((name) => same(a[name], b[name]));

// Whether a scene has another's parts, each turned, named and coloured as before: then no part comes or goes.
function alike(a, b, before, after) {
  const look = (scene, parts) => JSON.stringify([scene.name, scene.steps.map(([title]) => title), scene.motions, scene.cover, scene.placed.map((p) => [
    p.designator, p.part_no, p.rotation, p.step, p.under, parts.get(p.part_no).name, parts.get(p.part_no).colour])]);
  return look(a, before) === look(b, after);
}

// Puts other meshes and places in the present picture: eye, cuts and hidden parts stay.
function renewed({view, controls, panel, measure, meshes}, scene, before) {
  const changed = new Set(scene.placed.map((p) => p.part_no).filter((no) => !sameMesh(before.get(no), meshes.get(no))));
  const shapes = view.shapes(scene).parts;
  view.together(() => {
    scene.placed.forEach((p, n) => {
      if (changed.has(p.part_no)) view.viewer.updatePart(`/s/${n}`, shapes[n], {skipBounds: true});
    });
    if (changed.size) view.viewer.updateBounds();
    view.thinLines();
  });
  view.byPath = new Map(scene.placed.map((p, n) => [`/s/${n}`, p]));
  for (const one of [view, controls, panel]) one.scene = scene;
  panel.placed = measure.placed = new Map(scene.placed.map((p) => [p.designator, p]));
  view.place(controls.offsets());
  view.hide(view.hidden);
  view.select(panel.selected);
}

// Draws a scene with other parts in the reader's view: eye, sliders, hidden and chosen parts stay.
function redrawn(page, scene) {
  const {view, tree, panel} = page;
  const v = view.viewer;
  const eye = [v.getCameraPosition(), v.getCameraQuaternion(), v.getCameraTarget(), v.getCameraZoom()];
  const sliders = [...document.querySelectorAll(SLIDERS)].map((i) => [i.id, i.value, i.checked]);
  const [hidden, chosen, tab] = [[...tree.hidden], panel.selected, panel.tab];
  const open = byId('open-cover').getAttribute('aria-pressed');
  page.showScene(scene.name);
  const rest = new Map([...document.querySelectorAll(SLIDERS)].map((i) => [i.id, i.value]));
  for (const [id, value, checked] of sliders) {
    const input = byId(id);
    if (['range', 'select-one'].includes(input?.type) && !id.startsWith('cut-') && value !== rest.get(id)) {
      input.value = value;
      if (input.value === '') continue;  // the element is gone
      input.dispatchEvent(new Event('input'));
    }
    if (input?.type === 'checkbox' && checked) {
      const slider = sliders.find(([other]) => id === `${other}-on`);
      if (slider) byId(slider[0]).value = slider[1];
      input.checked = true;
      input.dispatchEvent(new Event('change'));
    }
  }
  tree.hide(hidden.filter((d) => tree.items.has(d)));
  byId('open-cover').setAttribute('aria-pressed', open);
  if (tree.items.has(chosen)) page.select(chosen);
  panel.tab = tab;
  view.together(() => {
    v.setCameraTarget(eye[2], false);
    v.setCameraPosition(eye[0], false, false);
    v.setCameraQuaternion(eye[1], false);
    v.setCameraZoom(eye[3], false);
  });
}

function taken(page, record, block) {
  const before = {scene: page.panel.scene, parts: new Map(page.parts), meshes: new Map(page.meshes)};
  const scrolled = byId('panel').scrollTop;
  page.take(record, block);
  const scene = record.scenes[0];
  if (alike(before.scene, scene, before.parts, page.parts)) renewed(page, scene, before.meshes);
  else redrawn(page, scene);
  page.panel.open(page.panel.tab);
  byId('panel').scrollTop = scrolled;
}

async function follow(page) {
  let live = page.record.live;
  delete page.panel.pages.Findings;  // nothing is checked
  page.panel.open(page.panel.tab);
  document.querySelector('header').after(el('section', {id: 'live', 'aria-label': 'Changes of the design file'},
    el('p', {id: 'live-said', role: 'status'}), el('details', {}, el('summary', {id: 'live-first'}), el('div', {id: 'live-all'}))));
  liveBar(live);
  for (;;) {
    let answer;
    try {
      const got = await fetch(`events?version=${live.version}&model=${live.model}`);
      if (!got.ok) throw new Error(`${got.status}`);
      answer = await got.arrayBuffer();
    } catch {
      liveBar({...live, message: 'tactcad view has ended'});
      return;
    }
    const end = new Uint8Array(answer).indexOf(10);
    const news = JSON.parse(new TextDecoder().decode(answer.slice(0, end)));
    if (news.live.version === live.version) continue;
    live = news.live;
    if (news.record) taken(page, news.record, answer.slice(end + 1));
    liveBar(live);
    document.documentElement.dataset.version = live.version;
  }
}

started.then(follow);
