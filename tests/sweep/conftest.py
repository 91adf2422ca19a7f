"""A cluster that small studies share: a cluster of their own would take longer than they do."""

from __future__ import annotations

import pytest
from small_study import cluster


@pytest.fixture(scope="session")
def scheduler(tmp_path_factory):
    """Address of a Dask scheduler with one worker."""
    with cluster(tmp_path_factory.mktemp("workers")) as (address, _):
        yield address
