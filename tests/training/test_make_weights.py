"""One command makes weights from nothing, and the same ones again."""

from pathlib import Path

import cv2
import numpy as np
import pytest

pytest.importorskip("torch")

import typer
from training.__main__ import RecipeParameters, main, make_weights
from training.rendering.photographs import read_photographs
from training.shipped import SHIPPED, checksum
from training.train import LearningParameters, NetworkParameters

from matchset.image.disc_network.network import FILE, DiscNetwork

SMALL = RecipeParameters(
    scenes=12,
    steps=6,
    pruning_scenes=4,
    learning=LearningParameters(network=NetworkParameters(width=12), batch=16, first_steps=2),
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    pictures = tmp_path / "photographs"
    pictures.mkdir()
    random = np.random.default_rng(5)
    for index in range(3):
        coarse = random.integers(0, 256, (30, 40, 3), dtype=np.uint8)
        cv2.imwrite(str(pictures / f"{index}.png"), cv2.resize(coarse, (1000, 800), interpolation=cv2.INTER_CUBIC))
    return pictures


def test_the_same_photographs_and_seeds_give_the_same_weights(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    photographs, made = read_photographs([folder]), []
    for name in ("one", "again"):
        out = tmp_path / f"{name}.npz"
        make_weights(photographs, out, SMALL)
        made.append(checksum(out))
    said = capsys.readouterr().out
    assert made[0] == made[1] != SHIPPED
    assert said.count(made[0]) == said.count(SHIPPED) == 2
    with np.load(tmp_path / "one.npz") as file:
        DiscNetwork({name: file[name] for name in file.files})


def test_it_goes_on_from_the_weights_that_ship(folder: Path, tmp_path: Path) -> None:
    recipe = RecipeParameters(scenes=12, steps=1, pruning_scenes=4, learning=LearningParameters(batch=16))
    make_weights(read_photographs([folder]), tmp_path / "next.npz", recipe, FILE)
    with np.load(tmp_path / "next.npz") as new, np.load(FILE) as before:
        assert np.abs(new["out.w"] - before["out.w"]).max() < 0.01


def test_the_weights_that_ship_are_not_written_over(folder: Path) -> None:
    with pytest.raises(typer.BadParameter, match="beside those that ship"):
        main([folder], FILE)
    assert checksum(FILE) == SHIPPED
