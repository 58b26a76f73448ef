"""The programs of the cookbook make the particles that its commands make."""

import json
import re
from pathlib import Path

import numpy as np

import marching_particles as mp

ROOT = Path(__file__).parents[2]


def points():
    """Points of a sphere with their normals, as the tests of the command line write them."""
    grid = [k / 9 for k in range(-9, 10)]
    for u, v, side in ((u, v, side) for u in grid for v in grid for side in (1, -1)):
        square = u * u + v * v
        place = " ".join(repr(c / (1 + square)) for c in (2 * u, 2 * v, side * (1 - square)))
        yield f"{place} {place}\n"


def test_every_program_makes_the_particles_of_its_task(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("scan.xyz").write_text("".join(points()), "utf-8")
    squares = (np.arange(32, dtype=np.int16) - 16) ** 2
    np.save("scan.npy", 300 - squares[:, None, None] - squares[:, None] - squares)

    digests = json.loads((ROOT / "tests/golden/cookbook.json").read_text("utf-8"))
    page = (ROOT / "docs/cookbook.md").read_text("utf-8")
    found = {}
    for task in page.split("\n## ")[1:]:
        title, text = task.split("\n", 1)
        program = re.search(r"```python\n(.*?)```", text, re.DOTALL).group(1)
        names = {"mp": mp, "np": np}
        exec(compile(program, title, "exec"), names)
        found[title] = names["particles"].report["digest"]
    assert found == {task["title"]: task["digest"] for task in digests}
