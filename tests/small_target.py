"""A target that is met in a second: what tests of syntheses change a word or a value of."""

SMALL = """
[target]
name = "small"
[object]
stiffness = [3, 6]
[grasp]
force = 6
overload = 8
[room]
elements = [4, 6]
pitch = 4
[elements]
arms = [5, 7]
hinges = [0.25, 0.4]
"""
