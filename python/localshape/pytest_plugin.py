"""Goldens in pytest: ``@pytest.mark.localshape`` on a test that returns a ``Scene`` or a ``Result``."""

from __future__ import annotations

import functools
import pathlib
import re
import shlex
import unittest
import warnings
from collections.abc import Callable, Generator
from typing import Any
from urllib.parse import quote

import pytest

from . import _core

MARK = "localshape(folder='goldens', name=None): the scene or result that the test returns is as its golden, the folder FOLDER/NAME beside the test"
#: Where another test has the same golden.
SHARED = pytest.StashKey[str]()
#: Properties of reports, which come from other processes, too.
PROPERTIES = ["localshape_verdict", "localshape_words", "localshape_page", "localshape_accepted"]


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("localshape", "goldens of localshape")
    add = group.addoption
    add("--localshape-bless", action="store_true", help="make or renew goldens, and list what is accepted")
    add("--localshape-generate-path", metavar="DIR", help="make goldens in DIR instead, and skip their tests")
    add("--localshape-report", metavar="DIR", help="write a page for each golden in DIR, and one of all, index.html")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", MARK)
    option = config.option
    if option.localshape_bless and option.localshape_generate_path:
        raise pytest.UsageError("--localshape-bless renews goldens where they are; leave it out, or --localshape-generate-path")
    for name in ("generate_path", "report"):
        folder = getattr(option, f"localshape_{name}")
        if folder is not None:
            # Other processes may have another folder.
            path = config.invocation_params.dir / folder
            setattr(option, f"localshape_{name}", str(path))
            _check_folder(f"--localshape-{name.replace('_', '-')}", path)
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(_Told(config), "localshape-told")


def _check_folder(option: str, path: pathlib.Path) -> None:
    """Refuses a file, and a folder with another page of this name."""
    if path.exists() and not path.is_dir():
        raise pytest.UsageError(f"{option}: {path} is no folder; name another")
    page = path / "index.html"
    if page.exists() and b'name="generator" content="localshape"' not in page.read_bytes()[:2000]:
        raise pytest.UsageError(f"{option}: {page} exists and is not a page of localshape; name another folder")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    seen: dict[pathlib.Path, str] = {}
    for item in items:
        try:
            place = _golden(item)
        except TypeError:
            continue  # The test tells it.
        if place is not None and seen.setdefault(place, item.nodeid) != item.nodeid:
            item.stash[SHARED] = seen[place]


def _golden(item: pytest.Item) -> pathlib.Path | None:
    """The folder of the golden of a test, if it has one. A wrong marker is a ``TypeError``."""
    marker = item.get_closest_marker("localshape")
    if marker is None:
        return None
    folder, name = _arguments(*marker.args, **marker.kwargs)
    place = pathlib.Path(item.config.option.localshape_generate_path or item.path.parent / folder)
    return place / (f"{item.path.stem}/{_file_name(item)}" if name is None else name)


def _arguments(folder: str | pathlib.Path = "goldens", name: str | None = None) -> tuple[str | pathlib.Path, str | None]:
    return folder, name


def _file_name(item: pytest.Item) -> str:
    """The name of a test among those of its module, without characters that files cannot have."""
    return re.sub(r"[^\w.+-]+", "_", ".".join(item.nodeid.split("::")[1:])).strip("_")


def pytest_runtest_setup(item: pytest.Item) -> None:
    of_class = getattr(item, "cls", None)
    if item.get_closest_marker("localshape") and of_class is not None and issubclass(of_class, unittest.TestCase):
        pytest.fail("unittest drops what its tests return, so no golden is compared; write a function", pytrace=False)


@pytest.hookimpl(hookwrapper=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Generator[None, None, None]:
    function = pyfuncitem.obj
    if pyfuncitem.get_closest_marker("localshape"):
        pyfuncitem.obj = _compared(pyfuncitem, function)
    yield
    pyfuncitem.obj = function


def _compared(item: pytest.Function, function: Callable[..., Any]) -> Callable[..., None]:
    """A test that compares what it returned."""

    @functools.wraps(function)
    def compare(*arguments: Any, **keys: Any) -> None:
        __tracebackhide__ = True
        returned = function(*arguments, **keys)
        if isinstance(returned, _core.Scene):
            returned = returned.simulate()
        if not isinstance(returned, _core.Result):
            pytest.fail(f"the test returned {returned!r}; expected a localshape.Scene or localshape.Result", pytrace=False)
        _judge(item, returned)

    return compare


def _judge(item: pytest.Function, result: _core.Result) -> None:
    """Compares a result with the golden of its test, or makes the golden."""
    __tracebackhide__ = True
    option, properties = item.config.option, item.user_properties
    bless, report, elsewhere = option.localshape_bless, option.localshape_report, option.localshape_generate_path
    try:
        golden = _golden(item)
    except TypeError as error:
        pytest.fail(f"@pytest.mark.localshape: {str(error).replace('_arguments', 'localshape')}", pytrace=False)
    assert golden is not None
    if SHARED in item.stash:
        pytest.fail(f"the golden {golden} is that of {item.stash[SHARED]}, too; give one another `name`", pytrace=False)
    file = pathlib.Path(report, _page(item)) if report else None
    command = f"pytest {shlex.quote(item.nodeid)} --localshape-bless"
    try:
        if file:
            file.parent.mkdir(parents=True, exist_ok=True)
        told = _core._compare(result, golden, (item.nodeid, command), bool(bless or elsewhere), file)
    except (RuntimeError, OSError) as error:
        pytest.fail(f"{golden}: {error}", pytrace=False)
    verdict, passes, words, accepted = told
    properties.extend(zip(PROPERTIES, [verdict, words, _page(item), "\n".join(accepted)]))
    if elsewhere:
        pytest.skip(f"its golden was made in {golden}")
    if bless:
        return
    if not passes:
        pytest.fail(words + (f"see {file}" if file else ""), pytrace=False)
    if "no graphics adapter" in words:
        warnings.warn(pytest.PytestWarning("no graphics adapter: states were compared, pictures were not"), stacklevel=1)


def _page(item: pytest.Item) -> str:
    """The page of a test in the folder of all."""
    module = pathlib.PurePosixPath(item.nodeid.split("::")[0]).with_suffix("")
    return re.sub(r"[^\w.+/-]+|\.\.", "_", str(module)) + f"/{_file_name(item)}.html"


class _Told:
    """What tests told, in the process that reports."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.all: list[tuple[pytest.TestReport, list[str]]] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        known = dict(report.user_properties)
        if report.when == "call" and PROPERTIES[0] in known:
            self.all.append((report, [str(known[name]) for name in PROPERTIES]))

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        folder = self.config.option.localshape_report
        if folder:
            rows = [
                (report.nodeid, quote(page), verdict, report.outcome != "failed", words)
                for report, (verdict, words, page, _) in sorted(self.all, key=lambda one: one[0].nodeid)
            ]
            pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
            _core._index(pathlib.Path(folder) / "index.html", rows)
        accepted = [f"{report.nodeid}: {line}" for report, told in self.all for line in told[3].splitlines()]
        if accepted or folder:
            terminalreporter.section("localshape")
            for line in accepted:
                terminalreporter.line(line)
        if folder:
            terminalreporter.line(f"pages of goldens: {pathlib.Path(folder) / 'index.html'}")
