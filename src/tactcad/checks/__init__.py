"""What must be true of geometry, strength and assembly before anything is released.

In: a design that keeps its rules, and its scenes. Out: a report of findings; a failing one makes the exit
status 1.
"""
