"""Many designs measured, on one machine or many, kept as they finish and joined into one table.

In: a study (STUDY.toml): a design, its varied fields, and the results to measure. Out: a table with a row for
every design, and a page of the results' dependences. Dask schedules the tasks; a store keyed by content keeps
finished results.
"""
