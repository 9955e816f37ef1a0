"""The stubs are true, and a program that uses the package is typed."""

import subprocess
import sys


def test_stubs():
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "localshape"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_typed_program(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(
        "import localshape\n"
        "scene = localshape.Scene.load('a.toml')\n"
        "end = float(scene.simulate(runs=['a'])['a'].position[-1, 0, 2])\n"
        "text: str = scene.simulate().frame(0.5).png()\n"
    )
    words = [sys.executable, "-m", "mypy", "--strict", str(program)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300, cwd=tmp_path)
    assert done.stdout.count("error:") == 1 and 'has type "bytes", variable has type "str"' in done.stdout, done.stdout
