#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""my_tracer.py MESH.obj RAYS.npy HITS.npy: stands in for your ray tracer. It tests every triangle (Möller & Trumbore 1997) and has a
fault that many ray tracers have. docs/guide/is-my-ray-tracer-right.md finds it."""
import sys

import numpy

EPSILON = 1e-3  # "if the determinant is near zero, the ray is parallel to the triangle": the fault. How near is near?


def read(path):
    """The corners of the triangles of an OBJ file, in its order: float32 of shape (M, 3, 3)."""
    vertices, faces = [], []
    for line in open(path):
        word, *rest = line.split() or [""]
        if word == "v":
            vertices.append([float(x) for x in rest[:3]])
        if word == "f":
            numbers = [int(corner.split("/")[0]) for corner in rest]  # from 1 on, or from the last one, -1, back
            faces.append([n - 1 if n > 0 else len(vertices) + n for n in numbers])
    return numpy.array(vertices, "float32")[faces]


def nearest(ray, corners):
    """The nearest hit of a ray (origin, tmin, direction, tmax): t, in lengths of the direction, and the number of the triangle."""
    org, tmin, direction, tmax = ray[0:3], ray[3], ray[4:7], ray[7]
    edge1, edge2, offset = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], org - corners[:, 0]
    p, q = numpy.cross(direction, edge2), numpy.cross(offset, edge1)
    determinant = (edge1 * p).sum(1)
    with numpy.errstate(divide="ignore", invalid="ignore"):
        u, v, t = (offset * p).sum(1) / determinant, q @ direction / determinant, (edge2 * q).sum(1) / determinant
    hit = (abs(determinant) > EPSILON) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= tmin) & (t <= tmax)
    t = numpy.where(hit, t, numpy.inf)
    return (t.min(), t.argmin()) if hit.any() else (numpy.inf, -1)


mesh, rays, hits = sys.argv[1:]
triangles = read(mesh)
numpy.save(hits, numpy.array([nearest(ray, triangles) for ray in numpy.load(rays)], [("t", "<f4"), ("object", "<i8")]))
