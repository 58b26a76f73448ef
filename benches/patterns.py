"""Patterns of points: spectra in the plane, and spacing on a sphere, beside other programs.

python3 -m venv target/peers
target/peers/bin/pip install numpy scipy pyvista trimesh pymeshlab
cargo build --release --package marching-particles-cli
target/peers/bin/python benches/patterns.py spectra docs/images/spectra.svg
target/peers/bin/python benches/patterns.py spacing 10000

Spectra: the mean over ten seeds of |Σ exp(−2πi k·x)|²/n of 4,000 points of a square, at the
wave vectors k of the square's Fourier series, where the square itself has no spectrum; averaged
over rings of |k|. Anisotropy is the variance in a ring over the square of its mean, in decibels; of
ten independent patterns without any direction it is −10. Lengths are in the distance of the points
in a hexagonal lattice of the same density, frequencies in one over it.

Spacing: every other program gets a mesh of 327,680 triangles of the unit sphere. The largest hole is
the largest of 200,000 random points' distances from the nearest point. Seconds are those of a
processor, once: of the program with its start and the writing of a file, or of this process.
"""

import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
from scipy.spatial import cKDTree

PROGRAM = pathlib.Path(__file__).parent.parent / "target" / "release" / "marching-particles"
SEEDS = 10


def children():
    """Processor seconds of the programs run so far."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


def ours(formula, pattern, count, seed, *options):
    """Points, and the seconds of the run."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(pathlib.Path(folder) / "points.csv")
        command = [PROGRAM, "sample", "--formula", formula, "--pattern", pattern, "--count", str(count)]
        command += ["--seed", str(seed), "--report", "none", "--threads", "1", "--quiet", "--out", path, *options]
        start = children()
        subprocess.run(command, check=True, capture_output=True)
        spent = children() - start
        return np.loadtxt(path, delimiter=",", skiprows=1, usecols=(0, 1, 2)), spent


def spectrum(points, side, waves):
    """The power at whole numbers of waves along both axes, up to `waves`."""
    phase = -2j * np.pi / side
    along = np.arange(-waves, waves + 1)
    x = np.exp(phase * np.outer(along, points[:, 0]))
    y = np.exp(phase * np.outer(np.arange(waves + 1), points[:, 1]))
    return np.abs(x @ y.T) ** 2 / len(points)


def rings(pattern):
    """Frequency, mean power and anisotropy of rings, each a twentieth wide."""
    side, count, width, last = 2.0, 4_000, 0.05, 4.0
    options = ["--exactly"] if pattern == "hexagonal" else []
    lattice = np.sqrt(2 / np.sqrt(3) * side**2 / count)
    limit = int(last * side / lattice)
    power = 0.0
    for seed in range(SEEDS):
        points, _ = ours("z", pattern, count, seed, "--box", str(side / 2), *options)
        power = power + spectrum(points, side, limit) / SEEDS
    along = np.arange(-limit, limit + 1)
    frequency = np.hypot(along[:, None], np.arange(limit + 1)[None, :]) * lattice / side
    # Of k and −k, which have the same power, one.
    is_half = (np.arange(limit + 1)[None, :] > 0) | (along[:, None] > 0)
    ring = (frequency / width).astype(int)
    found = []
    for k in range(1, int(last / width) - 1):
        inside = power[is_half & (ring == k)]
        mean = inside.mean()
        found.append(((k + 0.5) * width, mean, 10 * np.log10(inside.var() / mean**2)))
    return np.array(found)


def curves(found, low, high, top, height, unit):
    """The curves of one diagram, its axes and its labels, as SVG."""
    left, width, last = 56, 640, 4.0

    def place(f, value):
        share = (min(max(value, low), high) - low) / (high - low)
        return f"{left + width * f / last:.1f},{top + height * (1 - share):.1f}"

    parts = [f'<path class="axis" d="M{left} {top}V{top + height}H{left + width}"/>']
    for value in np.linspace(low, high, 5):
        y = place(0, value).split(",")[1]
        parts.append(f'<path class="grid" d="M{left} {y}h{width}"/>')
        parts.append(f'<text x="{left - 8}" y="{float(y) + 4:.1f}" text-anchor="end">{value:g}</text>')
    for f in range(5):
        x = left + width * f / last
        parts.append(f'<text x="{x:.1f}" y="{top + height + 18}" text-anchor="middle">{f}</text>')
    for name, (column, rows) in found.items():
        line = " ".join(place(row[0], row[column]) for row in rows)
        parts.append(f'<polyline class="{name}" points="{line}"/>')
    parts.append(f'<text x="{left}" y="{top - 10}">{unit}</text>')
    return "".join(parts)


STYLE = """svg{--text:#24292f;--grid:#d0d7de}@media(prefers-color-scheme:dark){svg{--text:#e6edf3;--grid:#3d444d}}
text{font:13px sans-serif;fill:var(--text)}path,polyline{fill:none;stroke-width:1.6}.axis{stroke:var(--text)}
.grid{stroke:var(--grid);stroke-width:.6}.blue{stroke:#2f81f7}.random{stroke:#d29922}.hexagonal{stroke:#f85149}"""


def draw(found, path):
    power = {name: (1, rows) for name, rows in found.items()}
    turned = {name: (2, rows) for name, rows in found.items()}
    names = "".join(
        f'<polyline class="{name}" points="{420 + 100 * k},18 {440 + 100 * k},18"/>'
        f'<text x="{446 + 100 * k}" y="22">{name}</text>'
        for k, name in enumerate(found)
    )
    parts = [
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 720 470" width="720" height="470">',
        f"<style>{STYLE}</style>{names}",
        curves(power, 0, 4, 44, 170, "Power"),
        curves(turned, -20, 20, 270, 150, "Anisotropy, dB"),
        '<text x="376" y="460" text-anchor="middle">Frequency, over that of the lattice</text></svg>\n',
    ]
    pathlib.Path(path).write_text("\n".join(parts), encoding="utf-8")


def spectra(path):
    found = {name: rings(name) for name in ("blue", "random", "hexagonal")}
    draw(found, path)
    print("| | Power below 0.5 | Largest power | at | Mean beyond 2 | Anisotropy beyond 1: mean | largest |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for name, rows in found.items():
        f, power, turned = rows.T
        at = power.argmax()
        turned = turned[f > 1]
        print(
            f"| {name.capitalize()} | {power[f < 0.5].mean():.3f} | {power[at]:.2f} | {f[at]:.2f} "
            f"| {power[f > 2].mean():.2f} | {turned.mean():.1f} dB | {turned.max():.1f} dB |"
        )


def of_program(pattern):
    def run(mesh, count):
        return ours("norm(x, y, z) = 1", pattern, count, 0)

    return run


def of_trimesh(mesh, count):
    import trimesh

    start = time.process_time()
    points, _ = trimesh.sample.sample_surface_even(trimesh.Trimesh(*mesh, process=False), count, seed=0)
    return points, time.process_time() - start


def of_vtk(mesh, count):
    import pyvista
    from vtkmodules.vtkFiltersPoints import vtkPoissonDiskSampler

    surface = pyvista.make_tri_mesh(*mesh)
    start = time.process_time()
    sampler = vtkPoissonDiskSampler()
    # The radius at which random discs cover the sphere, as here.
    sampler.SetRadius(2 * np.sqrt(4 * 0.547 / count))
    sampler.SetInputData(surface)
    sampler.Update()
    return pyvista.wrap(sampler.GetOutput()).points, time.process_time() - start


def of_meshlab(mesh, count):
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(*mesh))
    start = time.process_time()
    meshes.generate_sampling_poisson_disk(samplenum=count, exactnumflag=True)
    return meshes.current_mesh().vertex_matrix(), time.process_time() - start


def spacing(count):
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=7)
    mesh = np.asarray(ball.vertices), np.asarray(ball.faces)
    probes = np.random.default_rng(1).normal(size=(200_000, 3))
    probes /= np.linalg.norm(probes, axis=1)[:, None]
    print("| | Points | Closest pair | Largest hole | Hole over pair | Seconds |")
    print("|---|---:|---:|---:|---:|---:|")
    runs = {
        "Blue noise": of_program("blue"),
        "Random": of_program("random"),
        "Hexagonal front": of_program("hexagonal"),
        "trimesh, `sample_surface_even`": of_trimesh,
        "VTK, `vtkPoissonDiskSampler`": of_vtk,
        "MeshLab, Poisson disk": of_meshlab,
    }
    for name, run in runs.items():
        try:
            points, seconds = run(mesh, count)
        except ImportError as error:
            print(f"| {name} | {error} |", file=sys.stderr)
            continue
        tree = cKDTree(points)
        lattice = np.sqrt(2 / np.sqrt(3) * 4 * np.pi / len(points))
        pair = tree.query(points, k=2)[0][:, 1].min() / lattice
        hole = tree.query(probes)[0].max() / lattice
        ratio = f"{hole / pair:.3f}" if pair > 0.01 else ""
        print(f"| {name} | {len(points):,} | {pair:.3f} | {hole:.3f} | {ratio} | {seconds:.2f} |")


if __name__ == "__main__":
    if sys.argv[1] == "spectra":
        spectra(sys.argv[2])
    else:
        spacing(int(sys.argv[2]))
