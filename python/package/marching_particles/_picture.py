"""A picture of particles for notebooks: discs on a body, in parallel projection."""

from __future__ import annotations

import struct
import zlib

import numpy as np

WIDTH, HEIGHT = 480, 360
# Each pixel is the mean of so many by so many.
_SAMPLES = 2
_MARGIN = 0.04
# The viewer is in this direction, and z points up.
_TOWARD = np.array([0.5, -0.75, 0.43])
_LIGHT = np.array([-0.35, 0.55, 0.76])
# Radii of a disc and of what it covers of the body, in radii of the particle. Discs on a hexagonal
# lattice leave no hole from 2/√3 on.
_DISC, _BODY, _BODY_ON_EDGE = 0.82, 1.3, 0.6
# The colour of the back is complete where the cosine of its angle to the viewer is the inverse.
_BACK_FROM = 3.0
_COLOURS = {"disc": (63, 124, 191), "back": (196, 140, 76), "body": (205, 211, 219)}
# So many particles are more than the picture has pixels.
_MOST = 200_000


def png(points, normals, radii):
    """The picture as the bytes of a PNG file, transparent beside the surface.

    Args:
        points: Array (n, 3) of positions.
        normals: Array (n, 3) of unit normals. Discs that are seen from behind have another colour.
        radii: Array (n,).
    """
    step = -(-len(points) // _MOST)
    points, normals, radii = (np.asarray(a[::step], dtype=np.float64) for a in (points, normals, radii))
    right, up, toward = _basis()
    view = np.stack([right, up, toward])
    places, normals = (points - points.mean(axis=0)) @ view.T, normals @ view.T
    radii = radii * np.sqrt(step)
    size = np.array([WIDTH, HEIGHT]) * _SAMPLES
    low = (places[:, :2] - radii[:, None]).min(axis=0)
    high = (places[:, :2] + radii[:, None]).max(axis=0)
    scale = ((1 - 2 * _MARGIN) * size / np.maximum(high - low, 1e-300)).min()
    places = places * scale
    places[:, :2] += size / 2 - (low + high) / 2 * scale
    is_back = normals[:, 2] < 0
    # A particle on an edge has several rows: of these the sides that are turned away are left out.
    _, first, counts = np.unique(points, axis=0, return_inverse=True, return_counts=True)
    is_edge = counts[first.reshape(-1)] > 1
    is_seen = ~(is_edge & is_back)
    places, normals, radii, is_back, is_edge = (
        a[is_seen] for a in (places, normals, radii, is_back, is_edge)
    )
    normals = np.where(is_back[:, None], -normals, normals)
    light = 0.5 + 0.5 * np.clip(normals @ (_LIGHT / np.linalg.norm(_LIGHT)), 0, 1)
    # At the outline of a solid a rim of the discs behind it is seen, which should not show.
    share = np.clip(_BACK_FROM * normals[:, 2:], 0, 1) * is_back[:, None]
    disc = (share * _COLOURS["back"] + (1 - share) * np.array(_COLOURS["disc"])) * light[:, None]
    body = np.multiply(_COLOURS["body"], light[:, None])
    pixels = np.zeros((size[1] * size[0], 4))
    depths = np.full(len(pixels), -np.inf)
    radii = np.maximum(radii * scale, 1)
    # A disc lies on the body: it is nearer by a part of its radius.
    _paint(
        pixels, depths, size, places, normals, np.where(is_edge, _BODY_ON_EDGE, _BODY) * radii, body, 0.0
    )
    _paint(pixels, depths, size, places, normals, _DISC * radii, disc, 0.5 * radii * normals[:, 2])
    pixels = pixels.reshape(HEIGHT, _SAMPLES, WIDTH, _SAMPLES, 4).mean(axis=(1, 3))
    alpha = pixels[..., 3:]
    pixels[..., :3] /= np.maximum(alpha, 1e-9) / 255
    return _encoded(np.clip(pixels[::-1], 0, 255).round().astype(np.uint8))


def _basis():
    toward = _TOWARD / np.linalg.norm(_TOWARD)
    right = np.cross([0, 0, 1], toward)
    right /= np.linalg.norm(right)
    return right, np.cross(toward, right), toward


def _paint(pixels, depths, size, places, normals, radii, colours, nearer):
    """Draws discs over what lies behind them."""
    slopes = normals[:, :2] / np.maximum(normals[:, 2:], 0.05)
    depth = places[:, 2] + nearer
    # Discs of a similar size have the same pixels around their middles.
    classes = np.ceil(radii).astype(int)
    for k in np.unique(classes):
        rows = np.flatnonzero(classes == k)
        reach = np.arange(-k, k + 1)
        offsets = np.stack(np.meshgrid(reach, reach), axis=-1).reshape(-1, 2)
        offsets = offsets[(offsets**2).sum(axis=-1) <= (k + 1) ** 2]
        # Some million pixels at a time.
        for part in np.array_split(rows, 1 + len(rows) * len(offsets) // 4_000_000):
            at = np.floor(places[part, None, :2]).astype(int) + offsets
            away = at + 0.5 - places[part, None, :2]
            rise = -(away * slopes[part, None]).sum(axis=-1)
            seen = (away**2).sum(axis=-1) + rise**2 <= radii[part, None] ** 2
            seen &= ((at >= 0) & (at < size)).all(axis=-1)
            of, which = np.nonzero(seen)
            index = at[of, which, 1] * size[0] + at[of, which, 0]
            z = depth[part][of] + rise[of, which]
            order = np.argsort(z, kind="stable")
            index, z, of = index[order], z[order], of[order]
            front = z > depths[index]
            index, z, of = index[front], z[front], of[front]
            # Of several values for a pixel the last one stays, which is the nearest.
            depths[index] = z
            pixels[index, :3] = colours[part][of]
            pixels[index, 3] = 255


def _encoded(pixels):
    """An array (height, width, 4) of bytes as a PNG file."""

    def chunk(kind, data):
        check = struct.pack(">I", zlib.crc32(kind + data))
        return struct.pack(">I", len(data)) + kind + data + check

    height, width, _ = pixels.shape
    # Each line begins with its filter, which is none.
    lines = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1)
    header = struct.pack(">2I5B", width, height, 8, 6, 0, 0, 0)
    parts = [(b"IHDR", header), (b"IDAT", zlib.compress(lines.tobytes())), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunk(kind, data) for kind, data in parts)
