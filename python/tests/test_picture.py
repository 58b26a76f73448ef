"""The picture of a sample that notebooks show."""

import struct
import zlib

import numpy as np
import pytest

import marching_particles as mp


def decoded(png):
    """The pixels of a PNG file of four bytes each, without filters, as an array."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    chunks, at = {}, 8
    while at < len(png):
        length, kind = struct.unpack_from(">I4s", png, at)
        data, (check,) = png[at + 8 : at + 8 + length], struct.unpack_from(">I", png, at + 8 + length)
        assert check == zlib.crc32(kind + data)
        chunks[kind] = data
        at += 12 + length
    assert at == len(png) and chunks[b"IEND"] == b""
    width, height, *form = struct.unpack(">2I5B", chunks[b"IHDR"])
    assert form == [8, 6, 0, 0, 0]
    lines = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, -1)
    assert not lines[:, 0].any()
    return lines[:, 1:].reshape(height, width, 4)


@pytest.mark.parametrize(
    "options", [{"count": 12}, {"count": 300}, {"count": 300, "spacing": "0.05 + 0.2 hypot(x, y)"}]
)
def test_a_ball_is_a_disc_in_the_middle_of_its_picture(options):
    pixels = decoded(mp.sample("x^2 + y^2 + z^2 = 1", **options)._repr_png_())
    assert pixels.shape == (360, 480, 4)
    assert pixels[180, 240, 3] == 255 and not pixels[[0, 0, -1, -1], [0, -1, 0, -1], 3].any()
    if options["count"] == 300:
        seen = np.argwhere(pixels[..., 3] > 127)
        middle, reach = seen.mean(axis=0), np.ptp(seen, axis=0)
        assert np.abs(middle - [180, 240]).max() < 6 and abs(reach[0] - reach[1]) < 12
        # A solid is seen from outside, which is blue.
        red, blue = (pixels[..., k].astype(int)[pixels[..., 3] == 255] for k in (0, 2))
        assert (red > blue + 20).mean() < 1e-3


def test_the_box_shows_what_lies_behind_it():
    open_sphere = mp.sample(
        "x^2 + y^2 + z^2 = 1", count=500, bounds=((-2, 0, -2), (2, 2, 2)), measure=False
    )
    pixels = decoded(open_sphere._repr_png_()).astype(int)
    brown = pixels[..., 0] > pixels[..., 2] + 20
    assert brown.mean() > 0.05
