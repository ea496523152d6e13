"""Making the map of a muscle."""
