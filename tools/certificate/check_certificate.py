#!/usr/bin/env python3
"""check_certificate.py CERTIFICATE.json HEIGHTS.tif: checks what `belvedere disocclude --certificate` claims against the file of heights alone.

A line of sight is clear if at every place where it crosses a column, a row or a diagonal of the samples the ground, flat triangles between
them, stands no higher than the line. Needs numpy and rasterio."""

import hashlib
import json
import sys
from pathlib import Path

import numpy as np
import rasterio


def surface(z, at):
    """Height of the triangles at columns and rows, (n, 2) -> (n,); cells are cut from north-west to south-east; nan beside the samples."""
    col, row = np.floor(at).T
    inside = (at >= 0).all(1) & (at <= np.array(z.shape)[::-1] - 1).all(1)
    c, r = (np.clip(v, 0, n - 2).astype(int) for v, n in ((col, z.shape[1]), (row, z.shape[0])))
    u, v = at[:, 0] - c, at[:, 1] - r
    nw, ne, sw, se = z[r, c], z[r, c + 1], z[r + 1, c], z[r + 1, c + 1]
    east, south = np.where(u > v, ne - nw, se - sw), np.where(u > v, se - ne, sw - nw)
    return np.where(inside, nw + u * east + v * south, np.nan)


def rise(z, a, b):
    """Largest height of the ground over the straight piece from a to b, both (column, row, height)."""
    t = [np.array([0.0, 1.0])]
    for of in (lambda p: p[0], lambda p: p[1], lambda p: p[0] - p[1]):
        low, high = sorted((of(a), of(b)))
        if high > low:
            t.append((np.arange(np.ceil(low), np.floor(high) + 1) - of(a)) / (of(b) - of(a)))
    at = a + np.concatenate(t)[:, None] * (b - a)
    over = surface(z, at[:, :2]) - at[:, 2]
    return np.nanmax(over, initial=-np.inf)


def main():
    claim, heights = json.loads(Path(sys.argv[1]).read_text()), Path(sys.argv[2])
    if hashlib.sha256(heights.read_bytes()).hexdigest() != claim["sha256"]:
        sys.exit(f"{heights} is not the file that the certificate is about")
    with rasterio.open(heights) as file:
        z = np.where(file.read_masks(1) > 0, file.read(1).astype(float), np.nan)
    seen, all_of = {}, {}
    for line in claim["lines"]:
        chain = np.array(line["line"])
        clear = max(rise(z, a, b) for a, b in zip(chain, chain[1:])) <= claim["tolerance_m"]
        kind = {"rim": "inside"}.get(line["kind"], line["kind"])
        seen[kind] = seen.get(kind, 0.0) + clear * line["amount"]
        all_of[kind] = all_of.get(kind, 0.0) + line["amount"]
    share = min((seen[kind] / all_of[kind] for kind in all_of), default=1.0)
    print(f"{len(claim['lines'])} lines of sight; {share:.4f} is seen, {claim['visible_share']:.4f} is claimed")
    sys.exit(int(share < claim["visible_share"] - 0.005))


if __name__ == "__main__":
    main()
