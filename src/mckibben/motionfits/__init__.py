"""From measured motions to the rig: valves, viscosity, loads."""
