"""Places of a release's zips: looked at before the work, taken together after it, and nobody's file lost.

Before the new zips take their places these are looked at again: what is then not exactly as tactcad wrote it,
and was not to be discarded, is kept beside as NAME-kept-1.zip.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import count
from pathlib import Path

from tactcad.design.files import flush_entry, folder_for, in_one_line, no_signals, refuse_link
from tactcad.design.held import held_folder, sweep_folders
from tactcad.design.messages import CheckFailure, InputError
from tactcad.export.contents import PROTECTED
from tactcad.export.publication import DISCARD, REFUSE, Say, flush, move, named

from .archive import fault

LINK, OTHER, UNREADABLE = NO_FILE = "a link", "no file", "a file that cannot be read"
Foreign = tuple[str, int, int, int]  # what is the matter with it; inode, size and time (ns) show a change


def looked_at(places: Sequence[Path], others: str) -> dict[str, Foreign]:
    """What lies in the places of zips and is not as tactcad wrote it, by name; changes nothing.

    Raises InputError where there is any and `others` is REFUSE, or any is no file that can be read.
    """
    out = places[0].parent
    refuse_link(out)
    with in_one_line(out):
        foreign = {place.name: found for place in places if (found := _foreign(place))}
    odd = any(why in NO_FILE for why, *_ in foreign.values())
    if odd or (foreign and others == REFUSE):
        differing = named({name: why for name, (why, *_) in foreign.items()})
        what = f"holds what is not as tactcad wrote it: {differing}; nothing was changed"
        ways = "" if odd else "--keep, which moves it beside, --discard, which removes it, or "
        raise InputError(str(out), what, legal=ways + "another folder")
    return foreign


def _foreign(path: Path) -> Foreign | None:
    try:
        s = path.lstat()
    except FileNotFoundError:
        return None
    why = "" if stat.S_ISREG(s.st_mode) else LINK if stat.S_ISLNK(s.st_mode) else OTHER
    try:
        why = why or fault(path) or ("" if s.st_mode & stat.S_IWUSR else PROTECTED)
    except OSError:
        why = UNREADABLE
    return (why, s.st_ino, s.st_size, s.st_mtime_ns) if why else None


@contextmanager
def replacing(places: Sequence[Path], seen: Mapping[str, Foreign], others: str, say: Say) -> Iterator[Path]:
    """A folder for new zips, named as their places, which they take when the block ends well; what lies in
    other places goes. Only a kill between two renames, microseconds apart, can leave some old and some new.

    `seen` is what `looked_at` found; `say` receives a line for all that is kept or discarded. Raises
    InputError where it cannot write there, CheckFailure where there is no room or what appeared was kept.
    """
    out, stem, appeared = places[0].parent, f".{places[0].stem}", []
    with in_one_line(out), folder_for(out):
        sweep_folders(out, stem)
        with held_folder(out, stem) as own:
            yield own
            flush(own)
            with no_signals():
                for place in places:
                    now, before = _foreign(place), seen.get(place.name)
                    if now and now == before and others == DISCARD:
                        say(f"{place}: discarded: {now[0]}")
                    elif now:
                        kept = _kept_beside(place)
                        say(f"{place}: what lay there is kept as {kept}: {now[0]}")
                        appeared += [] if now == before else [str(kept)]
                for place in places:
                    new = own / place.name
                    if place.is_file() and new.exists():
                        new.chmod(stat.S_IMODE(place.stat().st_mode) | stat.S_IWUSR)
                    if new.exists():
                        new.replace(place)
                    else:
                        place.unlink(missing_ok=True)
                flush_entry(out)
    if appeared:
        raise CheckFailure(f"{out}: the new zips stand; what appeared is kept as {', '.join(appeared)}")


def _kept_beside(place: Path) -> Path:
    """Give it the first free name NAME-kept-N.zip as well, so that its place is never empty."""
    for n in count(1):
        kept = place.with_stem(f"{place.stem}-kept-{n}")
        try:
            os.link(place, kept, follow_symlinks=False)
        except FileExistsError:
            continue
        except OSError:  # a folder, or no links here
            move(place, kept)
        break
    return kept
