"""The only room that makes solids.

In: a part's description. Out: the CAD kernel's shape, made once, measured, meshed, and written as STEP.
"""
