"""Every case has one topic."""

from cmverify.cases import registry
from cmverify.report import summary
from cmverify.report.topics import TOPICS, by_topic, topic_of


def test_every_case_is_in_one_topic_and_every_topic_has_cases():
    cases = registry.all_cases()
    results = [summary.CaseResult(case, (), (), ()) for case in cases]
    groups = by_topic(results)
    assert [topic for topic, _ in groups] == list(TOPICS)
    assert sorted(r.case.name for _, own in groups for r in own) == sorted(c.name for c in cases)


def test_the_rest_is_about_solids():
    assert topic_of(("unheard of",)) is TOPICS[-1]
    assert len({topic.name for topic in TOPICS}) == len(TOPICS)
