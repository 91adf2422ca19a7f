"""Whether parts within their limits make a sensor: limits that add up, and arrays built virtually.

In: a layout and the limits that its parts state. Out: requirements with nominal, worst case, spread and
contributors, and how many of a thousand arrays go together. No kernel.
"""
