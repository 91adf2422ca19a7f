"""Processes that help an export end with it, however it ends."""

from __future__ import annotations

import ctypes
import os
import signal
from contextlib import suppress

from tactcad.ending import past_ending

PR_SET_PDEATHSIG = 1  # Linux, prctl(2)


def end_with(parent: int) -> None:
    """Let this process be killed when its parent, of that number, is gone.

    A forked helper waits for work for ever where its parent was killed, and holds what it inherited: the lock of the
    export's folder among it. Systems without prctl leave it waiting. Ctrl-C and a terminal's end reach it too, but
    it is the parent that answers; by SIGTERM the pool ends it.
    """
    past_ending()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it was gone before
        os._exit(1)
