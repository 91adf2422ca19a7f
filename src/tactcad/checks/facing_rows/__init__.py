"""Checks of facing rows: stops, pressed arms, and the circuit that reads the gauges."""
