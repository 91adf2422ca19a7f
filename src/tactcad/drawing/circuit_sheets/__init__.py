"""The circuit's sheets."""
