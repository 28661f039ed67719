"""Stacks for simulators: one module a target, each writes what its program needs, complete, into a folder.

The interface of a target module, seen by nobody but :mod:`stepfield.targets.writing`::

    def write(terrain: Terrain, folder: Path, options: Options) -> Written    # fills an empty folder
    def limits(terrain: Terrain) -> list[str]     # what it cannot hold, and what becomes of it: sentences

Nothing heavy is loaded here: help lists the targets without numpy.
"""

#: What each target writes, one line; the name is the module's and the folder's.
WHAT: dict[str, str] = {
    "mesh": "a surface a layer as GLB, OBJ, STL and PLY, whole and decimated",
    "geotiff": "an elevation raster a layer with its coordinate reference system, for GDAL and QGIS",
    "mujoco": "scene.xml and height fields for MuJoCo",
    "pybullet": "arrays and a loader script for PyBullet",
    "gazebo": "an SDF world and models for Gazebo (gz-sim)",
    "usarsim": "16-bit height-maps and T3D terrains for USARSim on UT2004",
}

#: The targets there are.
NAMES: tuple[str, ...] = tuple(WHAT)
