"""What every drawing is made with: paper, ink, fonts, files, pictures, processes, the layout check."""
