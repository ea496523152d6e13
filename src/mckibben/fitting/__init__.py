"""From measured data to the muscle: fits, how sure they are, and which effects they need."""
