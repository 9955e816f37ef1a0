"""The examples of the README run."""

import pathlib
import re

import pytest
from conftest import ROOT

README = (ROOT / "python/README.md").read_text()
EXAMPLES = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


@pytest.fixture(autouse=True)
def in_a_copy(tmp_path, monkeypatch):
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)


def test_examples():
    names = {}
    for example in EXAMPLES:
        exec(example, names)
    assert len(EXAMPLES) == 4
    assert pathlib.Path("frame.pdf").read_bytes().startswith(b"%PDF")
    assert names["position"].ndim == 3 and names["world"].time >= 1.0
