"""What an answer costs here and what error it promises: the grades that `--within` and `--in` pick from.

Costs were measured by benchmarks/costs.py; a calibration scales them to this machine.
"""
