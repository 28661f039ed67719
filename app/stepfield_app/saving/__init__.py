"""Saving: a project goes to its file whole, on a thread of its own, and never over somebody else's work."""

from stepfield_app.saving.saving import Saving
from stepfield_app.saving.watch import FileWatch
from stepfield_app.saving.write import ChangedByAnother

__all__ = ["ChangedByAnother", "FileWatch", "Saving"]
