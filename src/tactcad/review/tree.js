// The tree of a scene: sub-assemblies and designators, by mouse or by keyboard alone.
class Tree {
  constructor(list, parts, on) {
    Object.assign(this, {list, parts, on});
    list.addEventListener('keydown', (e) => this.key(e));
    list.addEventListener('click', (e) => this.click(e));
  }

  show(scene) {
    this.hidden = new Set();
    this.items = new Map();
    this.list.replaceChildren();
    const branches = new Map([['', this.list]]);
    for (const placed of scene.placed) {
      let way = '';
      placed.under.forEach((name, level) => {
        const above = branches.get(way);
        way += `\u0000${name}`;
        if (!branches.has(way)) branches.set(way, this.branch(above, name, level + 1));
      });
      this.leaf(branches.get(way), placed, placed.under.length + 1);
    }
    this.list.querySelector('[role=treeitem]')?.setAttribute('tabindex', '0');
    this.counted();
  }

  branch(above, name, level) {
    const inner = el('ul', {role: 'group'});
    const row = this.row(el('span', {className: 'twist', 'aria-hidden': 'true'}), el('b', {}, name), el('small', {}));
    const item = el('li', {role: 'treeitem', tabIndex: -1, 'aria-expanded': 'true', 'aria-level': level}, row, inner);
    item.setAttribute('aria-label', name);
    above.append(item);
    return inner;
  }

  leaf(above, placed, level) {
    const part = this.parts.get(placed.part_no);
    const swatch = el('i', {className: 'swatch'});
    swatch.style.background = part.colour;
    const row = this.row(swatch, el('b', {}, placed.designator), el('span', {className: 'name'}, part.name));
    const item = el('li', {role: 'treeitem', tabIndex: -1, 'aria-level': level, 'aria-selected': 'false'}, row);
    item.setAttribute('aria-label', `${placed.designator}, ${part.name}`);
    item.dataset.designator = placed.designator;
    item.title = `${placed.designator}: ${part.name} (${part.part_no})`;
    this.items.set(placed.designator, item);
    above.append(item);
  }

  row(...children) {
    const check = el('input', {type: 'checkbox', checked: true, tabIndex: -1, 'aria-label': 'shown'});
    const alone = el('button', {type: 'button', className: 'alone', tabIndex: -1, title: 'Show this alone'}, 'only');
    return el('div', {className: 'row'}, check, ...children, alone);
  }

  // Designators at an item and below it.
  under(item) {
    if (item.dataset.designator) return [item.dataset.designator];
    return [...item.querySelectorAll('[data-designator]')].map((leaf) => leaf.dataset.designator);
  }

  click(event) {
    const item = event.target.closest('[role=treeitem]');
    if (!item) return;
    if (event.target.matches('input')) return this.toggle(item, event.target.checked);
    if (event.target.matches('.alone')) return this.isolate(this.under(item));
    this.focus(item);
    if (item.dataset.designator) this.on.select(item.dataset.designator);
    else this.open(item, item.getAttribute('aria-expanded') !== 'true');
  }

  key(event) {
    const item = event.target.closest('[role=treeitem]');
    if (!item || event.ctrlKey || event.metaKey || event.altKey) return;
    const seen = [...this.list.querySelectorAll('[role=treeitem]')].filter((i) => i.offsetParent !== null);
    const n = seen.indexOf(item);
    const expanded = item.getAttribute('aria-expanded');
    const above = item.parentElement.closest('[role=treeitem]');
    const acts = {
      ArrowDown: () => this.focus(seen[n + 1]),
      ArrowUp: () => this.focus(seen[n - 1]),
      Home: () => this.focus(seen[0]),
      End: () => this.focus(seen[seen.length - 1]),
      ArrowRight: () => (expanded === 'false' ? this.open(item, true) : expanded && this.focus(seen[n + 1])),
      ArrowLeft: () => (expanded === 'true' ? this.open(item, false) : this.focus(above)),
      Enter: () => (item.dataset.designator ? this.on.select(item.dataset.designator) : this.open(item, expanded !== 'true')),
      ' ': () => this.toggle(item, !this.under(item).every((d) => !this.hidden.has(d))),
      i: () => this.isolate(this.under(item)),
      a: () => this.isolate([...this.items.keys()]),
    };
    if (!(event.key in acts)) return;
    event.preventDefault();
    acts[event.key]();
  }

  focus(item) {
    if (!item) return;
    for (const other of this.list.querySelectorAll('[tabindex="0"]')) other.tabIndex = -1;
    item.tabIndex = 0;
    item.focus({preventScroll: true});
    item.firstElementChild.scrollIntoView({block: 'nearest'});
  }

  open(item, flag) {
    item.setAttribute('aria-expanded', String(flag));
  }

  toggle(item, shown) {
    const hidden = new Set(this.hidden);
    for (const d of this.under(item)) shown ? hidden.delete(d) : hidden.add(d);
    this.hide(hidden);
  }

  isolate(designators) {
    const kept = new Set(designators);
    this.hide([...this.items.keys()].filter((d) => !kept.has(d)));
    this.on.fit();
  }

  hide(hidden) {
    this.hidden = new Set(hidden);
    this.counted();
    this.on.hide(this.hidden);
  }

  counted() {
    for (const item of this.list.querySelectorAll('[role=treeitem]')) {
      const below = this.under(item);
      const gone = below.filter((d) => this.hidden.has(d)).length;
      const check = item.querySelector('input');
      check.checked = gone === 0;
      check.indeterminate = gone > 0 && gone < below.length;
      const count = item.querySelector(':scope > .row > small');
      if (count) count.textContent = `${below.length}`;
    }
  }

  select(designator) {
    for (const [d, item] of this.items) item.setAttribute('aria-selected', String(d === designator));
    const item = this.items.get(designator);
    if (!item) return;
    for (let up = item.parentElement.closest('[role=treeitem]'); up; up = up.parentElement.closest('[role=treeitem]')) {
      this.open(up, true);
    }
    item.firstElementChild.scrollIntoView({block: 'nearest'});
  }
}
