"""The Python lines of the README and of the page, word for word, in order; and what the wheel brings."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from lines import REPOSITORY, lines


PAGES = ["README.md", "python/README.md"] + [f"docs/how-to/python{of}.md" for of in ("", "-studies", "-stepping", "-offline", "-gym")]


@pytest.mark.parametrize("page", PAGES)
def test_the_lines_of_a_page_run(page: str, tmp_path: Path) -> None:
    for file in (REPOSITORY / "sumo_nets" / "city").glob("city*.xml"):
        shutil.copy(file, tmp_path)
    shutil.copy(REPOSITORY / "sumo_nets" / "city" / "city.sumocfg", tmp_path / "my.sumocfg")
    found = lines(page)
    assert found
    script = tmp_path / "my_lines.py"
    script.write_text(found, encoding="utf-8")
    ended = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=280)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout


def test_the_wheel_is_typed_and_holds_no_tests() -> None:
    import sumo_mfc

    package = Path(sumo_mfc.__file__).parent
    assert (package / "py.typed").is_file() and (package / "_core.pyi").is_file()
    assert package.is_relative_to(sys.prefix), "the installed wheel is tested, not the sources"
    assert not (package.parent / "tests" / "test_run.py").exists()
