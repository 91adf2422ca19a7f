"""The array: where everything stands, its parts, what bends, and what it is read with."""
