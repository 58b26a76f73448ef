"""The notebook runs, and prints what stands in it.

``UPDATE_GOLDEN=1`` writes what it prints, after a change that is meant to alter it, and the picture
of its functions with edges in README.md.
"""

import contextlib
import io
import json
import os
from pathlib import Path

import numpy as np
import pytest

NOTEBOOK = Path(__file__).parents[1] / "triangles.ipynb"
PICTURE = Path(__file__).parents[2] / "docs/images/functions.webp"
TAKES = "the notebook takes it: python/notebook.txt"


def printed(cell, names):
    """Runs a cell among names, and returns what it prints as a cell keeps it."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile("".join(cell["source"]), f"cell {cell['id']}", "exec"), names)
    text = out.getvalue().splitlines(keepends=True)
    return [{"name": "stdout", "output_type": "stream", "text": text}] if text else []


def test_the_notebook_runs_and_prints_what_stands_in_it():
    matplotlib = pytest.importorskip("matplotlib", reason=TAKES)
    pytest.importorskip("skimage", reason=TAKES)
    matplotlib.use("Agg")
    notebook = json.loads(NOTEBOOK.read_text("utf-8"))
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    names = {}
    found = [printed(cell, names) for cell in cells]
    angles = names["found"]
    assert angles["marching_particles"].min() > 30 > 10 > angles["scikit-image"].min()
    assert abs(len(names["points"]) / len(names["mesh"].points) - 1) < 0.1
    drawn = [names["plt"].figure(number) for number in names["plt"].get_fignums()]
    for figure in drawn:
        figure.canvas.draw()
        assert np.asarray(figure.canvas.buffer_rgba()).std() > 1
    assert len(drawn) == 3
    for solid in names["solids"].values():
        edges = np.sort(solid.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    if os.environ.get("UPDATE_GOLDEN") == "1":
        for cell, outputs in zip(cells, found):
            cell["outputs"] = outputs
        text = json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"
        NOTEBOOK.write_text(text, encoding="utf-8")
        drawn[-1].savefig(PICTURE, dpi=96, transparent=True)
    assert [cell["outputs"] for cell in cells] == found
