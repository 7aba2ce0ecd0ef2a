"""The chapters of the course that are in Python print what they say."""

import doctest

import pytest
from conftest import ROOT

CHAPTERS = sorted((ROOT / "docs" / "course").glob("python*.md"))


def test_there_are_chapters():
    assert {chapter.stem for chapter in CHAPTERS} >= {"python", "python-material", "python-light"}


@pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda chapter: chapter.stem)
def test_the_chapter_prints_what_it_says(chapter, monkeypatch):
    monkeypatch.chdir(ROOT)
    # The end of a block of code is no output.
    text = chapter.read_text(encoding="utf-8").replace("```python\n", "\n").replace("```\n", "\n")
    examples = doctest.DocTestParser().get_doctest(text, {}, chapter.name, str(chapter), 0)
    report = []
    result = doctest.DocTestRunner().run(examples, out=report.append)
    assert result.attempted > 20
    assert result.failed == 0, "".join(report)
