"""Flexure mechanics in closed form: lumped pair, beam ladder, strength. numpy only."""
