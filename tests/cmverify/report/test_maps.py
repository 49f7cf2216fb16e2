"""Maps of fields: made once, filled anew, the same bytes whatever was drawn before."""

import numpy as np

from cmverify.case import Field, FieldSet
from cmverify.report import maps
from cmverify.report.picture import Picture


def square(n, scale, unit="m", spike=False):
    """A field on a lattice of n by n, its reference off by one per cent."""
    x, y = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n)
    points = np.column_stack([x.ravel(), y.ravel()])
    values = scale * (points[:, 0] - 0.3)
    if spike:
        values[0] = -50.0 * scale
    item = Field("$u_1$", unit, values, 1.01 * scale * (points[:, 0] - 0.3))
    return FieldSet(points, {"u1": item}, spacing=1 / n), item


def triangles():
    points = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    item = Field("$T$", "K", points[:, 0], points[:, 0])
    return FieldSet(points, {"t": item}, triangles=np.array([[0, 1, 2], [0, 2, 3]])), item


def png(fields, item):
    return Picture.drawn("f", "png", maps.field_panels(fields, item), "", "").content


def test_a_map_does_not_depend_on_what_was_drawn_before():
    first = png(*square(6, 1.0))
    png(*triangles())
    png(*square(9, 1e-7, spike=True))
    assert png(*square(6, 1.0)) == first


def test_pixels_colours_and_numbers_are_the_fields():
    fields, item = square(4, 2e-5, spike=True)
    figure = maps.field_panels(fields, item)
    panels = [axis for axis in figure.axes if axis.get_title()]
    assert [axis.get_title() for axis in panels] == list(maps._TITLES)
    image = panels[0].images[0]
    np.testing.assert_array_equal(image.get_array()[1], item.computed[4:8])
    low, high = np.percentile(item.reference, [0.5, 99.5])
    assert image.get_clim() == panels[1].images[0].get_clim() == (low, high)
    below, above = panels[2].images[0].get_clim()
    assert below == -above
    bars = [axis for axis in figure.axes if not axis.get_title()]
    # Ticks lie where their numbers belong, in the power of ten that the label names.
    for place, label in zip(bars[0].get_yticks(), bars[0].get_yticklabels(), strict=True):
        value = float(label.get_text()) * 1e-5
        np.testing.assert_allclose(low + place * (high - low), value, atol=1e-3 * (high - low))
    assert bars[0].get_ylabel() == "$u_1$ (1e-5 m)"
    assert bars[2].get_ylabel().startswith("Δ $u_1$")
    # The spike lies below the scale: its arrow says so.
    assert [arrow.get_visible() for arrow in bars[0].patches] == [True, False]
    assert len(maps.field_panels(*triangles()).axes[0].collections) == 1


def test_a_field_that_is_the_same_everywhere_is_drawn():
    fields, item = square(3, 0.0)
    assert png(fields, item).startswith(b"\x89PNG")
