"""Sheets of scenes: general arrangement, numbered views, parts list."""
