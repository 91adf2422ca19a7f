"""Estimates of a design's elements, and a lab's own readings turned into stiffness with intervals.

In: a design; CSV tables of readings, or an inspection sheet filled in. Out: records, and their text and JSON.
"""
