"""A program that gives every option, for a strict checker of types; nobody runs it."""

import marching_particles as mp
import numpy as np
import numpy.typing as npt


def ball(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.asarray((points**2).sum(axis=1) - 1)


def slope(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return 2 * points


def sampled() -> list[mp.Sample]:
    return [
        mp.sample(
            "x^2 + y^2 + z^2 = a",
            count=np.int64(2_000),
            spacing="0.02 + 0.1 hypot(x, y)",
            radius="1%",
            bounds=((-1, -1, -1), (1, 1, 1)),
            params={"a": 1},
            gradient=slope,
            adaptive=True,
            law="max_curvature",
            chord_error="0.1%",
            curvature_scale=0.1,
            radius_min=0.001,
            radius_max=np.float64(0.1),
            grading=0.2,
            closed=True,
            periodic=True,
            thickness="0.2 + 0.1x",
            method="refined",
            pattern="blue",
            exactly=True,
            relax=3,
            match_tolerance=0.7,
            gaps="leave",
            seed=7,
            max_particles=10_000,
            values={"H": "(k_1 + k_2)/2", "height": lambda points: points[:, 2]},
            measure=False,
            progress=lambda share: print(f"{share:.0%}"),
        ),
        mp.sample(ball, spacing=0.1, bounds=np.array([[-1.5] * 3, [1.5] * 3])),
        mp.sample(mp.union([ball, "x^2 + y^2 + z^2 = 2"]), spacing=ball),
        mp.sample(mp.fit_points(np.zeros((9, 3)), centres=100, beyond_points="kept")),
        mp.sample(mp.Image(np.zeros((9, 9, 9)), spacing=0.5, origin=(0, 0, 0), iso=0.5)),
        mp.remesh(
            "part.stl",
            edges=40,
            borders=True,
            smooth=1.0,
            lines=[np.zeros((2, 3))],
            count=500,
            method="refined",
            values={"height": "z"},
        ),
        mp.sample("torus").moved(params={"r": 0.3}, progress=print),
        mp.sample(ball).moved(ball, gradient=slope),
    ]


def figures(sample: mp.Sample, model: mp.Model) -> list[float]:
    report, quality = sample.report, sample.report["quality"]
    found: list[float] = [report["count"], report["radius"], len(sample), model.report["condition"]]
    if quality is not None and quality["six_neighbours"] is not None:
        found.append(quality["six_neighbours"])
    if sample.change is not None:
        found.append(sample.change["to_new"]["largest"])
    mesh = sample.mesh()
    found.extend(mesh.points[mesh.faces[0, 0]].tolist())
    found.extend(sample.values["H"].tolist())
    for warning in sample.warnings:
        print(warning.severity, warning.message)
    sample.save("ball.ply", mesh=True)
    return found
