"""A datasheet of a muscle: computed, put into words and pictures, and set as PDF or HTML."""
