"""The closed forms' constants: finite-element samples, the fit on them, and the errors that remain.

In: samples (data/). Out: mechanics/data/ladder.json and accuracy.json, and the tables of docs/.
"""
