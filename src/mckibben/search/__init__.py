"""Where the straight way to a state fails: walk there, on more unknowns, near extension, sideways, elsewhere."""
