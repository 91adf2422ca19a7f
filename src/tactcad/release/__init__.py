"""The release of a design: one zip from which a shop can quote, checked before, during and after writing."""
