"""A night that is stopped goes on where it was, and says what failed; its items are all there."""

from __future__ import annotations

import json

import night
import night_items
import pytest
from night_items import Item, Night

pytestmark = pytest.mark.slow  # starts test runs

STOPPED_AFTER = 3


@pytest.fixture
def tried(monkeypatch):
    """What is tried, in this process, where every design whose number ends in 4 fails; the first run is
    stopped."""
    tried: list[str] = []

    def design(item: Item) -> dict:
        tried.append(item.what)
        failed = ["bad"] if item.what.endswith("4") else []
        return {"rule": "", "scenes": ["array"], "failed": failed, "draw": int(item.what)}

    def in_this_process(orders: list[Item], workers: int) -> int:
        left = [item for item in orders if item.found() is None]
        for n, item in enumerate(left):
            if n == STOPPED_AFTER and len(left) == len(orders):
                raise KeyboardInterrupt
            assert item.carry_out().computed and not item.carry_out().computed
        return len(left)

    monkeypatch.setattr(night_items, "_design", design)
    monkeypatch.setattr(night, "carried_out", in_this_process)
    monkeypatch.setattr(night, "sources", lambda: "as they are")
    monkeypatch.delenv("TACTCAD_SEED", raising=False)
    return tried


def ran(monkeypatch, folder, *options: str) -> int:
    monkeypatch.setenv("TACTCAD_CACHE", str(folder))  # put back at the end: main sets it
    monkeypatch.setattr(
        "sys.argv", ["night.py", str(folder), "--kinds", "design", "--designs", "8", *options]
    )
    return night.main()


def test_a_night_that_was_stopped_goes_on(tried, tmp_path, monkeypatch, capsys):
    with pytest.raises(KeyboardInterrupt):
        ran(monkeypatch, tmp_path)
    seed = json.loads((tmp_path / "night.json").read_text())["seed"]
    assert len(tried) == STOPPED_AFTER
    assert ran(monkeypatch, tmp_path) == 1
    assert sorted(tried) == [str(n) for n in range(8)]
    out = capsys.readouterr().out
    assert f"seed {seed}: 5 tried now, 3 before\ndesign 4: bad\n" in out
    assert "8 designs drawn: 7 accepted (array 7), 0 refused by a named rule (), 1 failed |" in out


def test_after_a_night_comes_another(tried, tmp_path, monkeypatch):
    seeds = set()
    for n in range(3):
        monkeypatch.setattr(night, "sources", lambda n=n: str(n == 2))
        for _ in range(1 + (n == 0)):
            try:
                ran(monkeypatch, tmp_path)
            except KeyboardInterrupt:
                pass
        seeds.add(json.loads((tmp_path / "night.json").read_text())["seed"])
    assert len(seeds) == 3


def test_it_publishes_between_its_marks_only(tried, tmp_path, monkeypatch):
    page = tmp_path / "tried.md"
    page.write_text(f"before\n{night.BEGIN}old\n{night.END}after\n<!-- end -->\n")
    monkeypatch.setattr(night, "DOCUMENT", page)
    with pytest.raises(KeyboardInterrupt):
        ran(monkeypatch, tmp_path / "n")
    ran(monkeypatch, tmp_path / "n", "--publish")
    text = page.read_text()
    assert text.startswith("before\n") and text.endswith("\nafter\n<!-- end -->\n") and "old" not in text
    assert "7 accepted" in text and night.BEGIN in night.DOCUMENT.read_text()


def test_every_item_is_there_once(request):
    every = night.items(Night("nowhere", 1, ""), list(night.KINDS), 5)
    assert len({item.key for item in every}) == len(every) == len({item.number for item in every})
    kinds = {kind: [i.what for i in every if i.kind == kind] for kind in night.KINDS}
    assert kinds["design"] == list("01234") and kinds["kill"] == list(night_items.KILLS)
    assert len(kinds["mutant"]) > 300 and set(kinds["mutant"]) == set(night_items._mutants())
    for test in night_items.KILLS:
        path, _, name = test.partition("::")
        assert "@pytest.mark.night\n" in (text := (night_items.ROOT / path).read_text())
        assert f"def {name.partition('[')[0]}(" in text.partition("@pytest.mark.night\n")[2]


def test_what_is_mended_is_tried_again_and_no_more(tmp_path, monkeypatch):
    """A test counts for what runs it, fixtures for the tests below them, all else for everything."""
    monkeypatch.setattr(night, "ROOT", tmp_path)
    monkeypatch.setattr(night_items, "ROOT", tmp_path)
    names = ("tests/a/test_a.py", "tests/b/test_b.py", "tests/a/conftest.py", "tests/help.py", "src/x.py")
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")

    def keys() -> list[str]:
        night_items._tests_digest.cache_clear()
        now = Night("nowhere", 1, night.sources())
        kinds = ("whole", names[0]), ("kill", f"{names[1]}::test"), ("design", "7")
        return [Item(now, n, *one).key for n, one in enumerate(kinds)]

    changed = {}
    for name in names:
        before = keys()
        (tmp_path / name).write_text("other")
        changed[name] = [old != new for old, new in zip(before, keys(), strict=True)]
    only_a, only_b, everything = [True, False, False], [False, True, False], [True] * 3
    assert list(changed.values()) == [only_a, only_b, only_a, everything, everything]
    night_items._tests_digest.cache_clear()
