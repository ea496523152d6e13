"""From tolerances of the numbers to the spread of the results."""
