"""Cost and promised error of an answer on this machine: the grades that `--within` and `--in` pick from.

Costs were measured by benchmarks/costs.py; a calibration scales them to this machine.
"""
