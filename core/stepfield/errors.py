"""The errors a user can meet: each message is one sentence saying what, where and what to do."""


class StepfieldError(Exception):
    """Base of every expected failure; ``str(error)`` is the sentence shown to the user."""


class ScanError(StepfieldError):
    """A scan cannot be read, or holds nothing to work on."""


class ParameterError(StepfieldError):
    """A parameter is impossible in itself (the command exits with 2)."""


class GridError(StepfieldError):
    """The cell size makes a grid too large to be meant."""


class StackError(StepfieldError):
    """A stack of height-maps cannot be written, or is not whole."""


class TargetError(StepfieldError):
    """A simulator's files cannot hold a stack, or not as asked."""


class SimulationError(StepfieldError):
    """A robot cannot be driven: no MuJoCo, no ground to start on, no mesh."""


class ProjectError(StepfieldError):
    """A project file cannot be read or written."""


class SceneError(StepfieldError):
    """A synthetic scene is unknown or wrongly described."""


class Cancelled(StepfieldError):
    """The caller's progress callback asked to stop."""

    def __init__(self, message: str = "stopped on request; nothing was written") -> None:
        super().__init__(message)
