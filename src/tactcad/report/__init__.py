"""Reports: findings, tables and plots as data, written as one offline page and as JSON."""
