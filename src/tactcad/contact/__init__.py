"""The object that an array touches: rigid pads pressed on an elastic body, from separate springs to a layer.

In: the pads' places and compliances, the body, and how far or how hard it is pressed. Out: force, deflection
and contact of every pad. numpy and scipy only; no files, no CAD kernel.
"""
