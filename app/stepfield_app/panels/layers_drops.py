"""What can be dropped on the list of layers: the selected pillars, and a row that goes to another place."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QPoint, QTimer
from PySide6.QtGui import QDragEnterEvent, QDragLeaveEvent, QDragMoveEvent, QDropEvent

from stepfield.layers import UNASSIGNED
from stepfield.moving import Plan
from stepfield_app.editor import PILLARS_MIME, Editor
from stepfield_app.panels.layers_list import LayersList
from stepfield_app.panels.layers_model import LAYER_MIME, LayersModel, Notice, Role

#: Stands for the layer that a drop below the rows makes.
NEW = "new layer"
COUNTING = Notice("counting…")
#: Height of the strips at both ends over which the list scrolls by itself, pixels; a step, and how often.
EDGE, STEP, EVERY = 24, 12, 40


class LayersDrops(QObject):
    """Watches what is dragged over a list of layers, says what a drop would do, and wishes for it.

    Parameters
    ----------
    view : LayersList
    model : LayersModel
    editor : Editor
    """

    def __init__(self, view: LayersList, model: LayersModel, editor: Editor) -> None:
        super().__init__(view)
        self._view, self._model, self._editor = view, model, editor
        self._target: int | str | None = None
        self._dragged: int | None = None
        self._place = QPoint()
        self._scrolling = QTimer(self, interval=EVERY)
        self._scrolling.timeout.connect(self._scroll)
        editor.previews_changed.connect(self._say_what_would_be)
        view.setDragEnabled(True)
        view.viewport().setAcceptDrops(True)
        view.viewport().installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        """Take what is dragged; the rest is the list's."""
        match event:
            case QDragEnterEvent():
                return self._enter(event)
            case QDragMoveEvent():
                return self._follow(event)
            case QDragLeaveEvent():
                self._forget()
                return True
            case QDropEvent():
                return self._drop(event)
        return False

    # --- While it is dragged --------------------------------------------------------------------------------

    def _enter(self, event: QDragEnterEvent) -> bool:
        data = event.mimeData()
        if data.hasFormat(PILLARS_MIME):
            self._editor.plan_ahead()
        elif data.hasFormat(LAYER_MIME):
            self._dragged = int(data.data(LAYER_MIME).data())
        else:
            return False
        self._scrolling.start()
        event.acceptProposedAction()
        return True

    def _follow(self, event: QDragMoveEvent) -> bool:
        self._place = event.position().toPoint()
        self._look_below()
        event.setAccepted(self._can_drop())
        return True

    def _look_below(self) -> None:
        """Find out over what the hand is, and say what a drop there would do."""
        if self._dragged is not None:
            self._view.set_gap(self._gap_at(self._place))
        else:
            index = self._view.indexAt(self._place)
            self._target = index.data(Role.ROW).index if index.isValid() else NEW
            self._say_what_would_be()

    def _can_drop(self) -> bool:
        if self._dragged is not None:
            return self._new_number() != self._dragged
        plan = self._plan()
        return plan is None or not plan.reason

    def _plan(self) -> Plan | None:
        return None if self._target is None else self._editor.preview(self._target)

    def _say_what_would_be(self) -> None:
        target = self._target
        if target is None:
            return
        notice = self._notice()
        if isinstance(target, int):
            self._view.set_foot(None)
            self._model.set_notice(target, notice)
        else:
            self._view.set_foot(Notice(f"New layer: {notice.text}", notice.is_refusal))
            self._model.set_notice(UNASSIGNED, None)

    def _notice(self) -> Notice:
        plan = self._plan()
        if plan is None:
            return COUNTING
        return Notice(plan.sentence, is_refusal=bool(plan.reason))

    def _scroll(self) -> None:
        """Scroll while the hand is near an end of the list."""
        bar, height = self._view.verticalScrollBar(), self._view.viewport().height()
        step = STEP if self._place.y() > height - EDGE else -STEP if self._place.y() < EDGE else 0
        before = bar.value()
        bar.setValue(before + step)
        if bar.value() != before:
            self._look_below()

    def _forget(self) -> None:
        self._scrolling.stop()
        self._target = self._dragged = None
        self._view.set_gap(None)
        self._view.set_foot(None)
        self._model.set_notice(UNASSIGNED, None)

    # --- When it is dropped ---------------------------------------------------------------------------------

    def _drop(self, event: QDropEvent) -> bool:
        self._place = event.position().toPoint()
        self._look_below()
        target, dragged, number = self._target, self._dragged, self._new_number()
        self._forget()
        event.acceptProposedAction()
        if dragged is not None:
            self._editor.reorder(dragged, number)
        elif isinstance(target, int):
            self._editor.move_to(target)
        else:
            self._editor.new_layer(move_selection=True)
        return True

    # --- Rows that are dragged ------------------------------------------------------------------------------

    def _gap_at(self, place: QPoint) -> int:
        """Row above which a row dropped here goes; never below Unassigned."""
        layers = sum(row.index != UNASSIGNED for row in self._model.rows)
        index = self._view.indexAt(place)
        if not index.isValid():
            return layers
        lower_half = place.y() > self._view.visualRect(index).center().y()
        return min(index.row() + lower_half, layers)

    def _new_number(self) -> int:
        """Return the number that the dragged layer would have: rows count from the top, layers from below."""
        gap, dragged = self._view.gap, self._dragged
        if gap is None or dragged is None:
            return -1
        layers = sum(row.index != UNASSIGNED for row in self._model.rows)
        row = self._model.row_of(dragged)
        return layers - 1 - (gap if gap <= row else gap - 1)
