"""The parameter tree, materials, loading, and the messages of refusal."""
