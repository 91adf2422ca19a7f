"""The array: its layout, parts, deflections, and read-out."""
