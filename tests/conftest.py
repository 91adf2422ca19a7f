"""What all tests share: nobody's cache but their own, and the shipped array's shapes, built once.

Its being here also puts tests/ on the import path, for variants.py and sound_designs.py.
"""

from __future__ import annotations

import gc
import os

import pytest
from built import shapes_of
from variants import variant


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


def pytest_collection_modifyitems(items):
    """Pages first: typing them takes one worker long, and at the end the other one would stand idle."""
    items.sort(key=lambda item: item.path.name != "test_pages.py")


def pytest_collection_finish():
    """Thousands of tests and all libraries stay to the end: they are not looked through for garbage again and
    again, nor copied by what is forked. What is young is looked through less often: three hundredths of the
    time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 20, 100)


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
