"""Reading and writing files: case files (TOML), results (NetCDF, CSV)."""
