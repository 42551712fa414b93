"""A key that tests of sharing have for themselves, and a share under it."""

import secrets
from collections.abc import Iterator

import pytest

import matchset as ms


@pytest.fixture
def key() -> str:
    """A key that no other test has: all meet at the same port."""
    return f"test/{secrets.token_hex(8)}"


@pytest.fixture
def share(key: str) -> Iterator[ms.Share]:
    with ms.Share("me", key=key) as made:
        yield made
