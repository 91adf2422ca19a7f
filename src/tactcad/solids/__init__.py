"""The only room that makes solids.

In: a part's description. Out: the CAD kernel's shape of it, each made once, measured, meshed, and written as
STEP.
"""
