"""What a page gives to download, by the ending of the file's name."""

__all__ = ["KINDS"]

KINDS = {
    "toml": "application/toml", "csv": "text/csv", "txt": "text/plain", "nc": "application/x-netcdf",
    "pdf": "application/pdf", "glb": "model/gltf-binary",
}  # fmt: skip
