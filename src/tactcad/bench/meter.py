"""Runs a command and writes its time, largest memory and exit status: `python meter.py RESULT.json
COMMAND...`

A process of its own, and a small one: a child's largest memory counts from the moment it is forked, when it
still is as large as its parent.
"""

import json
import os
import sys
import time

if __name__ == "__main__":
    target, *command = sys.argv[1:]
    start = time.perf_counter()
    pid = os.posix_spawnp(command[0], command, os.environ)
    _, status, usage = os.wait4(pid, 0)
    seconds = time.perf_counter() - start
    unit = 1 if sys.platform == "darwin" else 1024  # bytes there, KiB elsewhere
    with open(target, "w") as file:
        json.dump({"seconds": seconds, "peak_bytes": usage.ru_maxrss * unit}, file)
    sys.exit(os.waitstatus_to_exitcode(status))
