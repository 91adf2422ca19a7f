"""Flexure mechanics in closed form: lumped pair, ladder of hinge models, strain, strength, read-out. numpy
only.

In: a `HingeSection` (numbers or arrays; mm, N, MPa) and what loads it. Out: arrays, or a named refusal.
"""
