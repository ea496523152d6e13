"""Finding equilibria: straight to one state, along a path of states, and how stable they are."""
