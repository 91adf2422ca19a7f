"""The published tables, and the models compared with them.

In: the paper's figures as printed (data/), a design. Out: `tactcad validate`'s report, and the pictures of
docs/.
"""
