"""The release of a design: one zip that a shop can quote from, checked before, while and after it is
written."""
