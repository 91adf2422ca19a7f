// The three-dimensional view: the viewer's scene, with parts placed, shown, picked and cut by this page.
class View {
  constructor(library, container, meshes, parts) {
    Object.assign(this, {library, container, meshes, parts});
    this.dark = matchMedia('(prefers-color-scheme: dark)');
    this.hidden = new Set();
    this.offsets = new Map();
    this.strainOf = null;
    this.clips = [null, null, null];
    this.viewer = null;
    this.onPick = () => {};
    this.onDraw = () => {};
    this.dark.addEventListener('change', () => this.display?.setTheme(this.theme));
    new ResizeObserver(() => this.fitted()).observe(container);
    this.listen();
  }

  get theme() {
    return this.dark.matches ? 'dark' : 'light';
  }

  get size() {
    return [Math.max(this.container.clientWidth, 50), Math.max(this.container.clientHeight, 50)];
  }

  // Draws a scene at rest. The viewer gets numbers for names: texts of a design never reach it.
  show(scene) {
    this.scene = scene;
    this.paths = new Map(scene.placed.map((p, n) => [p.designator, `/s/${n}`]));
    this.byPath = new Map(scene.placed.map((p, n) => [`/s/${n}`, p]));
    this.hidden.clear();
    this.offsets.clear();
    this.clips = [null, null, null];
    this.selected = null;
    this.marked = null;
    const [width, height] = this.size;
    const options = {
      cadWidth: width, height, treeWidth: 0, theme: this.theme, glass: true, tools: false, pinning: false,
      measureTools: false, selectTool: false, explodeTool: false, zebraTool: false, studioTool: false, keymap: KEYS,
    };
    if (this.viewer === null) {
      this.library.logger.setLevel('error');
      this.display = new this.library.Display(this.container, options);
      this.viewer = new this.library.Viewer(this.display, {...options, up: 'Z', control: 'orbit'}, () => {});
      this.viewer.onAfterRender = () => this.onDraw();
    } else {
      this.viewer.clear();
    }
    this.rest = this.box(scene.placed.map((p) => p.designator));
    this.viewer.render(this.shapes(scene), RENDERED, {
      up: 'Z', control: 'orbit', ortho: true, axes: false, collapse: 1, clipObjectColors: true,
    });
    this.viewer.setPickHandler(false);  // clicks are this page's
    this.lightFromEye();
    this.thinLines();
    for (const p of scene.placed) this.setBehind(this.group(p.designator), this.parts.get(p.part_no).behind ?? 0);
    this.lookFrom(this.padsBelow() ? 'under' : 'iso');
  }

  // Whether the elements' pads point down and nothing lies below them: then the scene opens on that side.
  padsBelow() {
    const elements = this.scene.placed.filter((p) => this.parts.get(p.part_no).senses);
    if (!elements.length || turned(elements[0].rotation, [0, -1, 0])[2] > -0.9) return false;
    return this.box(elements.map((p) => p.designator))[0][2] < this.rest[0][2] + 0.01;
  }

  // The viewer moves its light to the eye after each picture; it is to be there before.
  lightFromEye() {
    const {scene, directLight} = this.viewer.rendered;
    scene.onBeforeRender = (renderer, drawn, camera) => {
      directLight.position.copy(camera.position);
      directLight.updateMatrixWorld();
    };
  }

  // Of each piece of an edge the line alone is drawn, two triangles of six: thin lines' ends show nothing, and
  // of a long array edges are most of what is drawn.
  thinLines() {
    this.viewer.rendered.nestedGroup.rootGroup.traverse((one) => one.isLineSegments2 && one.geometry.setDrawRange(6, 6));
  }

  // Of faces in one place the one that is less far behind (steps of the depth buffer) is seen.
  setBehind(group, steps) {
    group.traverse(({material}) => {
      if (material?.polygonOffset) material.polygonOffsetUnits += steps;
    });
  }

  shapes(scene) {
    const [low, high] = this.rest;
    const shared = {version: 3, loc: [[0, 0, 0], [0, 0, 0, 1]], normal_len: 0};
    const parts = scene.placed.map((p, n) => ({
      ...shared, id: `/s/${n}`, name: `${n}`, type: 'shapes', subtype: 'solid', state: [1, 1], alpha: this.parts.get(p.part_no).alpha ?? 1,
      color: this.parts.get(p.part_no).colour, renderback: false, texture: null, accuracy: null, bb: null,
      loc: [p.origin, quaternion(p.rotation)], shape: this.meshes.get(p.part_no),
    }));
    const bb = {xmin: low[0], xmax: high[0], ymin: low[1], ymax: high[1], zmin: low[2], zmax: high[2]};
    return {...shared, id: '/s', name: 's', bb, parts};
  }

  group(designator) {
    return this.viewer.rendered.nestedGroup.groups[this.paths.get(designator)];
  }

  // A designator's present place.
  origin(placed) {
    const by = this.offsets.get(placed.designator);
    return by ? plus(placed.origin, by) : placed.origin;
  }

  // The box of designators at their present places, mm.
  box(designators) {
    const wanted = new Set(designators);
    return boxOf(this.scene.placed.filter((p) => wanted.has(p.designator))
      .map((p) => [this.parts.get(p.part_no).box, p.rotation, this.origin(p)]));
  }

  // Moves parts by offsets from their places (mm): a map by designator; all others are at rest.
  place(offsets) {
    this.offsets = offsets;
    for (const p of this.scene.placed) this.group(p.designator).position.set(...this.origin(p));
    this.viewer.idPicker?.setDirty();
    if (this.clips.some((c) => c !== null)) this.clipped();
    else this.draw();
  }

  // Shows all but these designators.
  hide(hidden) {
    this.hidden = new Set(hidden);
    if (this.strainOf) this.strain.visible = !this.hidden.has(this.strainOf);
    for (const p of this.scene.placed) {
      const state = this.hidden.has(p.designator) ? 0 : 1;
      for (const icon of [0, 1]) this.viewer.setObject(this.paths.get(p.designator), state, icon, false, false);
    }
    this.draw();
  }

  // Draws a designator as triangles of their own colours in the place of its faces; null: as it is.
  strained(designator, body = null) {
    if (this.strainOf) {
      const group = this.group(this.strainOf);
      group.remove(this.strain);
      this.strain.geometry.dispose();
      this.strain.material.dispose();
      group.front.visible = group.back.visible = true;
    }
    this.strainOf = designator;
    if (designator) {
      const {front, back} = this.group(designator);
      const {geometry} = front;
      const [Geometry, Attribute] = [Object.getPrototypeOf(geometry).constructor, geometry.getAttribute('position').constructor];
      this.strain = back.clone();
      this.strain.geometry = new Geometry();
      this.strain.geometry.setAttribute('position', new Attribute(body.positions, 3));
      this.strain.geometry.setAttribute('color', new Attribute(body.colours, 3));
      this.strain.material = back.material.clone();
      Object.assign(this.strain.material, {
        visible: true, vertexColors: true, side: 2, opacity: 1, transparent: false, clippingPlanes: back.material.clippingPlanes,
      });
      this.strain.material.color.set(0xffffff);
      this.strain.layers.set(0);
      front.visible = back.visible = false;
      this.group(designator).add(this.strain);
    }
    if (this.viewer) this.draw();
  }

  select(designator) {
    const highlight = this.viewer.rendered.nestedGroup.highlight;
    if (this.selected) highlight?.selectSolid(this.paths.get(this.selected), false);
    this.selected = designator;
    if (designator) highlight?.selectSolid(this.paths.get(designator), true);
    this.draw();
  }

  // A place in a designator's own frame, or in the scene's, that the page's marker shows; null for none.
  mark(place, designator = null) {
    this.marked = place && {place, designator};
    this.draw();
  }

  // The marked place on the canvas in pixels, null if it is not seen.
  markedAt() {
    if (!this.marked) return null;
    const {place, designator} = this.marked;
    const at = designator ? this.toScene(place, this.byPath.get(this.paths.get(designator))) : place;
    const p = this.viewer.vector3(...at).project(this.viewer.camera.getCamera());
    const [width, height] = this.size;
    if (Math.abs(p.x) > 1 || Math.abs(p.y) > 1) return null;
    return [(p.x + 1) / 2 * width, (1 - p.y) / 2 * height];
  }

  // Of heights along a part's own z the one that is nearer to the eye.
  nearer(heights, placed) {
    const e = this.viewer.camera.getCamera().matrixWorld.elements;
    const depth = (z) => dot(turned(placed.rotation, [0, 0, z]), [e[8], e[9], e[10]]);
    return heights.reduce((best, z) => (depth(z) > depth(best) ? z : best));
  }

  toScene(point, placed) {
    return plus(turned(placed.rotation, point), this.origin(placed));
  }

  lookFrom(direction) {
    this.together(() => {
      this.viewer.presetCamera(direction === 'under' ? 'iso' : direction, 1);
      if (direction === 'under') this.mirrorEye();
    });
    this.fit();
  }

  // From below, at the same distance.
  mirrorEye() {
    const v = this.viewer;
    const target = v.getCameraTarget();
    const [x, y, z] = minus(v.getCameraPosition(), target);
    const ahead = times([x, y, -z], 1 / Math.hypot(x, y, z));
    const right = times([-ahead[1], ahead[0], 0], 1 / Math.hypot(x, y) * Math.hypot(x, y, z));
    const up = [ahead[1] * right[2] - ahead[2] * right[1], ahead[2] * right[0] - ahead[0] * right[2], ahead[0] * right[1] - ahead[1] * right[0]];
    v.setCameraPosition(plus(target, [x, y, -z]), false, false);
    v.setCameraQuaternion(quaternion([0, 1, 2].map((k) => [right[k], up[k], ahead[k]])), false);
  }

  // Turns nothing: moves and zooms so that these designators fill the view; by default all that are shown.
  fit(designators = null, share = 0.9) {
    const shown = this.scene.placed.map((p) => p.designator).filter((d) => !this.hidden.has(d));
    const wanted = designators ?? shown;
    if (!wanted.length) return;
    const [low, high] = this.box(wanted);
    this.frame(times(plus(low, high), 0.5), boxCorners(low, high), share);
  }

  // Centres a point and zooms until the points around it fill the share of the view.
  frame(centre, around, share) {
    const camera = this.viewer.camera.getCamera();
    camera.updateMatrixWorld();
    const e = camera.matrixWorld.elements;
    const [right, up] = [[e[0], e[1], e[2]], [e[4], e[5], e[6]]];
    const reach = (axis) => Math.max(...around.map((p) => Math.abs(dot(minus(p, centre), axis))), 1e-3);
    const zoom = share * Math.min(camera.right / reach(right), camera.top / reach(up));
    this.together(() => {
      this.viewer.setCameraZoom(Math.min(zoom, 400), false);
      this.viewer.setCameraTarget(centre, false);
    });
  }

  // Centres a point of a designator, with a share of its length to each side.
  closeUp(point, designator, share = 1 / 6) {
    const [low, high] = this.box([designator]);
    const reach = Math.max(...minus(high, low)) * share;
    this.frame(point, boxCorners(minus(point, [reach, reach, reach]), plus(point, [reach, reach, reach])), 0.9);
  }

  // Cuts along axis 0 to 2 at a place (mm in the scene), keeping the part below or, turned round, above;
  // null: not at all.
  clip(axis, at, turnedRound) {
    this.clips[axis] = at === null ? null : {at, turnedRound};
    this.clipped();
  }

  clipped() {
    this.together(() => this.cut());
  }

  cut() {
    const any = this.clips.some((c) => c !== null);
    const {clipping, nestedGroup} = this.viewer.rendered;
    if (any) {
      const [low, high] = this.box(this.scene.placed.map((p) => p.designator));
      this.viewer.ensureStencilSize({
        xmin: low[0], ymin: low[1], zmin: low[2], xmax: high[0], ymax: high[1], zmax: high[2],
      });
    }
    nestedGroup.setBackVisible(any);
    clipping.setVisible(any);
    clipping.setObjectColorCaps(true);
    this.viewer.renderer.localClippingEnabled = any;
    this.clips.forEach((c, axis) => {
      const way = c?.turnedRound ? 1 : -1;
      const normal = [0, 1, 2].map((k) => (k === axis ? way : 0));
      const far = 1e4;
      this.viewer.setClipNormal(axis, normal, c ? -way * (c.at - clipping.center[axis]) : far, false);
    });
  }

  // Draws once before the next frame, for any number of requests.
  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.viewer.update(true, false);
    });
  }

  // The viewer's calls draw each; these draw once.
  together(calls) {
    this.viewer._suppressUpdate = true;
    try {
      calls();
    } finally {
      this.viewer._suppressUpdate = false;
    }
    this.draw();
  }

  fitted() {
    if (!this.viewer?.ready) return;
    const [width, height] = this.size;
    this.viewer.resizeCadView(width, 0, height, true);
  }

  // The present picture, for printing.
  picture() {
    this.viewer.update(true, false);
    return this.viewer.renderer.domElement.toDataURL('image/png');
  }

  // The designator under a point of the window, null if there is none.
  at(x, y) {
    if (!this.viewer?.ready || !this.viewer.idPicker) return null;
    const around = this.viewer.renderer.domElement.getBoundingClientRect();
    const hit = this.viewer.idPicker.pickAt(x - around.left, y - around.top);
    if (!hit || !this.viewer.pickingController.pickVisible(hit.info)) return null;
    const path = hit.info.solidPath ?? hit.info.path.replace(/\/(faces|edges|vertices)\/[^/]+$/, '');
    return this.byPath.get(path)?.designator ?? null;
  }

  // A click that did not drag picks.
  listen() {
    let start = null;
    this.container.addEventListener('pointerdown', (e) => {
      start = e.button === 0 && e.target instanceof HTMLCanvasElement ? [e.clientX, e.clientY] : null;
    }, true);
    this.container.addEventListener('pointerup', (e) => {
      if (start && Math.hypot(e.clientX - start[0], e.clientY - start[1]) < 4) this.onPick(this.at(...start));
      start = null;
    }, true);
  }
}

const boxCorners = (low, high) => [...Array(8).keys()].map((n) => [0, 1, 2].map((k) => ((n >> k) & 1 ? high : low)[k]));
const RENDERED = {
  ambientIntensity: 1.1, directIntensity: 1.1, metalness: 0.25, roughness: 0.65, edgeColor: 0x3c444d, defaultOpacity: 0.4,
  normalLen: 0,
};
// The viewer's own shortcuts would act on what this page hides.
const KEYS = {shift: 'shiftKey', ctrl: 'ctrlKey', meta: 'metaKey', alt: 'altKey'};
