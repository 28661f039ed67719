"""What the operator wants done with pillars and layers, turned into edits of the document."""

from stepfield_app.editor.editor import Editor, Target
from stepfield_app.editor.situation import PILLARS_MIME, REST, Conflict

__all__ = ["PILLARS_MIME", "REST", "Conflict", "Editor", "Target"]
