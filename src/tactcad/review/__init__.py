"""One page that shows a design in three dimensions, with every fact a reviewer asks for."""
