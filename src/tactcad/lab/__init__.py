"""Estimates of a design's elements, and a lab's own readings turned into stiffness with intervals.

In: a design, CSV tables of measured or filled-in values. Out: records, and their text and JSON.
"""
