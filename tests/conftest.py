"""What all tests share: nobody's cache but their own, and the shipped array's shapes, built once.

Its being here also puts tests/ on the import path, for variants.py and sound_designs.py.
"""

from __future__ import annotations

import gc
import os
from collections import Counter

import manifold3d
import pytest
from built import shapes_of
from variants import variant

# What is young is looked through less often than Python does, which takes three hundredths of the time; while
# 300 modules are loaded nearly all of it stays.
gc.set_threshold(100_000, 20, 100)


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory):
    """No test reads what another run, or the user's own exports, left in the cache; tests that run side by
    side share one."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TACTCAD_CACHE", str(folder / "cache"))
        yield


@pytest.fixture(scope="session", autouse=True)
def one_thread_of_meshes():
    """manifold3d starts as many threads as there are cores when it first computes. Tests run side by side
    already: a second thread, which waits by turning round, takes a third more processor time."""
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    ball = manifold3d.Manifold.sphere(1.0, 4)
    assert (ball ^ ball.translate((0.1, 0.0, 0.0))).volume() > 0.0
    os.sched_setaffinity(0, cores)


@pytest.hookimpl(tryfirst=True)  # before what is not asked for by its marks is left out
def pytest_collection_modifyitems(items):
    """Pages first: typing them takes one worker long, and at the end the other one would stand idle. Of a
    test `by_day(count, why)` all cases but the first are slow."""
    items.sort(key=lambda item: item.path.name != "test_pages.py")
    seen: Counter[str] = Counter()
    for item in items:
        by_day = item.get_closest_marker("by_day")
        if by_day and not item.get_closest_marker("nightly") and not item.get_closest_marker("slow"):
            seen[test := item.nodeid.partition("[")[0]] += 1
            if seen[test] > by_day.args[0]:
                item.add_marker("slow")


def pytest_collection_finish():
    """Thousands of tests and all libraries stay to the end: they are not looked through for garbage again and
    again, nor copied by what is forked."""
    gc.collect()
    gc.freeze()


def pytest_terminal_summary(terminalreporter):
    """What a test reports besides passing or failing: seeds and counts of the designs drawn by chance."""
    for reports in terminalreporter.stats.values():
        for report in reports:
            for name, value in getattr(report, "user_properties", ()):
                if report.when == "call":
                    terminalreporter.write_line(f"{name}: {value}")


@pytest.fixture(scope="session")
def macro():
    """The paper's array as shipped."""
    return variant()


@pytest.fixture(scope="session")
def macro_scene(macro):
    from tactcad.scenes import make_scene

    return make_scene(macro, "array")


@pytest.fixture(scope="session")
def macro_shapes(macro_scene):
    """Part number -> the kernel's shape in the part's own frame."""

    return shapes_of(macro_scene)
