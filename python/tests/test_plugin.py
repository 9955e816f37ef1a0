"""Goldens in pytest."""

import json
import sys
import textwrap

import pytest
from conftest import CUBES, CUBES_FILE, TRIANGLE

pytest_plugins = ["pytester"]

KEYS = {"body": {"polygon": {"sides": 5, "radius": 1.0}, "velocity": [0, -1]}, "gravity": [0, -9.8], **TRIANGLE}
#: A test of a scene in the plane, whose pictures need no device.
TEST = f"""
import pytest
from localshape import Scene

def scene(**settings):
    made = Scene(**{KEYS!r})
    for key, value in settings.items():
        made.set(key.replace("__", "."), value)
    return made

@pytest.mark.localshape
def test_one():
    return scene()
"""


def told(result):
    return "\n".join(result.outlines)


def write(pytester, text):
    pytester.makepyfile(test_drop=textwrap.dedent(text))


def run(pytester, *words):
    return pytester.runpytest("-p", "no:cacheprovider", "-rs", *words)


@pytest.fixture(autouse=True)
def nothing_compiled(monkeypatch):
    """A module that is written twice in a second would be taken for the first one."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)


def test_a_golden_is_made_compared_and_renewed(pytester):
    write(pytester, TEST)
    folder = pytester.path / "goldens/test_drop/test_one"
    missing = run(pytester)
    missing.assert_outcomes(failed=1)
    assert f"the golden {folder} is missing" in told(missing)
    assert "make it with: pytest test_drop.py::test_one --localshape-bless" in told(missing) and not folder.exists()
    made = run(pytester, "--localshape-bless")
    made.assert_outcomes(passed=1)
    names = ["frame_00000.png", "frame_00001.png", "frame_00002.png", "golden.toml"]
    assert sorted(path.name for path in folder.iterdir()) == names
    assert f"test_drop.py::test_one: accepted {folder / 'golden.toml'}" in told(made)
    run(pytester).assert_outcomes(passed=1)

    stiffer = TEST.replace("'stiffness': 1000.0", "'stiffness': 2000.0")
    write(pytester, stiffer)
    moved = run(pytester)
    moved.assert_outcomes(failed=1)
    for line in ["*state moved: One, first at frame 1: node * by * mm*", "*changed: run[[]0[]].model.stiffness: 1000 → 2000*"]:
        moved.stdout.fnmatch_lines([line])
    assert "frame_00002.png: state moved: One" in told(moved)
    assert "accept with: pytest test_drop.py::test_one --localshape-bless" in told(moved)
    renewed = run(pytester, "--localshape-bless")
    renewed.assert_outcomes(passed=1)
    assert "test_drop.py::test_one: accepted: state moved: One" in told(renewed)
    run(pytester).assert_outcomes(passed=1)

    write(pytester, stiffer.replace("return scene()", "return scene(view__show=['surfaces'])"))
    drawn = run(pytester)
    drawn.assert_outcomes(failed=1)
    assert "drawn differently: " in told(drawn) and "state moved" not in told(drawn)


def test_its_goldens_and_verdicts_are_those_of_the_program(pytester, program):
    """Each accepts the golden of the other one, with lit bodies, of a file and of keys."""
    (pytester.path / "cubes.toml").write_text(CUBES_FILE)
    text = f"""
    import pytest
    from localshape import Scene

    @pytest.mark.localshape(name="cubes")
    def test_file():
        return Scene.load("cubes.toml")

    @pytest.mark.localshape("others", "keys")
    def test_keys():
        return Scene(**{CUBES!r}).simulate()
    """
    write(pytester, text)
    scene, goldens = pytester.path / "cubes.toml", pytester.path / "goldens/cubes"
    program("compare", "--bless", goldens, scene)
    result = run(pytester, "test_drop.py::test_file")
    result.assert_outcomes(passed=1)
    run(pytester, "--localshape-bless", "test_drop.py::test_keys").assert_outcomes(passed=1)
    keys = pytester.path / "others/keys"
    by_program = json.loads(program("compare", keys, scene, "--json"))
    assert by_program["verdict"] == "identical" and len(by_program["pictures"]) == 3
    for name in ("frame_00001.png", "frame_00004.png"):
        assert (keys / name).read_bytes() == (goldens / name).read_bytes()


def test_some_runs_and_a_damaged_golden(pytester):
    write(pytester, TEST.replace("return scene()", f"return Scene(**{CUBES!r}).simulate(runs=['Springs'])"))
    run(pytester, "--localshape-bless").assert_outcomes(passed=1)
    run(pytester).assert_outcomes(passed=1)
    record = pytester.path / "goldens/test_drop/test_one/golden.toml"
    assert 'runs = ["Springs"]' in record.read_text()
    record.write_text("format = 1")
    damaged = run(pytester)
    damaged.assert_outcomes(failed=1)
    assert f"{record} cannot be read: " in told(damaged) and "Traceback" not in told(damaged)
    run(pytester, "--localshape-bless").assert_outcomes(passed=1)
    write(pytester, TEST.replace("return scene()", f"return Scene(**{CUBES!r})"))
    more = run(pytester)
    more.assert_outcomes(failed=1)
    assert "state moved: Local shape is new" in told(more)


@pytest.mark.parametrize("workers", [(), ("-n", "2")])
def test_reports(pytester, workers):
    """A page for each test, and one of all, in this process and in several."""
    several = """
    @pytest.mark.localshape
    @pytest.mark.parametrize("speed", [1.5, 2.5])
    def test_speeds(speed):
        return scene(body__velocity=[speed, 0])
    """
    write(pytester, TEST + textwrap.dedent(several))
    run(pytester, "--localshape-bless", *workers).assert_outcomes(passed=3)
    write(pytester, TEST + textwrap.dedent(several).replace("[speed, 0]", "[min(speed, 2.0), 0]"))
    result = run(pytester, "--localshape-report=report/of/all", *workers)
    result.assert_outcomes(passed=2, failed=1)
    report = pytester.path / "report/of/all"
    page = report / "test_drop/test_speeds_2.5.html"
    assert f"see {page}" in told(result) and f"pages of goldens: {report / 'index.html'}" in told(result)
    assert page.read_text().startswith("<!doctype html>") and "state moved" in page.read_text()
    html = (report / "index.html").read_text()
    assert "1 of 3 not as expected" in html
    links = ['<a href="test_drop/test_speeds_2.5.html', '<a href="test_drop/test_one.html', '<a href="test_drop/test_speeds_1.5.html']
    assert html.count("<tr class=") == 3 and [html.index(link) for link in links] == sorted(html.index(link) for link in links)
    assert "changed: body.velocity: [2.5, 0] → [2, 0]" in html
    run(pytester, "--localshape-report=report/of/all", "-k", "one").assert_outcomes(passed=1)
    assert "1 as expected" in (report / "index.html").read_text()


def test_a_second_place_for_goldens(pytester):
    write(pytester, TEST)
    made = run(pytester, "--localshape-generate-path=made")
    made.assert_outcomes(skipped=1)
    folder = pytester.path / "made/test_drop/test_one"
    assert (folder / "golden.toml").exists() and not (pytester.path / "goldens").exists()
    assert f"its golden was made in {folder}" in told(made)
    both = run(pytester, "--localshape-generate-path=made", "--localshape-bless")
    assert both.ret == pytest.ExitCode.USAGE_ERROR and "leave it out" in "\n".join(both.errlines)


def test_wrong_tests(pytester):
    wrong = """
    import unittest

    @pytest.mark.localshape
    def test_number():
        return 3

    @pytest.mark.localshape
    def test_nothing():
        scene()

    @pytest.mark.localshape(label="x")
    def test_key():
        return scene()

    @pytest.mark.localshape(name="same")
    @pytest.mark.parametrize("speed", [1, 2])
    def test_same(speed):
        return scene()

    @pytest.mark.localshape
    class TestCase(unittest.TestCase):
        def test_method(self):
            return scene()

    @pytest.mark.localshape
    def test_error():
        raise RuntimeError("its own")

    class TestClass:
        @pytest.mark.localshape
        def test_method(self, tmp_path):
            assert tmp_path
            return scene()

    def test_other():
        pass
    """
    write(pytester, TEST + textwrap.dedent(wrong))
    result = run(pytester, "--localshape-bless")
    # Methods of unittest are refused before they run.
    result.assert_outcomes(failed=5, errors=1, passed=4)
    words = told(result)
    for line in [
        "the test returned 3; expected a localshape.Scene or localshape.Result",
        "the test returned None; expected a localshape.Scene",
        "localshape() got an unexpected keyword argument 'label'",
        f"the golden {pytester.path / 'goldens/same'} is that of test_drop.py::test_same[1], too",
        "unittest drops what its tests return",
        "RuntimeError: its own",
    ]:
        assert line in words, line
    assert (pytester.path / "goldens/test_drop/TestClass.test_method/golden.toml").exists()


def test_folders_that_hold_something_else(pytester):
    write(pytester, TEST)
    (pytester.path / "file").write_text("")
    (pytester.path / "site").mkdir()
    (pytester.path / "site/index.html").write_text("<!doctype html><title>another page</title>")
    for words, said in [
        ("--localshape-report=file", "is no folder"),
        ("--localshape-generate-path=file", "is no folder"),
        ("--localshape-report=site", "is not a page of localshape"),
    ]:
        result = run(pytester, words)
        assert result.ret == pytest.ExitCode.USAGE_ERROR and said in "\n".join(result.errlines)
    (pytester.path / "goldens/test_drop/test_one").mkdir(parents=True)
    (pytester.path / "goldens/test_drop/test_one/notes.txt").write_text("")
    result = run(pytester, "--localshape-bless")
    result.assert_outcomes(failed=1)
    assert "is not a golden: it has no golden.toml, but other files, such as notes.txt" in told(result)


def test_without_a_device_states_are_compared(pytester, monkeypatch):
    write(pytester, TEST.replace("return scene()", f"return Scene(**{CUBES!r})"))
    run(pytester, "--localshape-bless").assert_outcomes(passed=1)
    for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES"):
        monkeypatch.setenv(name, "/nonexistent.json")
    monkeypatch.delenv("LOCALSHAPE_REQUIRE_GPU", raising=False)
    result = pytester.runpytest_subprocess("-p", "no:cacheprovider")
    result.assert_outcomes(passed=1, warnings=1)
    assert "states were compared, pictures were not" in told(result)
    undrawn = pytester.runpytest_subprocess("-p", "no:cacheprovider", "--localshape-bless")
    undrawn.assert_outcomes(failed=1)
    assert "nothing was accepted: without a graphics adapter there are no pictures" in told(undrawn)
    monkeypatch.setenv("LOCALSHAPE_REQUIRE_GPU", "1")
    pytester.runpytest_subprocess("-p", "no:cacheprovider").assert_outcomes(failed=1)


def test_help_and_marker(pytester):
    assert "--localshape-report=DIR" in told(pytester.runpytest("--help"))
    assert "@pytest.mark.localshape(folder='goldens', name=None)" in told(pytester.runpytest("--markers"))
