"""GeoTIFF: a float32 raster a layer, where the source is and in its unit, for GDAL, QGIS and their kin."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.files import one_line
from stepfield.targets.complexmesh import left_out
from stepfield.targets.target import Options, Written
from stepfield.targets.terrain import Terrain, TerrainLayer
from stepfield.targets.text import number, readme, write_text

#: What a hole holds, as declared.
NODATA = -9999.0
#: Side of the squares that a reader loads at a time; a multiple of 16 as TIFF wants it.
TILE = 256


def write(terrain: Terrain, folder: Path, options: Options) -> Written:
    """Write every layer as a raster."""
    written = []
    for layer in terrain.layers:
        for name, values, meaning in _rasters(terrain, layer):
            (folder / name).write_bytes(_raster(terrain, values, meaning))
            written.append(name)
    notes = limits(terrain)
    write_text(folder / "README.txt", readme(terrain, "GeoTIFF", _steps(terrain), notes))
    return Written((*written, "README.txt"), tuple(notes))


def limits(terrain: Terrain) -> list[str]:
    """Say whether the rasters lack a coordinate reference system, and what they cannot hold."""
    return _about_crs(terrain) + left_out(terrain)


def _about_crs(terrain: Terrain) -> list[str]:
    if terrain.manifest.source.up != "z":
        return ["the scan was turned, so its coordinate reference system no longer holds and is left out"]
    if terrain.crs is None:
        return ["the scan has no coordinate reference system: the rasters lie at its plain coordinates"]
    if _crs(terrain) is None:
        return ["GDAL does not understand the scan's coordinate reference system, so it is left out"]
    return []


def _crs(terrain: Terrain) -> Any:
    """Return the coordinate reference system as rasterio has it, None if there is none that holds."""
    import rasterio
    from rasterio.errors import CRSError

    if terrain.crs is None or terrain.manifest.source.up != "z":
        return None
    with rasterio.Env():  # without it GDAL prints its errors
        try:
            return rasterio.crs.CRS.from_wkt(terrain.crs)
        except CRSError:
            return None


def _rasters(terrain: Terrain, layer: TerrainLayer) -> Iterator[tuple[str, NDArray[np.float64], str]]:
    """Name, values (the source's unit; not finite for none) and meaning of each raster of a layer."""
    elevations = layer.elevations.astype(np.float64) + terrain.local_origin[2]
    yield f"{layer.label}.tif", elevations / terrain.unit_factor, layer.name
    if layer.bottoms is not None:
        bottoms = layer.bottoms.astype(np.float64) + terrain.local_origin[2]
        yield f"{layer.label}_bottom.tif", bottoms / terrain.unit_factor, layer.name
    if layer.clearance is not None:
        room = layer.clearance.astype(np.float64) / terrain.unit_factor
        yield f"{layer.label}_clearance.tif", room, f"room above {layer.name}"


def _raster(terrain: Terrain, values: NDArray[np.float64], meaning: str) -> bytes:
    """Return the file of a raster; made in memory, as GDAL would complain of a full disk by itself."""
    import rasterio

    west, north, cell = _placement(terrain)
    profile = {
        "driver": "GTiff",
        "dtype": "float32",
        "count": 1,
        "width": terrain.columns,
        "height": terrain.rows,
        "nodata": NODATA,
        "crs": _crs(terrain),
        "transform": rasterio.Affine(cell, 0, west, 0, -cell, north),
        "tiled": True,
        "blockxsize": TILE,
        "blockysize": TILE,
        "compress": "deflate",
        "predictor": 3,
        "bigtiff": "if_safer",
    }
    with rasterio.Env(), rasterio.MemoryFile() as file:
        with file.open(**profile) as raster:
            raster.write(np.where(np.isfinite(values), values, NODATA).astype(np.float32), 1)
            raster.set_band_description(1, one_line(meaning))
        return bytes(file.getbuffer())


def _placement(terrain: Terrain) -> tuple[float, float, float]:
    """Return the west and north edge and the cell size in the source's unit.

    A pixel is an area to GDAL, its place the corner: half a compartment out from the first sample.
    """
    grid, factor = terrain.manifest.grid, terrain.unit_factor
    north = grid.origin[1] + grid.rows * grid.cell_size
    return grid.origin[0] / factor, north / factor, grid.cell_size / factor


def _steps(terrain: Terrain) -> str:
    west, north, cell = _placement(terrain)
    return "\n".join(
        [
            "layer_NN.tif: elevations as float32; open them with QGIS (drag them in), gdalinfo, rasterio.",
            f"Unit of the source, in all three directions: {terrain.unit} ({number(terrain.unit_factor)} m).",
            f"Not local: the west edge is at {west!r}, the north edge at {north!r}.",
            f"A pixel is {cell!r} wide, and its centre is the middle of its compartment.",
            "Layers of obstacles have a second file, layer_NN_bottom.tif: where each wall or column begins.",
            "layer_NN_clearance.tif, if there: the room up to what is above; nodata where nothing is.",
            f"Holes are nodata, {number(NODATA)}. One file a layer: Gazebo refuses more bands than one.",
        ]
    )
