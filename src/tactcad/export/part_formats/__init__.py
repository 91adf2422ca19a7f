"""The formats that parts are exported in, found by `formats.part_formats`."""
