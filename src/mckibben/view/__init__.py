"""Pictures of results. They use only what a result holds, so that a saved file is drawn without solving."""
