"""The camera that the three views share, and whether the hand is still on it."""

from __future__ import annotations

from PySide6.QtCore import QObject, QTimer, Signal

from stepfield_app.render.camera import Camera

#: Milliseconds of quiet after which the full picture is drawn.
REST = 160
#: Names of the presets: azimuth and elevation in degrees.
PRESETS = {"iso": (-35.0, 30.0), "top": (0.0, 90.0), "front": (0.0, 0.0), "side": (-90.0, 0.0)}


class Viewpoint(QObject):
    """Holds the camera; every view follows it."""

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.camera = Camera((0.5, 0.5, 0.5), *PRESETS["iso"], distance=2.0)
        self.is_moving = self._is_held = False
        self._quiet = QTimer(self, singleShot=True, interval=REST)
        self._quiet.timeout.connect(self._rest)

    def look(self, camera: Camera) -> None:
        """Look through another camera; the full picture follows once the hand rests."""
        self.camera = camera
        self.stir()

    def stir(self) -> None:
        """Draw quickly for a moment: something moves."""
        self.is_moving = True
        self._quiet.start()
        self.changed.emit()

    def set_held(self, is_held: bool) -> None:
        """Say whether a hand holds a control that changes what is seen: then nothing comes to rest."""
        self._is_held = is_held
        if self.is_moving:
            self._quiet.start()

    def _rest(self) -> None:
        if self._is_held:
            return
        self.is_moving = False
        self.changed.emit()
