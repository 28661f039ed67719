"""One sentence out of a pydantic error: what is wrong, where, and what was found instead."""

from pydantic import ValidationError


def explain(error: ValidationError) -> str:
    """Describe the first problem of ``error`` as ``place: problem (found value)``."""
    first = error.errors(include_url=False)[0]
    place = ".".join(str(step) for step in first["loc"] if _is_field(step)) or "the whole"
    problem = first["msg"].removeprefix("Value error, ")
    more = error.error_count() - 1
    also = f", and {more} more" if more and first["type"] == "extra_forbidden" else ""
    return f"{place}: {problem[:1].lower() + problem[1:]} (found {_short(first['input'])}{also})"


def _is_field(step: int | str) -> bool:
    """Tell a field or position from the tags pydantic adds for the members of a union."""
    return isinstance(step, int) or (step.isidentifier() and step not in {"float", "int", "str"})


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
