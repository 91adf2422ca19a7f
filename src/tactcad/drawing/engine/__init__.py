"""The means of every drawing: paper, ink, fonts, files, pictures, processes, the layout check."""
