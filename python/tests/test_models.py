"""Meshes, volumes and atoms from arrays."""

from __future__ import annotations

import numpy as np
import pytest

import belvedere

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float) * 100
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def test_a_mesh_with_colours() -> None:
    red = np.tile(np.array([[220, 20, 20]], np.uint8), (8, 1))
    picture = belvedere.Scene(crs="local").add_mesh(CUBE, FACES, colors=red).render(size=(96, 72))
    seen = picture.rgba[picture.id == 1].mean(axis=0)
    assert (picture.id == 1).mean() > 0.03 and seen[0] > 2 * seen[1]
    for faces, words in ((FACES + 1, "vertex 8"), (FACES.astype(float), "float64"), (FACES[:, :2], "(12, 2)")):
        with pytest.raises(belvedere.InputError) as refusal:
            belvedere.Scene().add_mesh(CUBE, faces)
        assert words in str(refusal.value)


@pytest.mark.parametrize("dtype", ["uint8", ">i2", "float16", "float32", ">f8", "int64"])
def test_voxels_of_any_type(dtype: str) -> None:
    z, y, x = np.mgrid[-1:1:24j, -1:1:28j, -1:1:32j]
    ball = (100 * np.clip(1 - np.sqrt(x * x + y * y + z * z), 0, 1)).astype(dtype)
    scene = belvedere.Scene(crs="local").add_volume(ball, spacing=(1.0, 1.0, 1.0), transfer="solid")
    picture = scene.render(size=(64, 48))
    assert 0.02 < (picture.id == 1).mean() < 0.6
    # x runs along the last axis.
    low, high = scene.bounds
    assert (high - low)[0] > (high - low)[2]


def test_masked_voxels_are_no_values() -> None:
    values = np.ma.masked_less(np.arange(64.0).reshape(4, 4, 4), 5)
    belvedere.Scene(crs="local").add_volume(values)
    with pytest.raises(belvedere.InputError, match="masked"):
        belvedere.Scene(crs="local").add_volume(values.astype("int16"))
    with pytest.raises(belvedere.InputError, match="complex"):
        belvedere.Scene(crs="local").add_volume(np.zeros((3, 3, 3), complex))


def test_atoms() -> None:
    positions = np.array([[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [2.2, 1.3, 0.0], [0.0, 0.0, 1200.5]])[:3]
    scene = belvedere.Scene(crs="local").add_atoms(["C", "N", "O"], positions, chains=["A", "A", "B"], select="chain B", must_see=True)
    assert (scene.render(size=(64, 48)).id == 1).mean() > 0.02
    assert scene.measure().visible is not None
    with pytest.raises(belvedere.InputError, match="3 positions"):
        belvedere.Scene().add_atoms(["C"], positions)
