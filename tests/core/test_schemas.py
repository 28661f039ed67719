"""The schemas that ship are those of the code: a simulator's author writes against them."""

import json
from pathlib import Path
from typing import Literal

import pytest
from pydantic import BaseModel

import stepfield_resources
from stepfield.project import Project
from stepfield.stack import Manifest
from stepfield.synth.description import Description

FOLDER = Path(stepfield_resources.__file__).parent / "schemas"
MODELS: dict[Literal["stack", "project", "scene"], type[BaseModel]] = {
    "stack": Manifest,
    "project": Project,
    "scene": Description,
}


def text(name: Literal["stack", "project", "scene"]) -> str:
    """Return the schema as the file must hold it."""
    made = MODELS[name].model_json_schema(mode="serialization")
    return json.dumps({"$schema": "https://json-schema.org/draft/2020-12/schema"} | made, indent=1) + "\n"


@pytest.mark.parametrize("name", list(MODELS))
def test_the_schema_is_up_to_date(name: Literal["stack", "project", "scene"]) -> None:
    """Run this file as a program to write the schemas anew."""
    assert (FOLDER / f"{name}.schema.json").read_text() == text(name)


if __name__ == "__main__":
    for each in MODELS:
        (FOLDER / f"{each}.schema.json").write_text(text(each))
