"""The chapter of the course that is in Python prints what it says."""

import doctest

from conftest import ROOT

CHAPTER = ROOT / "docs" / "course" / "python.md"


def test_the_chapter_in_python(monkeypatch):
    monkeypatch.chdir(ROOT)
    # The end of a block of code is no output.
    text = CHAPTER.read_text(encoding="utf-8").replace("```python\n", "\n").replace("```\n", "\n")
    chapter = doctest.DocTestParser().get_doctest(text, {}, CHAPTER.name, str(CHAPTER), 0)
    report = []
    result = doctest.DocTestRunner().run(chapter, out=report.append)
    assert result.attempted > 20
    assert result.failed == 0, "".join(report)
