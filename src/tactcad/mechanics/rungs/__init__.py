"""The rungs of the model ladder: every module declares one or more, each a `Rung`; nothing lists them."""
