"""Bought parts: standard parts by rows of their tables, electronic parts, bill lines without a solid."""
