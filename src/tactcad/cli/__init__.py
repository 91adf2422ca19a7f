"""The tactcad command."""
