"""On narrow screens rows become cards: every cell knows the heading of its column, across spans, and nothing else changes."""

import re

from reports.page.finished import labelled

HEAD = ('<thead><tr><th scope="col">scene</th><th scope="col">a <svg><text>x</text></svg>b</th>'
        '<th>c<small>note</small></th></tr></thead>')


def labels(page: str) -> list[str]:
    return re.findall(r'data-label="([^"]*)"', page)


def test_cells_learn_their_headings() -> None:
    table = f"<table>{HEAD}<tbody><tr><th>s</th><td class=\"n\">1</td><td>2</td></tr></tbody></table>"
    made = labelled(table)
    assert labels(made) == ["scene", "a b", "c"]
    assert re.sub(r' data-label="[^"]*"', "", made) == table


def test_spans_are_counted() -> None:
    table = (f'<table>{HEAD}<tbody><tr><th rowspan="2">s</th><td>1</td><td>2</td></tr><tr><td>3</td><td>4</td></tr>'
             '<tr><th>t</th><td colspan="2">nothing</td></tr><tr><th>u</th><td>5</td><td>6</td></tr></tbody></table>')
    assert labels(labelled(table)) == ["scene", "a b", "c", "a b", "c", "scene", "scene", "a b", "c"]


def test_a_heading_that_spans_names_all_its_columns() -> None:
    head = '<thead><tr><th>s</th><th colspan="2">both</th></tr></thead>'
    assert labels(labelled(f"<table>{head}<tr><td>1</td><td>2</td><td>3</td></tr></table>")) == ["s", "both", "both"]


def test_tables_without_a_heading_and_scripts_stay() -> None:
    page = f"<table><tr><td>1</td></tr></table><script>'<table>{HEAD}<tr><td>1</td></tr></table>'</script>"
    assert labelled(page) == page


def test_headings_stay_text() -> None:
    page = "<table><thead><tr><th>a &quot;b&quot; &lt;c&gt;</th></tr></thead><tr><td>1</td></tr></table>"
    assert labels(labelled(page)) == ["a &quot;b&quot; &lt;c&gt;"]
