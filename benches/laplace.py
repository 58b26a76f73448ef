"""A partial differential equation on the particles of a sphere, without a mesh.

python3 -m venv target/peers
target/peers/bin/pip install numpy scipy
cargo build --release --package marching-particles-cli
target/peers/bin/python benches/laplace.py

Solves u − Δu = g on the unit sphere, where Δ is the Laplace–Beltrami operator and u is given, on
particles whose spacing is 2 + z, so that it grows by 3 from pole to pole. Generalised finite
differences: a polynomial of degree two or four in the tangent plane of each particle is fitted to
its nearest 15 or 30 particles by weighted least squares. In these coordinates Δ is ∂²/∂x² + ∂²/∂y²
at the particle, since the slope of the surface vanishes there. Prints the root mean square of the
error over that of u, and the order of convergence, by which power of the spacing it falls.
"""

import pathlib
import subprocess
import tempfile

import numpy as np
from scipy.sparse import csr_matrix, identity
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

PROGRAM = pathlib.Path(__file__).parent.parent / "target" / "release" / "marching-particles"
COUNTS = 1_000, 4_000, 16_000


def sampled(count, *options):
    """Points and unit normals."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(pathlib.Path(folder) / "points.csv")
        command = [PROGRAM, "sample", "--formula", "norm(x, y, z) = 1", "--spacing", "2 + z", "--quiet"]
        command += ["--count", str(count), "--report", "none", "--out", path, *options]
        subprocess.run(command, check=True, capture_output=True)
        columns = np.loadtxt(path, delimiter=",", skiprows=1, usecols=range(6))
    return columns[:, :3], columns[:, 3:]


def laplacian(points, normals, degree):
    """The matrix of Δ."""
    near = {2: 15, 4: 30}[degree]
    distance, index = cKDTree(points).query(points, k=near)
    side = np.eye(3)[np.abs(normals).argmin(1)]
    u = np.cross(normals, side)
    u /= np.linalg.norm(u, axis=1)[:, None]
    frame = np.stack([u, np.cross(normals, u)], axis=1)
    reach = distance[:, -1]
    x, y = np.einsum("nac,nkc->ank", frame, points[index] - points[:, None]) / reach[:, None]
    powers = [(i, k - i) for k in range(degree + 1) for i in range(k + 1)]
    terms = np.stack([x**i * y**j for i, j in powers], axis=-1)
    weight = np.exp(-4 * (distance / reach[:, None]) ** 2)
    fit = np.linalg.pinv(terms * weight[..., None]) * weight[:, None, :]
    rows = 2 * (fit[:, powers.index((2, 0))] + fit[:, powers.index((0, 2))]) / reach[:, None] ** 2
    at = np.repeat(np.arange(len(points)), near)
    return csr_matrix((rows.ravel(), (at, index.ravel())), shape=(len(points),) * 2)


def exact(points):
    """A function u of the sphere, and u − Δu: for a function of space Δ is ∇²u − 2 ∂u/∂r − ∂²u/∂r²."""
    x, y, z = points.T
    # Spherical harmonics of degrees 3 and 1, and exp(z).
    wave, slope = x * y * z + x, np.exp(z)
    of_wave = x * y * z * (1 + 12) + x * (1 + 2)
    of_slope = slope - slope * (1 - z**2 - 2 * z)
    return wave + slope, of_wave + of_slope


def main():
    print("| | Degree | " + " | ".join(f"{count:,}" for count in COUNTS) + " | Order |")
    print("|---|---:|" + "---:|" * (len(COUNTS) + 1))
    kinds = {"Front": [], "Refined": ["--method", "refined"], "Blue noise": ["--pattern", "blue"]}
    kinds["Random"] = ["--pattern", "random"]
    for name, options in kinds.items():
        clouds = [sampled(count, *options) for count in COUNTS]
        for degree in (2, 4):
            errors, spacings = [], []
            for points, normals in clouds:
                u, g = exact(points)
                matrix = identity(len(points), format="csc") - laplacian(points, normals, degree).tocsc()
                found = splu(matrix).solve(g)
                errors.append(np.sqrt(((found - u) ** 2).mean() / (u**2).mean()))
                spacings.append(len(points) ** -0.5)
            order = np.polyfit(np.log(spacings), np.log(errors), 1)[0]
            told = " | ".join(f"{error:.1e}" for error in errors)
            print(f"| {name} | {degree} | {told} | {order:.1f} |", flush=True)


if __name__ == "__main__":
    main()
