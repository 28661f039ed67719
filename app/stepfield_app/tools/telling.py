"""What is selected, in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from stepfield_app.wording import counted, grouped


def selected(by_layer: Mapping[int, int], name_of: Callable[[int], str]) -> tuple[str, ...]:
    """Say how many pillars are selected in which layers, the longest wording first.

    Parameters
    ----------
    by_layer : mapping
        Selected pillars of each layer, -1 for those in none.
    name_of : callable
        What a layer is called.
    """
    held = {layer: count for layer, count in sorted(by_layer.items()) if count}
    if not held:
        return ()
    count = sum(held.values())
    briefly = f"{counted(count, 'pillar')} selected"
    ordered = [*(layer for layer in held if layer >= 0), *(layer for layer in held if layer < 0)]
    parts = ", ".join(f"{name_of(layer)}: {grouped(held[layer])}" for layer in ordered)
    return f"{briefly} ({parts})", briefly
