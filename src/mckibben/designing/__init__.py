"""From what is wanted to the muscle: designs."""
