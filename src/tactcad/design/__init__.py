"""What is asked for: the parameter tree with unit, range and meaning of every field, alloys, messages of
refusal.

In: TOML text, CSV tables. Out: a frozen `Design`, or one line that says what is wrong, where, and what is
legal.
"""
