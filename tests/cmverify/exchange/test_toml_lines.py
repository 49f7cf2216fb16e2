"""Lines of keys, also where TOML is written in its stranger ways."""

import tomllib

import pytest

from cmverify.exchange.toml_lines import Lines

TEXT = '''\
# [not] a header
title = """first [line]
second = line"""
a.b = 1

[one]
"quoted key" = [  # a comment ]
  [1, 2],
  ["]", 'x[', """
  ]"""],
]
after = {inner = 1}

[[many]]
x = 1
[many.sub]
y = 2
[[many]]

x = 3
'lit.eral' = 4
'''


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("title",), 2),
        (("a", "b"), 4),
        (("one",), 6),
        (("one", "quoted key"), 7),
        (("one", "quoted key", 1), 7),
        (("one", "after"), 12),
        (("one", "after", "inner"), 12),
        (("many",), 14),
        (("many", 0, "x"), 15),
        (("many", 0, "sub", "y"), 17),
        (("many", 1), 18),
        (("many", 1, "x"), 20),
        (("many", 1, "lit.eral"), 21),
        (("one", "missing"), 6),
        (("nowhere",), None),
    ],
)
def test_every_key_has_its_line(path, line):
    tomllib.loads(TEXT)
    assert Lines(TEXT).line(path) == line


def test_windows_line_ends_count_once():
    assert Lines(TEXT.replace("\n", "\r\n")).line(("one", "after")) == 12
