import dataclasses
from typing import Annotated

import msgspec
import pytest
import typer
from typer.testing import CliRunner

from matchset.app.cli_options import command_of


class Pen(msgspec.Struct, frozen=True, kw_only=True):
    color: Annotated[str, typer.Option(help="Its ink.")] = "black"
    width: Annotated[float | None, typer.Option(metavar="MM", help="Its width.")] = None
    pen: Annotated[str, typer.Option(help="Its name, as that of its group.")] = "fountain"
    maker: str = "nobody"


@dataclasses.dataclass(frozen=True, kw_only=True)
class LetterOptions:
    to: Annotated[str, typer.Argument(help="Who gets it.")]
    pages: Annotated[int, typer.Option("-n", min=1, help="How long it is.")] = 1
    pen: Pen
    copies: Annotated[list[str] | None, typer.Option("--copy", help="Who else gets it.")] = None


letters: list[LetterOptions] = []


def write(options: LetterOptions) -> int:
    """Write a letter."""
    if options.to == "nobody":
        raise ValueError("a letter needs\n a reader")
    letters.append(options)
    return options.pages


app = typer.Typer(rich_markup_mode=None)
app.command()(command_of(write))


def test_options_arrive_in_one_object() -> None:
    result = CliRunner().invoke(
        app, ["Ann", "-n", "3", "--color", "red", "--pen", "reed", "--copy", "Bob", "--copy", "Cy"]
    )
    assert result.exit_code == 3
    assert letters.pop() == LetterOptions(to="Ann", pages=3, pen=Pen(color="red", pen="reed"), copies=["Bob", "Cy"])


def test_what_is_not_typed_has_the_default_of_its_field() -> None:
    assert CliRunner().invoke(app, ["Ann"]).exit_code == 1
    assert letters.pop() == LetterOptions(to="Ann", pen=Pen())


def test_help_has_every_option_in_the_order_of_the_fields_and_nothing_else() -> None:
    lines = CliRunner().invoke(app, ["--help"]).output
    places = [lines.index(word) for word in ("Write a letter.", "Who gets it.", "-n", "--color", "--width", "--copy")]
    assert places == sorted(places)
    assert "MM" in lines
    assert "maker" not in lines


@pytest.mark.parametrize("words", [["Ann", "-n", "0"], ["Ann", "--maker", "x"], []])
def test_typer_refuses_what_is_wrong(words: list[str]) -> None:
    assert CliRunner().invoke(app, words).exit_code == 2
    assert not letters


def test_an_error_of_the_user_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        command_of(write)(to="nobody", pages=1, color="black", width=None, pen="reed", copies=None)
    assert end.value.code == 2
    assert capsys.readouterr().err == "error: a letter needs a reader\n"
