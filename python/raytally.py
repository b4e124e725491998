# SPDX-License-Identifier: Apache-2.0
"""raytally from Python: what rays hit and cost in acceleration structures, on NumPy arrays.

    scene = raytally.Scene("balls:size=2")
    accel = scene.accelerator("bvh")
    rays = accel.record("primary")          # or an array of your own
    hits = accel.nearest(rays)              # hits["t"], hits["object"]
    steps = accel.counts(rays)["steps"]     # of each ray

Rays are an array of shape (N, 8), as `raytally rays` writes it: origin x, y, z in the units of the scene; tmin; direction
x, y, z, of any length but 0; tmax, numpy.inf for a ray without end. t is in lengths of the direction. Methods take such an
array, or `Rays`: checked once, and of one of KINDS. "shadow" and "occlusion" ask whether there is a hit, all others for the
nearest one. An array is "random", which overlays pass on. Arrays are float32, or what NumPy casts to it safely. Others,
such as float64, are refused, not rounded: use `array.astype("float32")`. Lists of numbers are rounded.

Results: HIT has `t` and `object`. COUNTS has a field for each of COUNTERS: `rays`; `hits`; `object_tests`, intersection
routines entered, and `object_hits`, those that found a hit; `extent_tests`, of bounding volumes; `steps`, nodes, voxels or
list entries visited, of which `leaf_steps`, of which `empty_steps`; `csg_tests`, of solids in CSG trees; `repeats_avoided`
by a mailbox; `passed_on` by overlays; `instances_entered`. ESTIMATE has the `median` of measurements, the `least`, and an
interval, `low` to `high`, that holds the median with probability `coverage`. TIME has two: `seconds` and `ratio`.

Errors: RaytallyError says what is wrong, and what would be right. Without a library the import fails (ImportError). It
is $RAYTALLY_LIBRARY, or libraytally.so.1 as installed with this file, in build/release, or where the system looks.
Threads: `threads` is 1..1024, or 0 for all processors; it changes no hit and no count. Threads may share objects, but
only one may set a camera or measure times. Hits differ where -ffast-math lets a thread flush denormals to zero.
"""
from __future__ import annotations

import concurrent.futures
import ctypes
import os
import struct
import time
import weakref
from types import SimpleNamespace
from typing import Any, Sequence, Union

try:
    import numpy
    from numpy.typing import ArrayLike, NDArray
except ImportError as cause:
    raise ImportError(f"{cause}: raytally needs NumPy: Debian's python3-numpy, which /usr/bin/python3 finds") from cause

__all__ = ["COUNTERS", "COUNTS", "ESTIMATE", "HIT", "KINDS", "TIME", "Accelerator", "Rays", "RaysLike", "RaytallyError",
           "Scene", "accelerators", "load_plugin", "time_all"]
_ABI, _WARNING, _CHUNK = 1, 1100, 4096  # characters of the longest warning; rays that a thread traces at a time
_TYPES = dict(zip("psiuzb-", (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_uint32, ctypes.c_uint64, ctypes.c_bool, None)))
_FUNCTIONS = dict(each.split(":") for each in """
    abi_version:i version:s counter_name:si ray_kind_name:si plugin_load:isp scene_open:ispp scene_from_objects:ippp
    scene_free:-p scene_object_count:up scene_bounds:-ppp scene_warning:bpup scene_set_camera:ippp scene_set_sampling:ipuuup
    accelerator_count:z accelerator_name:sz accelerator_build:ipsipp accelerator_free:-p accelerator_spec:sp
    accelerator_exact:bp accelerator_check:ipp accelerator_describe:-pp tracer_new:ippp tracer_free:-p nearest:-ppzpp
    occluded:-ppzpp rays_record:ipippp rays_copy:iipzpp rays_free:-p rays_count:zp rays_data:pp rays_fingerprint:zp
    verify:ipsppp count_each:ippipup time_all:ipzpppp""".split())  # the type of the result, then those of the parameters


def _load() -> ctypes.CDLL:
    name, here = f"libraytally.so.{_ABI}", os.path.dirname(os.path.realpath(__file__))
    places = [f"{here}/{place}/{name}" for place in ("../..", "../../../lib64", "../build/release")]
    path = os.environ.get("RAYTALLY_LIBRARY") or next((place for place in places if os.path.exists(place)), name)
    try:
        library = ctypes.CDLL(path)
        for function, types in _FUNCTIONS.items():
            found = getattr(library, "raytally_" + function)
            found.restype, *found.argtypes = (_TYPES[each] for each in types)
    except (OSError, AttributeError) as error:
        raise ImportError(f"{error}: set RAYTALLY_LIBRARY to the path of {name} of raytally 1.1 or later") from error
    if library.raytally_abi_version() != _ABI:
        raise ImportError(f"{path} has interface {library.raytally_abi_version()}: expected {_ABI}")
    return library


_library = _load()
__version__: str = _library.raytally_version().decode()
COUNTERS = tuple(name.decode() for name in map(_library.raytally_counter_name, range(64)) if name)
KINDS = tuple(name.decode() for name in map(_library.raytally_ray_kind_name, range(64)) if name)
HIT = numpy.dtype([("t", "f4"), ("object", "i4")])
COUNTS = numpy.dtype([(name, "u8") for name in COUNTERS])
ESTIMATE = numpy.dtype({"names": ["median", "low", "high", "least", "coverage"], "formats": ["f8"] * 5, "itemsize": 64})
TIME = numpy.dtype({"names": ["seconds", "ratio"], "formats": [ESTIMATE, ESTIMATE], "itemsize": 192})
_RAY = numpy.dtype([("row", "f4", 8), ("kind", "u4"), ("source", "u4")])
RaysLike = Union["Rays", ArrayLike]


class RaytallyError(Exception):
    """Why a call failed. If Scene.verify found a wrong answer, `result` has its numbers."""
    result: dict[str, int] | None = None


def _call(function: str, *arguments: Any) -> None:
    error = ctypes.create_string_buffer(1028)  # a status, then the message
    if getattr(_library, "raytally_" + function)(*arguments, error):
        raise RaytallyError(error.raw[4:].split(b"\0")[0].decode(errors="replace"))


def _checked(**values: Any) -> list[Any]:
    """The values for C, where ctypes would cut them: integers to their size, strings at a zero."""
    for name, value in values.items():
        if name in ("path", "spec"):
            values[name] = os.fsencode(value)
            right, wanted = b"\0" not in values[name], "no zero character"
        else:
            most = 1024 if name == "threads" else 2**64 - 1 if name in ("limit", "rays", "seed") else 2**32 - 1
            right, wanted = isinstance(value, (int, numpy.integer)) and 0 <= value <= most, f"an integer in 0..{most}"
        if not right:
            raise RaytallyError(f"{name}={value!r}: expected {wanted}")
    return [int(value) if isinstance(value, numpy.integer) else value for value in values.values()]


def _options(layout: str, *values: Any) -> bytes:  # a struct that begins with its size
    return struct.pack("@N" + layout, struct.calcsize("@N" + layout), *values)


def _array(values: ArrayLike, columns: int, what: str, dtype: str = "float32") -> NDArray:
    """`values` as an array of `dtype` and shape (N, columns), the same one if it is contiguous; [] is (0, columns)."""
    array = numpy.asarray(values if numpy.shape(values) != (0,) else numpy.empty((0, columns), dtype))
    if array.ndim != 2 or array.shape[1] != columns or isinstance(values, numpy.ma.MaskedArray):
        raise RaytallyError(f"{what}: {type(values).__name__} of shape {array.shape}: expected an array (N, {columns})")
    kinds, wanted = ("iu", "integers") if dtype == "uint32" else ("iuf", "float32, as from array.astype('float32')")
    exact = kinds == "iu" or numpy.can_cast(array.dtype, dtype)
    if array.dtype.kind not in kinds or not (exact or isinstance(values, (list, tuple))):
        raise RaytallyError(f"{what}: numbers of type {array.dtype}: expected {wanted}")
    for number in (array.min(initial=0), array.max(initial=0)) if dtype == "uint32" else ():
        _checked(**{what: int(number)})
    return numpy.ascontiguousarray(array, dtype)


def accelerators() -> list[str]:
    """The names of all accelerators, including those of loaded plugins."""
    return [_library.raytally_accelerator_name(i).decode() for i in range(_library.raytally_accelerator_count())]


def load_plugin(path: str | os.PathLike) -> None:
    """Loads the accelerators of a plugin. They run in their own process: build them before you start threads."""
    _call("plugin_load", *_checked(path=path))


def _new(what: str, needs: ctypes.c_void_p | None, function: str, *arguments: Any) -> ctypes.c_void_p:
    """Makes an object that is freed when its handle goes, and before `needs`, even if both are in a cycle."""
    handle = ctypes.c_void_p()
    _call(function, *arguments, ctypes.byref(handle))
    address, free = handle.value, getattr(_library, f"raytally_{what}_free")
    weakref.finalize(handle, lambda _: free(address), needs).atexit = False  # when threads may still trace
    return handle


class Rays:
    """Valid rays of one `kind`, one of KINDS: an array is copied and checked. `numpy.asarray(rays)` is a view of them:
    float32, (N, 8), read-only. rays[index] are `Rays` of the same kind, by a number, a slice, a mask or an array of numbers.
    `source`, uint32, (N,), read-only: of recorded primary, diffuse and occlusion rays their sample, row * columns + column in
    the image; of shadow rays their light; else 0. `fingerprint` is a hash: equal rays have the same on every machine."""

    def __init__(self, rays: ArrayLike, kind: str = "random", *, _source: Any = 0, _recording: tuple = ()) -> None:
        if kind not in KINDS:
            raise RaytallyError(f"'{kind}' is not a kind of rays: expected one of {', '.join(KINDS)}")
        given = _array(rays, 8, "rays")
        copy = numpy.zeros(len(given), _RAY)
        copy["row"], copy["source"] = given, _source
        number, data = KINDS.index(kind), copy.ctypes.data
        call = ("rays_record", _recording[0], number, _recording[1]) if _recording else ("rays_copy", number, data, len(copy))
        self._handle = _new("rays", None, *call)
        memory = {"version": 3, "shape": (_library.raytally_rays_count(self._handle),), "typestr": "|V40", "descr": _RAY.descr,
                  "data": (_library.raytally_rays_data(self._handle) or 0, True)}  # read-only
        self._array = numpy.asarray(SimpleNamespace(__array_interface__=memory, owner=self._handle))
        self.__array_interface__ = self._array["row"].__array_interface__
        self.kind = kind
        self.source: NDArray[numpy.uint32] = self._array["source"]
        self.fingerprint: int = _library.raytally_rays_fingerprint(self._handle)

    def __len__(self) -> int:
        return len(self._array)

    def __getitem__(self, index: Any) -> Rays:
        picked = numpy.atleast_1d(self._array[index])
        return Rays(picked["row"], self.kind, _source=picked["source"])


def _rays(rays: RaysLike) -> Rays:
    return rays if isinstance(rays, Rays) else Rays(rays)


class Scene:
    """Objects, numbered from 0 to object_count - 1, lights and a camera: a built-in scene ("balls:size=4") or a file.
    `bounds`, (2, 3): the smallest box around all objects, the least and the greatest x, y, z. `warnings`: what the reader
    of files left out or guessed, each with its place."""

    def __init__(self, spec: str | os.PathLike, *, _source: tuple = ()) -> None:
        self._handle = _new("scene", None, *_source or ("scene_open", *_checked(spec=spec)))
        self.object_count: int = _library.raytally_scene_object_count(self._handle)
        self.bounds: NDArray[numpy.float32] = numpy.empty((2, 3), "float32")
        _library.raytally_scene_bounds(self._handle, self.bounds[0].ctypes.data, self.bounds[1].ctypes.data)
        self.warnings: list[str] = []
        text = ctypes.create_string_buffer(_WARNING)
        while _library.raytally_scene_warning(self._handle, len(self.warnings), text):
            self.warnings.append(text.value.decode(errors="replace"))

    @classmethod
    def from_arrays(cls, vertices: ArrayLike = (), triangles: ArrayLike = (), spheres: ArrayLike = ()) -> Scene:
        """A scene of `triangles`, (T, 3), integers: the rows of their `vertices`, (V, 3); and of `spheres`, (S, 4): the
        centre, and a radius above 0. Triangle i is object i, sphere k is object T + k. The camera sees all of them."""
        v, s, t = _array(vertices, 3, "vertices"), _array(spheres, 4, "spheres"), _array(triangles, 3, "triangles", "uint32")
        objects = _options("PIPIPII", v.ctypes.data, len(v), t.ctypes.data, len(t), s.ctypes.data, len(s), 0)
        return cls("", _source=("scene_from_objects", objects))

    def set_camera(self, eye: ArrayLike, at: ArrayLike, up: ArrayLike, fov: float) -> None:
        """The camera is at `eye` and looks at `at`, `fov` degrees high. `del` the scene's accelerators first."""
        camera = numpy.append(_array([eye, at, up], 3, "eye, at, up"), _array([[fov]], 1, "fov"))
        _call("scene_set_camera", self._handle, camera.ctypes.data)

    def set_sampling(self, width: int, height: int, samples: int = 1) -> None:
        """The image has width x height pixels of samples x samples rays. `del` its accelerators first."""
        _call("scene_set_sampling", self._handle, *_checked(width=width, height=height, samples=samples))

    def accelerator(self, spec: str, threads: int = 0) -> Accelerator:
        """Builds the accelerator that `spec` describes: "bvh", "grid:density=4", "item+kd"."""
        return Accelerator(self, spec, threads)

    def verify(self, spec: str, rays: int | RaysLike = 10000, seed: int = 1, threads: int = 0) -> dict[str, int]:
        """Compares an accelerator's answers with those of `brute`, on so many rays of `raytally verify`, or on these. Returns
        numbers of rays: "equal", "tie", "marginal", "wrong", ... For wrong answers they are `result` of RaytallyError."""
        count, given = (rays, None) if isinstance(rays, (int, numpy.integer)) else (0, _rays(rays)._handle)
        how = _options("QQiP", *_checked(rays=count, seed=seed, threads=threads), given.value if given else 0)
        found = numpy.zeros(16, "u8")
        names = "rays", "equal", "tie", "marginal", "wrong", "occluded_wrong", "certain", "must_hit", "certain_of"
        try:
            _call("verify", self._handle, *_checked(spec=spec), how, found.ctypes.data)
        except RaytallyError as error:
            error.result = dict(zip(names, found.tolist())) if found.any() else None
            raise
        return dict(zip(names, found.tolist()))


class Accelerator:
    """A structure over a `scene` that finds what rays hit. Scene.accelerator builds it. `spec` has all parameters;
    `build_seconds` is the wall-clock time of this one build; `exact`: whether hits are those of `brute`, bit for bit."""

    def __init__(self, scene: Scene, spec: str, threads: int = 0) -> None:
        start = time.perf_counter()
        self._handle = _new("accelerator", scene._handle, "accelerator_build", scene._handle, *_checked(spec=spec, threads=threads))
        self.build_seconds: float = time.perf_counter() - start
        self.scene = scene
        self.spec: str = _library.raytally_accelerator_spec(self._handle).decode()
        self.exact: bool = _library.raytally_accelerator_exact(self._handle)

    def describe(self) -> dict[str, float]:
        """Numbers of nodes, leaves and references, depth, bytes; predicted cost, tests and steps of a random line, or nan."""
        values = numpy.zeros(32)
        _library.raytally_accelerator_describe(self._handle, values.ctypes.data)
        return dict(zip(("interior", "leaves", "empty_leaves", "references", "depth", "bytes", "predicted_cost",
                         "predicted_tests", "predicted_steps"), values.tolist()))

    def record(self, kind: str = "primary", depth: int = 5, seed: int = 1, limit: int = 100000, threads: int = 0) -> Rays:
        """The rays of one kind in a frame of `depth` levels, as `raytally bench` records them. If there are more than
        `limit`, runs of 256 are left out. Their order is that of tracing: tile by tile, not row by row. `Rays.source`
        tells their samples. The accelerator must be exact."""
        how = _options("IiQQ", *_checked(depth=depth, threads=threads, seed=seed, limit=limit))
        return Rays((), kind, _recording=(self._handle, how))

    def nearest(self, rays: RaysLike, threads: int = 0) -> NDArray:
        """The nearest hit of each ray within [tmin, tmax]: (N,) of HIT, t and the object's number. A miss: inf and -1."""
        return self._trace(_library.raytally_nearest, _rays(rays), HIT, threads)

    def occluded(self, rays: RaysLike, threads: int = 0) -> NDArray[numpy.bool_]:
        """Whether anything lies on each ray within [tmin, tmax]: (N,) of bool."""
        return self._trace(_library.raytally_occluded, _rays(rays), numpy.dtype(bool), threads)

    def _trace(self, function: Any, rays: Rays, dtype: numpy.dtype, threads: int) -> NDArray:
        out, data = numpy.empty(len(rays), dtype), rays._array.ctypes.data
        starts = iter(range(0, len(out), _CHUNK))  # which threads take in turn

        def work(_: int) -> None:
            tracer = _new("tracer", self._handle, "tracer_new", self._handle)
            for i in starts:
                function(tracer, data + i * _RAY.itemsize, min(_CHUNK, len(out) - i), out.ctypes.data + i * dtype.itemsize, None)

        workers = max(1, min(_checked(threads=threads)[0] or len(os.sched_getaffinity(0)), -(-len(out) // _CHUNK)))
        with concurrent.futures.ThreadPoolExecutor(workers) as pool:
            list(pool.map(work, range(workers)) if workers > 1 else map(work, range(workers)))
        _call("accelerator_check", self._handle)
        return out

    def counts(self, rays: RaysLike, threads: int = 0) -> NDArray:
        """What each ray costs, traced by itself: (N,) of COUNTS. The kind of rays is their query: arrays ask for nearest hits,
        `Rays(array, "occlusion")` for any. Refused for `embree`, and plugins, that do not count the same everywhere."""
        rays = _rays(rays)
        out = numpy.empty(len(rays), COUNTS)
        _call("count_each", self._handle, rays._handle, *_checked(threads=threads), out.ctypes.data, len(COUNTERS))
        return out


def time_all(accelerators: Sequence[Accelerator], rays: RaysLike, rounds: int = 10, least: float = 0.02,
             threads: int = 1, seed: int = 1) -> NDArray:
    """Times accelerators of one scene on the same rays, in interleaved rounds of at least `least` seconds, in random order:
    (len(accelerators),) of TIME. times["seconds"] is per ray, of the processor, or by the clock with several threads;
    times["ratio"] is throughput over that of the first accelerator, paired by rounds; each is an ESTIMATE."""
    rays, out = _rays(rays), numpy.zeros(len(accelerators), TIME)
    handles = (ctypes.c_void_p * len(out))(*(accelerator._handle.value for accelerator in accelerators))
    how = _options("IdiQ", *_checked(rounds=rounds), float(least), *_checked(threads=threads, seed=seed))
    _call("time_all", handles, len(out), rays._handle, how, out.ctypes.data)
    return out
