"""The tactcad command."""

import os

# Before numpy is loaded: a command solves thousands of small systems, which threads of BLAS only slow down, twenty
# times where other work runs beside (`stiffness`: 4 s against 87 s of processor time). Long work runs by processes.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
