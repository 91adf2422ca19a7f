"""The families of sensors: every module or folder of this one declares one, as its `FAMILY`
(tactcad.design.family)."""
