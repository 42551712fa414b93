"""The section `real` of the results: every clip from one click, from many, and searched without one."""

from collections.abc import Sequence

from benchmarks.options import Options
from benchmarks.real import scores
from benchmarks.real.clips import Clip, find_clips
from benchmarks.real.detection import detection_finding, detection_table
from benchmarks.real.foreign import Tally, count_false_locks, foreign_finding, foreign_table
from benchmarks.real.measure import Measured, measure_all
from benchmarks.results import Finding, Section

TITLE = "Real footage"


def run(options: Options) -> Section:
    """Measure all clips that are there."""
    clips, skipped = find_clips(options.data)
    notes = "".join(f"- {each}\n" for each in skipped)
    if not clips:
        return Section(TITLE, [Finding(name="real", what="; ".join(skipped), figures=())], notes)
    measured = measure_all(clips, options)
    balls = {name: each.ball for name, each in measured.items() if each.ball is not None}
    tallies = count_false_locks(clips, balls, options.data, options)
    findings = [*findings_of(clips, measured), foreign_finding(tallies)]
    return Section(TITLE, findings, text_of(clips, measured) + text_of_foreign(tallies) + notes)


def findings_of(clips: Sequence[Clip], measured: dict[str, Measured]) -> list[Finding]:
    """Hold what was measured against the goals."""
    runs = {name: each.runs for name, each in measured.items()}
    detected = {name: each.detected for name, each in measured.items()}
    return [
        *scores.standard_findings(clips, runs),
        scores.starts_finding(clips, runs),
        scores.covariance_finding(clips, runs),
        detection_finding(clips, detected),
    ]


def text_of(clips: Sequence[Clip], measured: dict[str, Measured]) -> str:
    """Say how it was measured, and what each clip gave."""
    runs = {name: each.runs for name, each in measured.items()}
    detected = {name: each.detected for name, each in measured.items()}
    return (
        "**One click**, half a radius left of the center in the first tight row, then no help to the end. *Valid*: "
        "tight rows answered with |Δx| + |Δy| + |Δr| below 5 px; *lost*: visible rows without an answer; *far*: "
        "answers farther than a radius from the true center. The truth is good to about 0.5 px where sharp, to 1-2 px "
        f"under motion blur.\n\n{scores.standard_table(clips, runs)}\n"
        "**All starts**: nine places on the disc, three tight rows to begin at. *Nothing*: the color was refused, or "
        "never a track; such a start counts with 0 % valid. The second table has the mean *valid* of each click, by "
        f"its place on the disc in radii, and of each frame to begin at.\n\n{scores.starts_table(clips, runs)}\n"
        f"{scores.places_table(clips, runs)}\n"
        "**Radius and covariance** over the standard clicks: eᵀ(P + 0.5² I)⁻¹e with the covariance P of the track and "
        "0.5 px for each number of the label; an honest tracker has 95 % below the quantile where the label is no "
        "worse than that. *Radius error*: r - r*, positive where too large.\n\n"
        f"{scores.covariance_table(clips, runs)}\n"
        "**Search**: `detect` in every other tight row, and in rows without the ball, with the color of the standard "
        "click. *Right*: center on the ball, error below 5 px or a quarter of the radius, of the first answer.\n\n"
        f"{detection_table(clips, detected)}\n"
    )


def text_of_foreign(tallies: Sequence[Tally]) -> str:
    """Say how false locks were counted, and what each color gave."""
    return (
        "**False locks**: a tracker that was told no place seeks the color of one clip in frames of the others, spread "
        "over each, if the balls differ in chroma and in hue, and in videos without "
        f"a ball.\n\n{foreign_table(tallies)}\n"
    )
