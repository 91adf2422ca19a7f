"""Sheets of the circuit: one channel, all channels, the leads' way, the leads."""
