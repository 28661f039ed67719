"""Recovery: edits nobody has saved are kept beside the program, and offered when it ended without leave."""

from stepfield_app.recovery.drafts import Draft
from stepfield_app.recovery.recovery import Recovery

__all__ = ["Draft", "Recovery"]
