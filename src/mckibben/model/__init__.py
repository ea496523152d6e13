"""The mechanics as plain pointwise functions. Float64 everywhere: equilibria here are differences of large terms."""
