"""What cases are about, told to somebody who meets them for the first time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cmverify.report.summary import CaseResult


@dataclass(frozen=True)
class Topic:
    """A chapter of the report: the cases that carry one of its tags and of no earlier topic."""

    name: str
    title: str
    asks: str
    tags: frozenset[str] = frozenset()


def _topic(name: str, title: str, asks: str, *tags: str) -> Topic:
    return Topic(name, title, asks, frozenset(tags))


#: In the order of the page. A case is in the first whose tags it has one of, or in the last.
TOPICS = (
    _topic("crack-tips", "Crack tips", "Is the field around a crack right, and its stress "
           "intensity?", "crack-tip"),
    _topic("edges", "Edges and holes", "Are displacement and stress right up to free edges, holes "
           "and faces of cracks?", "surface"),
    _topic("growth", "Fracture", "Do cracks begin, grow, turn and meet where and when theory and "
           "experiments say?", "fracture", "kinking", "toughness",
           "sensing"),
    _topic("coupled", "Coupled fields", "Do temperature, current and strain act on each other as "
           "they should?", "thermoelastic", "joule", "piezoresistive"),
    _topic("moving", "Vibrations, waves and heat in time", "Are frequencies, wave speeds, "
           "reflections and the spreading of heat right?", "modes", "waves", "transient"),
    _topic("hard", "Hard cases", "Are extreme solids and damaged bodies solved, or refused by "
           "name?", "hard"),
    _topic("conduction", "Heat and current", "Is steady conduction in anisotropic bodies right?",
           "disc", "electrical"),
    _topic("trusted", "What judges the rest", "Are closed forms, stored tables, norms and orders "
           "themselves right?", "references", "judges", "counts"),
    _topic("solids", "Solids", "Do the bonds' sums make up the solid that was asked for?"),
)  # fmt: skip


def topic_of(tags: Sequence[str]) -> Topic:
    """The topic of a case with these tags."""
    return next((t for t in TOPICS if t.tags & set(tags)), TOPICS[-1])


def by_topic(summary: Sequence[CaseResult]) -> list[tuple[Topic, list[CaseResult]]]:
    """The topics that a run has cases of, with them; cases keep their order."""
    groups = [(t, [r for r in summary if topic_of(r.case.tags) is t]) for t in TOPICS]
    return [(topic, own) for topic, own in groups if own]
