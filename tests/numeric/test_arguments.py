"""Checks of parameters name the field, what it must be, and what it is."""

import math

import msgspec
import pytest

from matchset.numeric.arguments import require_at_least, require_not_negative, require_positive, require_within


class Numbers(msgspec.Struct):
    """What is checked."""

    low: float = 0.0
    high: float = 8.0


@pytest.mark.parametrize(
    ("number", "words"),
    [(-0.5, "low must be within 0 ... 8, got -0.5"), (math.nan, "low must be within 0 ... 8, got nan")],
)
def test_a_number_beyond_its_limits_is_refused_in_words(number: float, words: str) -> None:
    limits = {"low": (0.0, 8.0), "high": (0.0, 8.0)}
    require_within(Numbers(), limits)
    with pytest.raises(ValueError, match=f"^{words}$"):
        require_within(Numbers(low=number), limits)
    with pytest.raises(ValueError, match=r"^high of a clip lies in 0 \.\.\. 8, got 9\.0$"):
        require_within(Numbers(high=9.0), limits, "of a clip lies in")


def test_a_number_that_is_too_small_is_refused_in_words() -> None:
    require_at_least(Numbers(), 0, "low", "high")
    with pytest.raises(ValueError, match=r"^low must be 1 or more, got 0\.0$"):
        require_at_least(Numbers(), 1, "high", "low")
    with pytest.raises(ValueError, match=r"^low must be positive, got 0\.0$"):
        require_positive(Numbers(), ("high", "low"))
    with pytest.raises(ValueError, match=r"^high must be zero or positive, got inf$"):
        require_not_negative(Numbers(high=math.inf), ("low", "high"))
