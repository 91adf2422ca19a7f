"""Many designs measured, on one machine or many, kept as they finish and joined into one table.

In: a study (STUDY.toml): a design, which of its fields vary and how, what is measured. Out: a table with a
row for every design, and a page that shows what depends on what. Dask decides where and when each task runs;
a store keyed by content keeps what is finished.
"""
