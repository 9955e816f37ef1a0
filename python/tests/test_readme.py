"""The examples of the README run."""

import pathlib
import re

import numpy as np
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
    assert len(EXAMPLES) == 8
    assert pathlib.Path("fall.gif").read_bytes().startswith(b"GIF89a")
    made = names["localshape"].Scene(body=names["body"], time={"duration": 0.1}, run=[names["model"]])
    assert made.check()["bodies"][0]["element_count"] > 10
    np.testing.assert_allclose(*(names["beside"][name].position for name in ("Mine", "Local shape")), atol=2e-2)
    assert pathlib.Path("frame.pdf").read_bytes().startswith(b"%PDF")
    assert names["position"].ndim == 3 and names["world"].steps == 10
