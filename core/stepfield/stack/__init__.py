"""The stack on disk: images, masks and manifest."""

from stepfield.stack.manifest import Manifest
from stepfield.stack.read import Stack
from stepfield.stack.write import write_stack

__all__ = ["Manifest", "Stack", "write_stack"]
