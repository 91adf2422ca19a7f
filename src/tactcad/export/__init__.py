"""Files for the shop and the reviewer, each read back after writing."""
