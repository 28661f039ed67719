"""Open3D, and nothing else of it: a hidden window that geometry is put into and pictures are taken of."""

from __future__ import annotations

import os
import sys
import tempfile
from dataclasses import dataclass
from math import radians, tan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield_app.render.camera import Camera, Size
from stepfield_app.render.scene import Bytes, Singles, Triangles

Doubles = NDArray[np.float64]

#: Sides of canvases are multiples of this: a window being resized does not need a new one at each step.
STEP = 64
LEAST = 32
#: Open3D's name for a parallel projection is a field of view of five degrees.
PARALLEL_DEGREES = 5.0
#: A near plane nearer than this share of the far one would leave the depth buffer too coarse.
NEAR_SHARE = 5e-4


def load() -> Any:
    """Import Open3D so that it never opens a window and says nothing.

    Raises
    ------
    ImportError
        Open3D is missing, or a library of the system it needs is.
    """
    if sys.platform == "linux":
        # with a display it would make a real window, that others see
        for name in ("DISPLAY", "WAYLAND_DISPLAY"):
            os.environ.pop(name, None)
        os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())
    import open3d

    open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
    return open3d


@dataclass(frozen=True)
class Span:
    """A ball around all that is to be seen: bounds of the depth buffer."""

    centre: Doubles
    radius: float

    def near_far(self, camera: Camera) -> tuple[float, float]:
        """Depths between which everything lies, metres; both positive for a perspective."""
        depth = float((self.centre - camera.eye) @ camera.forward)
        far = depth + self.radius
        if camera.parallel:
            return depth - self.radius, far
        far = max(far, camera.distance * 2)
        return max(depth - self.radius, far * NEAR_SHARE), far


class Canvas:
    """A hidden window of Open3D.

    Its size is rounded up; pictures are cut out of its middle. Parts are kept by name, each with the key of
    what was put there last, so that only what changed is sent again.
    """

    def __init__(self, library: Any, size: Size) -> None:
        self._library, self.size = library, size
        self._window = library.visualization.Visualizer()
        if not self._window.create_window("stepfield", *size, visible=False):
            raise OSError("Open3D could not open a hidden window")
        option = self._window.get_render_option()
        option.light_on = False
        option.mesh_show_back_face = True
        self._parts: dict[str, tuple[object, Any]] = {}
        self._view = self._window.get_view_control()
        self._measure()

    def _measure(self) -> None:
        """Make zoom a length in metres: Open3D counts it in sizes of what was added first."""
        corners = self._library.utility.Vector3dVector(np.array([[-0.5] * 3, [0.5] * 3]))
        cube = self._library.geometry.PointCloud(corners)
        self._window.add_geometry(cube, True)
        self._window.remove_geometry(cube, False)

    def close(self) -> None:
        """Close the window, and with it all others: Open3D ends the display they share."""
        self._window.destroy_window()

    def background(self, colour: tuple[int, int, int]) -> None:
        """Set the colour of what nothing covers."""
        self._window.get_render_option().background_color = np.asarray(colour) / 255

    def key(self, name: str) -> object | None:
        """Return the key of what a part shows, None for nothing."""
        return self._parts.get(name, (None, None))[0]

    def clear(self, name: str) -> None:
        """Show nothing as this part."""
        if name in self._parts:
            self._window.remove_geometry(self._parts.pop(name)[1], False)

    def points(self, name: str, key: object, places: Singles, colours: Bytes) -> None:
        """Show points, colours of shape (N, 3)."""
        if not len(places):
            return self.clear(name)
        cloud = self._library.geometry.PointCloud()
        cloud.points = self._vectors(places)
        cloud.colors = self._vectors(colours, 1 / 255)
        return self._put(name, key, cloud)

    def mesh(self, name: str, key: object, mesh: Triangles) -> None:
        """Show triangles."""
        if not len(mesh.triangles):
            return self.clear(name)
        made = self._library.geometry.TriangleMesh()
        made.vertices = self._vectors(mesh.vertices)
        made.triangles = self._library.utility.Vector3iVector(np.array(mesh.triangles))
        made.vertex_colors = self._vectors(mesh.colours, 1 / 255)
        return self._put(name, key, made)

    def lines(self, name: str, key: object, ends: Singles, colours: Bytes) -> None:
        """Show segments, ends of shape (L, 2, 3)."""
        if not len(ends):
            return self.clear(name)
        lines = self._library.geometry.LineSet()
        lines.points = self._vectors(ends.reshape(-1, 3))
        pairs = np.arange(2 * len(ends), dtype=np.int32).reshape(-1, 2)
        lines.lines = self._library.utility.Vector2iVector(pairs)
        lines.colors = self._vectors(colours, 1 / 255)
        return self._put(name, key, lines)

    def shoot(self, camera: Camera, size: Size, span: Span, point_size: float) -> Singles:
        """Draw and return red, green and blue, 0 to 1, of shape (height, width, 3)."""
        self._window.get_render_option().point_size = point_size
        self._look(camera, size, span)
        self._window.poll_events()
        self._window.update_renderer()
        return self._cut(np.asarray(self._window.capture_screen_float_buffer(False)), size)

    def depth(self, camera: Camera, size: Size, span: Span) -> Singles:
        """Return the depth of what :meth:`shoot` drew, metres, 0 where nothing is."""
        told = self._cut(np.asarray(self._window.capture_depth_float_buffer(False)), size)
        if not camera.parallel:
            return np.ascontiguousarray(told)
        # Open3D undoes a perspective whatever the projection: do that again, and read the plain buffer
        near, far = self._near_far(camera, size, span)
        depth = np.zeros(told.shape, np.float32)
        drawn = told > 0
        share = far * (told[drawn].astype(np.float64) - near) / (told[drawn] * (far - near))
        depth[drawn] = near + share * (far - near) - self._reach(camera, size) + camera.distance
        return depth

    def _vectors(self, rows: NDArray[Any], scale: float | None = None) -> Any:
        doubles = np.multiply(rows, scale, dtype=np.float64) if scale else rows.astype(np.float64)
        return self._library.utility.Vector3dVector(doubles)

    def _put(self, name: str, key: object, geometry: Any) -> None:
        self.clear(name)
        self._window.add_geometry(geometry, False)
        self._parts[name] = key, geometry

    def _cut(self, picture: NDArray[Any], size: Size) -> NDArray[Any]:
        left, top = (self.size[0] - size[0]) // 2, (self.size[1] - size[1]) // 2
        return picture[top : top + size[1], left : left + size[0]]

    def _look(self, camera: Camera, size: Size, span: Span) -> None:
        if camera.parallel:
            self._view.change_field_of_view(-1000)
            self._view.set_zoom(self._half_height(camera, size))
            self._view.set_lookat(np.asarray(camera.centre, float))
            self._view.set_front(-camera.forward)
            self._view.set_up(camera.up)
        else:
            self._view.change_field_of_view(1000)
            self._view.convert_from_pinhole_camera_parameters(self._pinhole(camera, size), True)
        near, far = self._near_far(camera, size, span)
        self._view.set_constant_z_near(near)
        self._view.set_constant_z_far(far)

    def _half_height(self, camera: Camera, size: Size) -> float:
        return camera.metres_per_pixel(size) * self.size[1] / 2

    def _reach(self, camera: Camera, size: Size) -> float:
        """Distance of the eye Open3D takes for a parallel projection."""
        return self._half_height(camera, size) / tan(radians(PARALLEL_DEGREES / 2))

    def _near_far(self, camera: Camera, size: Size, span: Span) -> tuple[float, float]:
        near, far = span.near_far(camera)
        if camera.parallel:
            shift = self._reach(camera, size) - camera.distance
            near, far = near + shift, far + shift
        return near, far

    def _pinhole(self, camera: Camera, size: Size) -> Any:
        width, height = self.size
        focal = size[1] / 2 / Camera.SLOPE
        parameters = self._library.camera.PinholeCameraParameters()
        parameters.intrinsic = self._library.camera.PinholeCameraIntrinsic(
            width, height, focal, focal, width / 2 - 0.5, height / 2 - 0.5
        )
        extrinsic = np.eye(4)
        extrinsic[:3, :3] = [camera.right, -camera.up, camera.forward]
        extrinsic[:3, 3] = -extrinsic[:3, :3] @ camera.eye
        parameters.extrinsic = extrinsic
        return parameters


def rounded_up(size: Size) -> Size:
    """Size of the canvas for a picture."""
    width, height = (LEAST if side <= LEAST else -(-side // STEP) * STEP for side in size)
    return width, height
