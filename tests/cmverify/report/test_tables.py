"""No figure is lost or shown twice, whatever its table looks like."""

import math

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cmverify.case import Failed
from cmverify.report.summary import Row
from cmverify.report.tables import WITHOUT_COST, blocks

NAMES = [f"q{i}" for i in range(16)]


@st.composite
def tables(draw):
    rows = []
    for k in range(draw(st.integers(1, 6))):
        mask = draw(st.integers(0, 2 ** len(NAMES) - 1))
        own = [name for i, name in enumerate(NAMES) if mask >> i & 1]
        failure = draw(st.sampled_from([None, None, None, Failed("E", "m")]))
        seconds = draw(st.sampled_from([0.0, 1.0]))
        quantities = {} if failure else dict.fromkeys(own, 1.0)
        total = math.nan if failure else seconds
        rows.append(Row(f"m{k}", "bond", 10, 1, quantities, {}, {}, total, {}, failure))
    return rows, [q for q in NAMES if any(q in row.quantities for row in rows)]


@settings(max_examples=50, suppress_health_check=[HealthCheck.too_slow], deadline=None)
@given(tables())
def test_every_figure_stands_in_one_table(given_):
    rows, quantities = given_
    found = blocks(rows, quantities)
    shown = [q for block in found for q in block.quantities]
    assert shown == quantities
    assert all(row in found[0].rows for row in rows)  # crashed ones too
    for block in found:
        assert block.shape == "long" or len(block.quantities) <= WITHOUT_COST
        for row in rows:
            if any(q in row.quantities for q in block.quantities):
                assert row in block.rows
    assert any(b.cost for b in found) == any(row.total > 0 for row in rows)
