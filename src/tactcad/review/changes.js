// The facts beside the picture of a change: the causes with their consequences, and the chosen piece of material.
class ChangePanel extends Panel {
  constructor(record, parts, on) {
    super(record, parts, on);
    this.tab = 'Changes';
    this.pages = {Changes: () => this.changes(), Piece: () => this.piece()};
    byId('open-cover').textContent = 'Changed only';
    byId('parts').setAttribute('aria-label', 'Material');
  }

  select(designator) {
    this.selected = designator;
    this.open(designator ? 'Piece' : this.tab);
  }

  changes() {
    const {sides, causes, together, interactions, differences} = this.record.changes;
    const others = this.record.changes.others[this.scene.name];
    const nothing = !causes.length && !differences.length;
    const made = [
      list(['Before', 'After'].map((name, n) => [name, `${sides[n].source}: ${sides[n].design}, revision ${sides[n].revision}`])),
      this.legend(),
      el('h2', {id: 'heading'}, nothing ? 'Nothing changed' : 'Causes, largest consequence first'),
    ];
    if (causes.length) made.push(el('p', {className: 'hint'}, 'A click shows alone what the cause names in this scene.'));
    for (const cause of causes) made.push(this.cause(cause.what, cause.lines, cause.pieces[this.scene.name]));
    if (others.length) {
      made.push(this.cause('Other material that changed', ['moved or refitted by these causes; none of them names it'], others));
    }
    if (together.length && causes.length > 1) made.push(section('All together', ...lines(together)));
    if (interactions.length) made.push(section('Not the sum', ...lines(interactions)));
    if (this.record.changes.remarks.length) made.push(section('How material was told apart', ...lines(this.record.changes.remarks)));
    if (this.record.changes.not_compared.length) made.push(section('Not compared', ...lines(this.record.changes.not_compared)));
    if (differences.length) {
      const all = section(`Every difference (${differences.length})`, ...lines(differences));
      all.open = differences.length < 20;
      made.push(all);
    }
    return made;
  }

  // How many pieces of each kind are in this scene, with its colour.
  legend() {
    const counts = this.record.changes.counts[this.scene.name];
    const said = {added: 'added', removed: 'removed', kept: 'kept, of parts that changed', same: 'the same'};
    const one = (kind) => {
      const swatch = el('i', {className: 'swatch'});
      swatch.style.background = [...this.parts.values()].find((part) => part.kind === kind).colour;
      return [el('span', {}, swatch, ` ${said[kind]}`), counts[kind]];
    };
    return table(['material in this scene', 'pieces'], Object.keys(said).filter((kind) => counts[kind]).map(one), ['', 'n']);
  }

  cause(what, said, pieces) {
    const made = el('button', {type: 'button', className: 'finding cause', disabled: !pieces.length}, el('b', {}, what),
      ...lines(pieces.length ? said : [...said, 'no material of this scene']));
    made.addEventListener('click', () => {
      this.on.isolate(pieces);
      byId('status').textContent = what;
    });
    return made;
  }

  // Measuring needs the descriptions, which pieces do not have.
  buttons(placed) {
    const bar = super.buttons(placed);
    bar.lastChild.remove();
    return bar;
  }

  piece() {
    const placed = this.placed.get(this.selected);
    if (!placed) return [el('p', {className: 'hint'}, 'Choose a piece: click on it in the picture or in the tree.')];
    const part = this.parts.get(placed.part_no);
    const swatch = el('i', {className: 'swatch'});
    swatch.style.background = part.colour;
    const causes = this.record.changes.causes.filter((cause) => cause.pieces[this.scene.name].includes(placed.designator));
    return [
      el('h2', {id: 'chosen'}, swatch, placed.designator),
      list([
        ['Part number', el('span', {id: 'part-number'}, part.name)], ['Material', el('span', {id: 'piece-kind'}, part.kind)],
        ['Volume', el('span', {id: 'piece-volume'}, `${figures(part.volume_mm3, 5)} mm\u00b3`)], ['Remark', part.remark],
      ]),
      this.buttons(placed),
      ...(causes.length ? [section('Named by', ...causes.map((c) => this.cause(c.what, c.lines, c.pieces[this.scene.name])))] : []),
    ];
  }
}

const lines = (texts) => texts.map((text) => el('p', {}, text));
