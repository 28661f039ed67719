"""Which suffixes are scans: known without what reads them."""

from __future__ import annotations

#: Which module of :mod:`stepfield.scan` reads which suffix; modules load when they are needed.
FORMATS = {
    ".ply": "ply",
    ".pcd": "pcd",
    ".las": "las",
    ".laz": "las",
    ".e57": "e57",
    ".ptx": "ptx",
    ".xyz": "text",
    ".txt": "text",
    ".csv": "text",
    ".asc": "text",
    ".pts": "text",
    ".npy": "npy",
    ".npz": "npy",
    ".obj": "mesh",
    ".stl": "mesh",
    ".off": "mesh",
}
