"""Links at the top: one per section with an id, in order, by its short name or its heading, as text."""

from reports.page.finished import PLACE, linked


def test_sections_are_linked_in_their_order() -> None:
    page = (f'<nav>{PLACE}</nav><section id="one"><h2>First of <b>all</b></h2></section>'
            '<section class="x"><h2>No id</h2></section>'
            '<section id="two" data-nav="Next">\n<h1>Long words</h1></section><section id="three"><p>no heading</p></section>')
    nav = linked(page).split("</nav>")[0].removeprefix("<nav>")
    assert nav == '<a href="#one">First of all</a> <a href="#two">Next</a> <a href="#three">three</a>'


def test_names_stay_text() -> None:
    page = f'{PLACE}<section id="one" data-nav="a &lt;b&gt; &amp; c"></section>'
    assert linked(page).startswith('<a href="#one">a &lt;b&gt; &amp; c</a>')
