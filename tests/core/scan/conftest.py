"""Damaging files on purpose: whatever a reader is given, it answers with a Cloud or with one sentence."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from stepfield.errors import ScanError
from stepfield.scan.cloud import Cloud, Reader

Damage = Callable[[Reader, str, bytes], None]
Parse = Callable[[Reader, str, bytes], Cloud]


@pytest.fixture
def parse(tmp_path: Path) -> Parse:
    """Write bytes to a file of some name and read it."""

    def write_and_read(read: Reader, name: str, content: bytes) -> Cloud:
        path = tmp_path / name
        path.write_bytes(content)
        return read(path)

    return write_and_read


@pytest.fixture
def survives_damage(parse: Parse) -> Damage:
    """Flip bits of a file and cut it short, many times over, always the same way."""

    def damage(read: Reader, name: str, content: bytes) -> None:
        rng = np.random.default_rng(7)
        for _ in range(100):
            broken = np.frombuffer(content, np.uint8).copy()
            places = rng.integers(0, len(broken), rng.integers(1, 4))
            broken[places] ^= np.uint8(1) << rng.integers(0, 8, len(places)).astype(np.uint8)
            answered(read, name, broken.tobytes())
            answered(read, name, content[: rng.integers(0, len(content))])

    def answered(read: Reader, name: str, content: bytes) -> None:
        cloud = sentence = None
        try:
            cloud = parse(read, name, content)
        except ScanError as error:
            sentence = str(error)
        if cloud is None:
            assert sentence, "a failure must say something"
            assert name in sentence, "the sentence must name the file"
            assert "\n" not in sentence, "the sentence must be one line"
            assert "; " in sentence, "the sentence must say what to do"
        else:
            assert len(cloud) > 0, "a cloud without points must be an error"
            lengths = {len(axis) for axis in cloud.axes} | {len(v) for v in cloud.attributes.values()}
            assert lengths == {len(cloud)}, "every column must be as long as the cloud"

    return damage
