"""Motions as moving pictures: where a rig in motion meets the shapes of its muscles."""
