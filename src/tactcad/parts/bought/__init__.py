"""What is bought: standard parts by rows of their tables, electronic parts, lines of the bill without a
solid.
"""
