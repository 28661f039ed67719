"""JSON files of the project's own: they say their format and version, and a bad one is one sentence."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar, Self

from pydantic import ValidationError

from stepfield.errors import StepfieldError
from stepfield.files import read_json
from stepfield.parameters import Frozen
from stepfield.validation import explain


class Document(Frozen):
    """Base of what is written to a file whole. Members set ``format`` and ``version`` as fields."""

    #: What the file is, for sentences.
    what: ClassVar[str]
    #: What is raised when it cannot be used.
    failure: ClassVar[type[StepfieldError]]
    #: What to do about a damaged one.
    remedy: ClassVar[str]

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a document, raising its failure in one sentence if it cannot be used."""
        document = read_json(path, cls.failure, cls.what)
        if not isinstance(document, dict) or document.get("format") != cls._default("format"):
            raise cls.failure(f"{path}: not a {cls.what} of Stepfield; name one made by Stepfield")
        version, known = document.get("version"), cls._default("version")
        if isinstance(version, int) and version > known:
            raise cls.failure(
                f"{path}: a {cls.what} made by a newer Stepfield (version {version}, this one reads up to "
                f"{known}); update Stepfield"
            )
        try:
            return cls.model_validate(document)
        except ValidationError as error:
            raise cls.failure(f"{path}: damaged {cls.what}, {explain(error)}; {cls.remedy}") from None

    @classmethod
    def _default(cls, field: str) -> Any:
        return cls.model_fields[field].default
