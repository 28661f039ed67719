"""Memory that was freed does not stay with the window."""

from __future__ import annotations

import platform

import psutil
import pytest

from stepfield_app.spare import give_back


@pytest.mark.skipif(
    platform.libc_ver()[0] != "glibc", reason="other libraries give back by themselves, or never"
)
def test_what_was_freed_between_what_is_kept_goes_back_to_the_system() -> None:
    blocks = [bytearray(100_000) for _ in range(1000)]
    kept = blocks[::100]
    before = psutil.Process().memory_info().rss
    del blocks
    give_back()
    assert before - psutil.Process().memory_info().rss > 50_000_000
    assert len(kept) == 10
