"""States of unfinished measurements: whose they are, and when they go."""

from cmverify.run import unfinished


def test_a_place_is_known_inside_the_block_and_goes_with_it(tmp_path):
    assert unfinished.place() is None
    mine = unfinished.folder(tmp_path / "case" / "0010", "0123456789abcdef")
    with unfinished.kept_in(mine):
        assert unfinished.place() == mine
        (mine / "state").write_text("here")
    assert unfinished.place() is None
    assert not mine.exists()


def test_what_is_left_by_a_killed_block_stays_and_other_codes_states_are_discarded(tmp_path):
    stem = tmp_path / "0010"
    mine, other = (unfinished.folder(stem, code * 20) for code in "ab")
    neighbour = unfinished.folder(tmp_path / "0100", "b" * 20)
    for place in (mine, other, neighbour):
        place.mkdir()
    try:
        with unfinished.kept_in(mine):
            raise KeyboardInterrupt
    except KeyboardInterrupt:
        pass
    assert mine.exists()
    unfinished.discard(stem, but=mine)
    assert mine.exists()
    assert not other.exists()
    assert neighbour.exists()
    unfinished.discard(stem)
    assert not mine.exists()
