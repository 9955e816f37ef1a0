"""The program comes with the package."""

import signal
import subprocess
import sys
import time

from conftest import CUBES_FILE

PROGRAM = [sys.executable, "-m", "localshape"]


def test_it_is_the_program(program, cubes_file):
    done = subprocess.run([*PROGRAM, "check", cubes_file, "--json"], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and done.stdout == program("check", cubes_file, "--json")
    wrong = subprocess.run([*PROGRAM, "nothing"], capture_output=True, text=True, timeout=120)
    assert wrong.returncode == 2 and "subcommand 'nothing'" in wrong.stderr


def test_it_hears_ctrl_c(tmp_path):
    """It keeps what it has, as the program does."""
    scene = tmp_path / "long.toml"
    scene.write_text(CUBES_FILE.replace("duration = 0.2", "duration = 1e4"))
    words = [*PROGRAM, "simulate", scene, "-o", tmp_path / "out"]
    child = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        while not (tmp_path / "out").exists() and child.poll() is None:
            time.sleep(0.05)
        time.sleep(0.3)
        child.send_signal(signal.SIGINT)
        assert "to go on:" in child.communicate(timeout=120)[0]
        assert child.returncode == 130
    finally:
        child.kill()
        child.wait()
