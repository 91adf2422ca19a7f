"""The tactcad command."""

import os

# Before numpy is loaded: a command solves thousands of small systems, which threads of BLAS only slow down
# (`stiffness` beside other work: 87 s of processor time, 4 s on one thread). Long work runs by processes.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
