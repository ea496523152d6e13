"""Pictures of results; they see only what a result carries, so a saved file plots without solving."""
