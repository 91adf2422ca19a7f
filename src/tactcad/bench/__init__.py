"""Speed against accuracy, measured on the machine that it runs on: `tactcad bench`.

Each benchmark is one module with TITLE, QUESTION and measure(plan), which returns a dict of tables, findings
and what could not be measured. Everything that is shown (text, Markdown, CSV, plots, the tables in docs/) is
made from the JSON that a run writes.
"""
