"""The tactcad command."""

import os

# Set before numpy is loaded: a command solves thousands of small systems, which BLAS threads only slow down
# (`stiffness` on a busy machine: 87 s of processor time, 4 s with one thread). Long work runs in processes.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
