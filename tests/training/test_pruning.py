"""Outputs that answer to nothing are left out of the weights, and every answer stays what it was."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from training.pruning import main
from training.silent import with_silent, without_silent

from matchset.image.disc_network.look import STEPS
from matchset.image.disc_network.network import DiscNetwork

WIDTH = 8
SHAPES = {
    "first": (192, WIDTH),
    **dict.fromkeys(STEPS, (5 * WIDTH, WIDTH)),
    "out": (WIDTH, 2),
    "cls": (2 * WIDTH, 1),
}
SILENT = {"a": [1, 6], "c": [0, 2, 3], "d": list(range(WIDTH))}


def weights() -> dict[str, Any]:
    rng, made = np.random.default_rng(3), dict[str, Any]()
    for name, (inputs, outputs) in SHAPES.items():
        made[f"{name}.w"] = rng.normal(0.0, 0.2, (inputs, outputs)).astype(np.float16)
        made[f"{name}.b"] = rng.normal(0.5, 0.1, outputs).astype(np.float16)
    for name, silent in SILENT.items():
        made[f"{name}.b"][silent] = -900.0
    return made


def patches(count: int = 6) -> Any:
    return np.random.default_rng(4).normal(0.0, 0.7, (count, 64, 32, 6)).astype(np.float32)


def test_what_is_silent_is_left_out_and_nothing_answers_otherwise() -> None:
    whole, seen = weights(), patches()
    pruned = without_silent(whole, seen)
    for name in STEPS:
        assert set(SILENT.get(name, ())) <= set(range(WIDTH)) - set(pruned[f"{name}.on"].tolist())
        assert pruned[f"{name}.w"].shape == (5 * WIDTH, len(pruned[f"{name}.on"]))
    before, after = DiscNetwork(whole), DiscNetwork(pruned)
    for patch in seen:
        one, other = before.see(patch), after.see(patch)
        assert one.log_odds == pytest.approx(other.log_odds, abs=1e-6)
        assert one.step == pytest.approx(other.step, abs=1e-6)
        assert one.precision == pytest.approx(other.precision, rel=1e-6)


def test_what_was_left_out_can_be_added_again_and_left_out_again() -> None:
    pruned = without_silent(weights(), patches())
    whole = with_silent(pruned)
    assert {name: each.shape for name, each in whole.items()} == {name: each.shape for name, each in weights().items()}
    again = without_silent(whole, patches())
    assert set(again) == set(pruned)
    assert all(np.array_equal(again[name], pruned[name]) for name in pruned)
    assert with_silent(weights()).keys() == weights().keys()


def test_the_command_prunes_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    np.savez(tmp_path / "examples.npz", patches=patches(), targets=np.zeros((6, 4), np.float32))
    np.savez(tmp_path / "weights.npz", **weights())
    main([tmp_path / "examples.npz"], tmp_path / "out.npz", tmp_path / "weights.npz")
    assert "6 patches; outputs left: " in capsys.readouterr().out
    with np.load(tmp_path / "out.npz") as file:
        assert len(file["d.on"]) == 0
        DiscNetwork({name: file[name] for name in file.files})
