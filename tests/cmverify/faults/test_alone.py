"""Faults that one case alone catches: counted, listed with a reason, more than half seen by two."""

from cmverify.faults import alone, page, registry, table
from cmverify.faults.changes import scaled
from cmverify.faults.fault import Fault
from cmverify.faults.trial import Found

NORM = "cmverify.judge.norms.relative_l2"


def test_what_one_case_alone_catches_is_said_with_the_reason(tmp_path, monkeypatch):
    def caught(name, *cases):
        found = tuple(Found(case, "m", "q", True, True) for case in cases)
        return table.Result(Fault(name, NORM, scaled(2.0), "norms"), found)

    monkeypatch.setattr(alone, "ALONE", {"because of this": ("two",)})
    results = [caught("one", "a", "b"), caught("two", "a"), caught("three", "b")]
    tally = alone.Tally.of(results)
    assert (tally.total, tally.caught, tally.twice, tally.argued) == (3, 3, 1, 0)
    assert tally.groups == {"because of this": [results[1]], alone.UNKNOWN: [results[2]]}
    assert tally.sentence(once=False) == (
        "3 of 3 faults are caught, 1 of them by two cases or more."
    )
    text = page.write(results, "cmverify faults", tmp_path).read_text()
    assert "Because of this (1):" in text
    assert "by two cases" in text
    assert "by two cases" not in page.write(results, "", tmp_path, once=True).read_text()


def test_reasons_are_given_for_faults_that_one_case_of_the_map_catches():
    known = table.read_map()
    single = {
        f.name for f in registry.all_faults()
        if not f.harmless and len({case for case, _ in known.get(f.name, ())}) < 2
    }  # fmt: skip
    argued = [name for faults in alone.ALONE.values() for name in faults]
    assert len(argued) == len(set(argued))
    assert set(argued) <= single
    # Those of a new case may wait for the next search.
    assert len(single - set(argued)) <= 5
    assert 2 * len(single) < len(registry.all_faults())
