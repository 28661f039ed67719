"""What every target writes: a stack as it is on disk, decoded and in local coordinates."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stepfield.errors import StackError
from stepfield.grid import Grid
from stepfield.parameters import Way
from stepfield.stack import Manifest, Stack
from stepfield.stack.entries import LayerEntry
from stepfield.surface import Mesh, Sheet, as_simulator, sheets
from stepfield.surface.edges import mesh_of
from stepfield.targets.covering import covered
from stepfield.targets.decimation import triangles

Raster = NDArray[np.float32]

#: Coordinates up to here stay as they are: a float32 still tells half millimetres apart.
FAR = 10_000.0


@dataclass(frozen=True, eq=False)
class TerrainLayer:
    """One layer as a raster of its pillars' tops, and of what was filled between them.

    Attributes
    ----------
    index : int
        0 is the lowest.
    name : str
    elevations : ndarray of shape (rows, columns), float32, read-only
        Metres, local coordinates; row 0 is north, NaN is a hole. A sample stands for the middle of its
        compartment.
    half_level : float
        Half a gray level of the layer's image, metres.
    bottoms : ndarray of shape (rows, columns), float32, read-only, or None
        Of a layer of obstacles: where they begin, as ``elevations``.
    clearance : ndarray of shape (rows, columns), float32, or None
        Room up to what is above, metres; infinite where nothing is, NaN in holes. None if the stack has none.
    """

    index: int
    name: str
    elevations: Raster
    half_level: float
    bottoms: Raster | None = None
    clearance: Raster | None = None

    @property
    def is_obstacles(self) -> bool:
        """Whether the layer is made of solid walls and columns, not a surface."""
        return self.bottoms is not None

    @property
    def label(self) -> str:
        """What the layer's files are called, without a suffix."""
        return f"layer_{self.index:02d}"

    @property
    def occupied(self) -> NDArray[np.bool_]:
        """Where there is a pillar, shape (rows, columns)."""
        return ~np.isnan(self.elevations)

    @property
    def pillars(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Compartments of the pillars, ascending, and their elevations in metres."""
        flat = self.elevations.ravel()
        compartment = np.flatnonzero(~np.isnan(flat))
        return compartment, flat[compartment].astype(np.float64)

    @property
    def quads(self) -> NDArray[np.bool_]:
        """Where all four of neighbouring samples are there, shape (rows - 1, columns - 1)."""
        there = self.occupied
        whole: NDArray[np.bool_] = there[:-1, :-1] & there[:-1, 1:] & there[1:, :-1] & there[1:, 1:]
        return whole

    @property
    def is_whole(self) -> bool:
        """Whether the layer has a surface without a hole."""
        return not self.is_obstacles and self.quads.size > 0 and bool(self.occupied.all())


@dataclass(frozen=True, eq=False)
class Terrain:
    """A stack in the coordinates of a simulator: metres, east, north and up, less ``local_origin``.

    Attributes
    ----------
    name : str
        Of the scan, as it is: to be escaped wherever it is written.
    cell_size : float
        Distance of two samples, metres.
    columns, rows : int
    west, north : float
        Place of the north-west sample, which is the middle of its compartment; local, metres.
    local_origin : tuple of float
        What was subtracted from the scan's coordinates (x, y, z) in metres.
    base_elevation : float
        Of the base plane (Eq. 1); local, metres.
    layers : tuple of TerrainLayer
        The lowest first.
    crs : str or None
        Coordinate reference system of the source, well-known text.
    unit, unit_factor
        Of the source, and the metres in one.
    manifest : Manifest
    reconstruction : str
        ``edges``: surfaces cover exactly the compartments of their pillars; ``simulator``: a vertex a
        sample, a quad where four neighbours are there.
    complex_mesh : Mesh or None
        What stands in for pillars that height-maps cannot hold, where the stack has any; local, metres.
    """

    name: str
    cell_size: float
    columns: int
    rows: int
    west: float
    north: float
    local_origin: tuple[float, float, float]
    base_elevation: float
    layers: tuple[TerrainLayer, ...]
    crs: str | None
    unit: str
    unit_factor: float
    manifest: Manifest = field(repr=False)
    reconstruction: Way = "simulator"
    complex_mesh: Mesh | None = None

    @classmethod
    def of_stack(cls, folder: Path, reconstruction: Way | None = None) -> Terrain:
        """Decode the stack in ``folder``, to be reconstructed as it was built unless told otherwise.

        Raises
        ------
        StackError
            In one sentence, when there is none or it is not whole.
        """
        stack = Stack.open(folder)
        manifest, grid = stack.manifest, stack.grid
        _refuse_misnumbered(folder, manifest)
        origin = _local_origin(grid, manifest)
        half = grid.cell_size / 2
        return cls(
            name=Path(manifest.source.files[0].name).stem if manifest.source.files else "terrain",
            cell_size=grid.cell_size,
            columns=grid.columns,
            rows=grid.rows,
            west=grid.west - origin[0] + half,
            north=grid.south - origin[1] + grid.rows * grid.cell_size - half,
            local_origin=origin,
            base_elevation=manifest.base_elevation - origin[2],
            layers=tuple(_layer(stack, entry, origin[2]) for entry in manifest.layers),
            crs=manifest.source.crs,
            unit=manifest.source.unit,
            unit_factor=manifest.source.unit_factor,
            manifest=manifest,
            reconstruction=reconstruction or manifest.parameters.reconstruction,
            complex_mesh=_complex_mesh(stack, origin),
        )

    @property
    def east(self) -> float:
        """Place of the east-most samples; local, metres."""
        return self.west + (self.columns - 1) * self.cell_size

    @property
    def south(self) -> float:
        """Place of the south-most samples; local, metres."""
        return self.north - (self.rows - 1) * self.cell_size

    @property
    def grid(self) -> Grid:
        """The compartments in local coordinates."""
        half = self.cell_size / 2
        return Grid(self.west - half, self.south - half, self.cell_size, self.columns, self.rows)

    @cached_property
    def sheets(self) -> list[Sheet]:
        """The layers' surfaces over exactly the compartments of their pillars; local, metres."""
        none = (np.zeros(0, np.int64), np.zeros(0))
        layers = [none if layer.is_obstacles else layer.pillars for layer in self.layers]
        return sheets(self.grid, layers, self.link_step)

    @property
    def link_step(self) -> float:
        """Greatest difference in elevation of two neighbours that continue each other, metres."""
        parameters = self.manifest.parameters
        step = parameters.layer_tolerance if parameters.link_step == "auto" else parameters.link_step
        return math.inf if step == "auto" else float(step)

    def has_body(self, layer: TerrainLayer) -> bool:
        """Whether there is anything of a layer to run into."""
        is_covered = layer.is_obstacles or self.reconstruction == "edges"
        return bool((layer.occupied if is_covered else layer.quads).any())

    def surface(self, layer: TerrainLayer, error_bound: float | None = None) -> Mesh:
        """Return a layer as triangles, as the terrain's reconstruction makes them (paper 6).

        Vertices are local, shared by neighbours, and none is without a triangle; a layer without surface
        makes an empty mesh. With an error bound in metres, fewer triangles that stay within it above and
        below; holes, rims and steps stay. What is ``simulator`` has quads that are cut from north-west to
        south-east.
        """
        if self.reconstruction == "edges":
            sheet = self.sheets[layer.index]
            return mesh_of(sheet) if error_bound is None else covered(sheet, error_bound)
        flat = layer.elevations.ravel()
        if error_bound is not None:
            return self._mesh(flat, triangles(layer.elevations, error_bound))
        return as_simulator(self.grid, *layer.pillars)

    def _mesh(self, elevations: Raster, corners: NDArray[np.int64]) -> Mesh:
        """Make a mesh of triangles between samples, given by number, with the vertices that they use."""
        used = np.zeros(len(elevations), bool)
        used[corners] = True
        sample = np.flatnonzero(used)
        number = np.cumsum(used) - 1
        return Mesh(np.column_stack([self.grid.centres(sample), elevations[sample]]), number[corners])


def _refuse_misnumbered(folder: Path, manifest: Manifest) -> None:
    """Files are named by the layers' numbers, so that a number given twice would lose a layer."""
    if [layer.index for layer in manifest.layers] != list(range(len(manifest.layers))):
        raise StackError(f"{folder}: the layers are not numbered 0, 1, 2, ...; build the stack again")


def _local_origin(grid: Grid, manifest: Manifest) -> tuple[float, float, float]:
    """Choose what to subtract: nothing near zero, else the south-west corner down to a whole metre.

    Elevations are seldom far, and then keep their meaning; where they are, the base plane takes the part
    of the corner.
    """
    depth, width = grid.rows * grid.cell_size, grid.columns * grid.cell_size
    plan = (grid.west, grid.south, grid.west + width, grid.south + depth)
    heights = (manifest.base_elevation, manifest.base_elevation + manifest.max_height)
    x, y = (math.floor(v) for v in plan[:2]) if _is_far(plan) else (0, 0)
    return float(x), float(y), float(math.floor(heights[0]) if _is_far(heights) else 0)


def _complex_mesh(stack: Stack, origin: tuple[float, float, float]) -> Mesh | None:
    """Return the mesh of the complex parts in local coordinates; None where there is nothing of it."""
    mesh = stack.complex_mesh()
    if mesh is None or not len(mesh.triangles):
        return None
    return Mesh(mesh.vertices - np.array(origin), mesh.triangles)


def _is_far(coordinates: tuple[float, ...]) -> bool:
    return any(abs(value) > FAR for value in coordinates)


def _layer(stack: Stack, entry: LayerEntry, origin: float) -> TerrainLayer:
    grid = stack.grid
    elevations = stack.elevations(entry, filled=True)
    if elevations.shape != (grid.rows, grid.columns):
        raise StackError(f"{stack.folder}: the grid does not fit into the images; build the stack again")
    bottoms, room = stack.bottoms(entry), stack.clearances(entry)
    return TerrainLayer(
        entry.index,
        entry.name,
        _local(stack, entry, elevations, origin),
        entry.scale / 2,
        None if bottoms is None else _local(stack, entry, bottoms, origin),
        None if room is None else room.astype(np.float32),
    )


def _local(stack: Stack, entry: LayerEntry, elevations: NDArray[np.float64], origin: float) -> Raster:
    """Turn elevations into local ones, as precise as simulators have them."""
    with np.errstate(over="ignore"):
        local = (elevations - origin).astype(np.float32)
    if np.isinf(local).any():
        raise StackError(
            f"{stack.folder / entry.image}: elevations of {entry.offset:g} m are beyond what any simulator "
            f"holds; build the stack again"
        )
    local.flags.writeable = False
    return local
