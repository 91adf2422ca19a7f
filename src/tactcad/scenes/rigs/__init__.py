"""The rigs: every module of this folder declares one, as its `RIG`."""
