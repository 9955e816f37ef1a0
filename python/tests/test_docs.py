"""The pieces of scene files in the documentation are accepted by the program."""

import re
import shutil
import subprocess

import pytest
from conftest import PROGRAM, ROOT

PIECES = [
    pytest.param(code, id=f"{page.stem}-{at}")
    for page in sorted((ROOT / "docs").glob("*.md"))
    for at, code in enumerate(re.findall(r"^```toml\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE))
    if "[sheet]" not in code
]

#: What a piece leaves out, with the names that the pages use.
REST = {
    "gravity": "gravity = [0, -9.8, 0]",
    "time": "time = { duration = 1 }",
    "body": """body = [
        { name = "beam", lattice = { cells = [3, 3, 3], side = 0.1 }, lowest = 0.5 },
        { name = "cloth", lattice = { cells = [3, 3, 3], side = 0.1 }, lowest = 1.5 },
    ]""",
    "obstacle": """obstacle = [
        { kind = "floor" },
        { kind = "plate", name = "press", point = [0, 3, 0], normal = [0, -1, 0], path.keys = [
            { time = 0.1 },
            { time = 1, shift = [0, -0.1, 0] },
        ] },
        { kind = "sphere", name = "ball", centre = [2, 1, 0], radius = 0.1 },
    ]""",
    "hold": 'hold = [{ nodes = "left" }]',
    "run": 'run = [{ name = "One", model = { kind = "shape-based", stiffness = 1e4 } }]',
}


@pytest.mark.parametrize("piece", PIECES)
def test_piece(piece, tmp_path):
    top, *tables = re.split(r"^(?=\[)", piece, flags=re.MULTILINE)
    keys = re.findall(r"^(\w+) *=", top, re.MULTILINE) + [re.match(r"\[+(\w+)", table)[1] for table in tables]
    is_whole = {"body", "run"} <= set(keys)
    rest = [] if is_whole else [text for key, text in REST.items() if key not in keys]
    shutil.copy(ROOT / "scenes/hare.ply", tmp_path)
    (tmp_path / "piece.toml").write_text("\n".join([*rest, piece]))
    done = subprocess.run([PROGRAM, "check", tmp_path / "piece.toml"], capture_output=True, text=True, timeout=60)
    # Pieces of tables stand alone in pages, and recordings are made by their readers.
    errors = re.split(r"^(?=error: |/\S+:\d+:\d+: |warning: )", done.stderr, flags=re.MULTILINE)
    errors = [error for error in errors if error and not re.search("` belongs to `|is not there", error)]
    assert done.returncode == 0 or not errors, done.stderr
