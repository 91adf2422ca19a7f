"""The only maker of solids: from a part's description to the CAD kernel's shape."""
