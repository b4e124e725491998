# SPDX-License-Identifier: Apache-2.0
"""python/raytally.py against the program, definitions and hand-computed hits. tests/check_python.sh runs this, with
$RT_PROGRAM, $RAYTALLY_LIBRARY and $RT_PLUGINS, in a scratch directory."""
import concurrent.futures
import csv
import gc
import inspect
import os
import re
import shutil
import subprocess
import sys
import unittest
import unittest.mock

import numpy

import raytally

TREE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../..")
DOWN = [0, 0, -1]


def program(*arguments):
    subprocess.run([os.environ["RT_PROGRAM"], *arguments], check=True, stdout=subprocess.DEVNULL)


def two_objects():
    """A triangle at z = 0, and a sphere of radius 1 around (0, 0, -3)."""
    return raytally.Scene.from_arrays([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]], [[0, 0, -3, 1]])


def rays_from(*origins):
    rays = numpy.zeros((len(origins), 8), "float32")
    rays[:, 0:3], rays[:, 4:7], rays[:, 7] = origins, DOWN, numpy.inf
    return rays


class Case(unittest.TestCase):
    def assert_refused(self, says, function, *arguments, **named):
        with self.assertRaisesRegex(raytally.RaytallyError, says):
            function(*arguments, **named)

    def assert_same(self, first, second):
        """The same bits."""
        self.assertEqual(first.tobytes(), second.tobytes())


class Program(Case):
    """The module's answers are the program's."""

    @classmethod
    def setUpClass(cls):
        cls.scene = raytally.Scene("balls:size=2")
        cls.scene.set_sampling(64, 64)
        cls.accel = cls.scene.accelerator("grid:density=4")
        cls.of = ["balls:size=2", "--size", "64x64"]

    def check_kind(self, kind, answers_of):
        program("rays", *self.of, "--rays", kind, "-o", "rays.npy")
        program("bench", *self.of, "--rays", kind, "--accel", "grid:density=4", "--count-only", "--hits", "hits.npy", "--csv",
                "counts.csv")
        with open("counts.csv", encoding="utf-8") as file:
            table = next(csv.DictReader(file))
        rays, hits = self.accel.record(kind), numpy.load("hits.npy")
        answers, counted = answers_of(rays), self.accel.counts(rays)
        self.assert_same(numpy.asarray(rays), numpy.load("rays.npy"))
        self.assertEqual(f"{rays.fingerprint:016x}", table["set_hash"])
        for name in hits.dtype.names or [...]:
            self.assertTrue((answers[name] == hits[name]).all())
        self.assertEqual(self.accel.spec, table["spec"])
        for name in raytally.COUNTERS:
            self.assertEqual(counted[name].sum(), int(table[name]))
        structure = self.accel.describe()
        self.assertEqual([structure[name] for name in ("leaves", "references", "depth", "bytes")],
                         [int(table[name]) for name in ("leaves", "references", "structure_depth", "bytes")])

    def test_hits_and_counts_of_nearest_are_those_of_bench(self):
        self.check_kind("diffuse", self.accel.nearest)

    def test_answers_and_counts_of_occluded_are_those_of_bench(self):
        self.check_kind("shadow", self.accel.occluded)

    def test_all_accelerators_answer_like_brute(self):
        rays = self.accel.record("random", limit=3000)
        truth = self.scene.accelerator("brute").nearest(rays)
        self.assertTrue(0 < (truth["object"] < 0).sum() < len(rays))
        self.assertTrue(numpy.isinf(truth["t"][truth["object"] == -1]).all())
        self.assertTrue({"brute", "bvh", "kd"} <= set(raytally.accelerators()))
        for spec in ("bvh", "kd", "wide", "ideal", "item+light+octree"):
            accel = self.scene.accelerator(spec)
            self.assertTrue(accel.exact)
            self.assert_same(accel.nearest(rays), truth)
            self.assertTrue((accel.occluded(rays) == (truth["object"] >= 0)).all())

    def test_recorded_rays_know_their_samples_and_arrays_do_not(self):
        item = self.scene.accelerator("item+bvh")
        rays = item.record("primary")
        self.assertEqual(item.counts(rays)["passed_on"].sum(), 0)
        self.assertGreater(item.counts(raytally.Rays(rays, "primary"))["passed_on"].sum(), 4000)

    def test_the_source_of_a_primary_ray_is_its_sample(self):
        rays = self.accel.record("primary")
        self.assertEqual(sorted(rays.source), list(range(64 * 64)))
        self.assertNotEqual(list(rays.source), sorted(rays.source))
        directions = numpy.empty((64 * 64, 3))
        directions[rays.source] = numpy.asarray(rays)[:, 4:7]
        across = directions.reshape(64, 64, 3)
        for steps in (numpy.diff(across, axis=0), numpy.diff(across, axis=1)):  # the same everywhere in the image
            self.assertTrue((abs(steps - steps[0, 0]) < 1e-5).all())
        self.assertEqual(set(self.accel.record("diffuse").source), set(rays.source[self.accel.occluded(rays)]))
        self.assertEqual(set(self.accel.record("shadow").source), {0, 1, 2})  # lights
        self.assertEqual(set(self.accel.record("reflection").source), {0})

    def test_chosen_rays_keep_their_kind_and_source(self):
        item = self.scene.accelerator("item+bvh")
        rays, array = item.record("primary"), numpy.asarray(item.record("primary"))
        for index in (slice(3, 900, 7), rays.source % 5 == 0, [9, 9, 2], numpy.array([-1]), []):
            index = numpy.array(index, int) if isinstance(index, list) else index
            chosen = rays[index]
            self.assertEqual(chosen.kind, "primary")
            self.assert_same(numpy.asarray(chosen), array[index])
            self.assert_same(chosen.source, rays.source[index])
            with self.assertRaises(ValueError):
                chosen.source[...] = 7
            self.assertEqual(item.counts(chosen)["passed_on"].sum(), 0)
        self.assertEqual((len(rays[5]), rays[5].source[0]), (1, rays.source[5]))
        self.assertEqual(len(list(rays[:3])), 3)

    def test_rays_are_verified(self):
        result = self.scene.verify("kd", 300)
        self.assertEqual((result["rays"], result["equal"], result["wrong"]), (300, 300, 0))
        self.assertEqual(self.scene.verify("kd", rays_from([2, 2, 9], [0, 0, 9]))["equal"], 2)

    def test_times_have_the_first_as_their_measure(self):
        accels = [self.accel, self.scene.accelerator("bvh")]
        times = raytally.time_all(accels, self.accel.record("primary", limit=1000), rounds=6, least=0)
        self.assertEqual(times.shape, (2,))
        self.assertEqual(times["ratio"]["median"][0], 1)
        for each in times["seconds"]:
            self.assertTrue(0 < each["least"] <= each["low"] <= each["median"] <= each["high"] < 1)
            self.assertGreaterEqual(each["coverage"], 0.95)
        self.assertTrue(0 < self.accel.build_seconds < 60)
        self.assert_refused("0 and 1 are built over different scenes", raytally.time_all,
                            [self.accel, two_objects().accelerator("bvh")], rays_from([0, 0, 5]))

    def test_counts_of_ideal_are_one_test_for_each_ray_that_hits(self):
        ideal = self.scene.accelerator("ideal")
        rays = ideal.record("random", limit=1000)
        counts = ideal.counts(rays)
        self.assertTrue((counts["object_tests"] == (ideal.nearest(rays)["object"] >= 0)).all())


class Arrays(Case):
    def test_hits_are_those_computed_by_hand(self):
        scene = two_objects()
        self.assertEqual(scene.object_count, 2)
        self.assertTrue((scene.bounds[:, 1] == [-1, 1]).all())
        accel, rays = scene.accelerator("bvh"), rays_from([0, 0, 5], [0, 0, -1], [0, 3, 5])
        rays[1, 6] = -0.5  # t is in lengths of the direction
        hits = accel.nearest(rays)
        self.assertEqual(hits.tolist(), [(5, 0), (2, 1), (numpy.inf, -1)])
        self.assertEqual(accel.occluded(rays).tolist(), [True, True, False])
        rays[0, 3], rays[1, 7] = 6, 1  # tmin, tmax
        self.assertEqual(accel.nearest(rays)["object"].tolist(), [1, -1, -1])
        self.assertEqual(accel.occluded(rays).tolist(), [True, False, False])

    def test_a_kind_decides_which_query_is_counted(self):
        accel, rays = two_objects().accelerator("brute:lanes=1"), rays_from([0, 0, 5])
        self.assertEqual(accel.counts(rays)["object_tests"].tolist(), [2])
        self.assertEqual(accel.counts(raytally.Rays(rays, "occlusion"))["object_tests"].tolist(), [1])

    def test_no_ray_has_no_hit_and_nothing_is_missed(self):
        accel, none = two_objects().accelerator("kd"), numpy.empty((0, 8), "float32")
        for rays in (none, raytally.Rays(none)):
            self.assertEqual((accel.nearest(rays).shape, accel.occluded(rays).shape), ((0,), (0,)))
            self.assertEqual(accel.counts(rays).shape, (0,))
            self.assertEqual(numpy.asarray(raytally.Rays(rays)).shape, (0, 8))
            self.assert_refused("no rays", raytally.time_all, [accel], rays)
        nothing = raytally.Scene.from_arrays()
        self.assertEqual((nothing.object_count, nothing.bounds[0, 0]), (0, numpy.inf))
        self.assertEqual(nothing.accelerator("bvh").nearest(rays_from([0, 0, 5])).tolist(), [(numpy.inf, -1)])

    def test_arrays_need_not_be_contiguous(self):
        accel, generator = two_objects().accelerator("wide"), numpy.random.default_rng(1)
        rays = rays_from(*generator.uniform(-1, 1, (10000, 3)) + [0, 0, 5])
        hits = accel.nearest(rays)
        self.assertTrue(0 < (hits["object"] == 0).sum() < len(rays))
        self.assert_same(accel.nearest(numpy.asfortranarray(rays)), hits)
        self.assert_same(accel.nearest(rays.astype(">f4")), hits)
        self.assert_same(accel.nearest(raytally.Rays(rays)), hits)
        self.assert_same(accel.nearest(numpy.asarray(raytally.Rays(rays))), hits)
        self.assert_same(accel.nearest(rays[::-3]), hits[::-3])
        self.assert_same(accel.nearest(rays[:7].tolist()), hits[:7])

    def test_other_shapes_and_types_are_refused_with_a_remedy(self):
        accel, rays = two_objects().accelerator("bvh"), rays_from([0, 0, 5], [0, 0, 5])
        for use in (accel.nearest, accel.occluded, accel.counts, raytally.Rays):
            self.assert_refused(r"shape \(16,\): expected an array \(N, 8\)", use, rays.ravel())
            self.assert_refused(r"shape \(2, 7\)", use, rays[:, 1:])
            self.assert_refused(r"float64: expected float32, as from array.astype\('float32'\)", use, rays.astype("float64"))
            self.assert_refused("complex", use, rays.astype("complex64"))
            self.assert_refused("rays: MaskedArray", use, numpy.ma.masked_equal(rays, 5))
            self.assert_refused("rays: numbers of type <U", use, [["1"] * 8])
        self.assertEqual(accel.nearest(rays.astype("float16"))["object"].tolist(), [0, 0])
        rays[1, 4:7] = 0
        self.assert_refused(r"ray 1 \(the first is 0\) is not valid: its direction is zero", accel.nearest, rays)
        for corner in (-1, 2**32):
            self.assert_refused(f"triangles={corner}: expected an integer in 0..4294967295", raytally.Scene.from_arrays,
                                [[0, 0, 0]], [[0, 0, corner]])
        self.assert_refused("float64: expected integers", raytally.Scene.from_arrays, [[0, 0, 0]], [[0, 0, 0.5]])
        self.assert_refused("corner 2 is vertex 3", raytally.Scene.from_arrays, [[0, 0, 0]] * 3, [[0, 1, 3]])
        self.assert_refused("sphere 0", raytally.Scene.from_arrays, spheres=[[0, 0, 0, 0]])
        self.assert_refused(r"vertices: .*\(N, 3\)", raytally.Scene.from_arrays, [[0, 0]])


class Errors(Case):
    def test_what_is_wrong_is_said(self):
        scene = two_objects()
        accel = scene.accelerator("bvh")
        self.assert_refused("balls", raytally.Scene, "bals")
        self.assert_refused("nowhere.obj", raytally.Scene, "nowhere.obj")
        self.assert_refused("grid", scene.accelerator, "gird")
        self.assert_refused("grid", scene.verify, "gird")
        self.assert_refused("'shade' is not a kind of rays: expected one of primary, ", accel.record, "shade")
        self.assert_refused("limit of 0 rays", accel.record, limit=0)
        for limit in (-1, 1e5, "7", 2**64):
            self.assert_refused(f"limit={limit!r}: expected an integer", accel.record, limit=limit)
        for threads in (-1, 2**40, 2.0):
            says = f"threads={threads}: expected an integer in 0..1024"
            for function in (accel.nearest, accel.counts, lambda rays, threads: accel.record(threads=threads)):
                self.assert_refused(says, function, rays_from([0, 0, 5]), threads=threads)
            self.assert_refused(says, scene.accelerator, "bvh", threads=threads)
            self.assert_refused(says, scene.verify, "bvh", threads=threads)
            self.assert_refused(says, raytally.time_all, [accel], rays_from([0, 0, 5]), threads=threads)
        self.assert_refused("width=4294967312", two_objects().set_sampling, 2**32 + 16, 16)
        for function in (raytally.Scene, scene.accelerator, scene.verify, raytally.load_plugin):
            self.assert_refused("no zero character", function, "bvh\0")
        self.assert_refused("eye, at, up: .*type <U", two_objects().set_camera, [*"009"], [*"000"], [*"010"], 40)
        self.assert_refused("eye, at, up: ", two_objects().set_camera, [0, 9], [0, 0], [0, 1], 40)
        accel.nearest(rays_from([0, 0, 5]), threads=numpy.int8(1))
        self.assert_refused("no accelerator", raytally.time_all, [], rays_from([0, 0, 5]))
        self.assert_refused("up", lambda: two_objects().set_camera([0, 0, 9], [0, 0, 0], [0, 0, 1], 40))
        self.assert_refused("nowhere.so", raytally.load_plugin, "nowhere.so")
        try:
            scene.verify("gird")
        except raytally.RaytallyError as error:
            self.assertIsNone(error.result)

    def test_a_plugin_that_answers_wrongly_or_crashes_is_an_error(self):
        raytally.load_plugin(os.path.join(os.environ["RT_PLUGINS"], "faulty.so"))
        scene = raytally.Scene("balls:size=1")
        with self.assertRaisesRegex(raytally.RaytallyError, "differs from brute") as raised:
            scene.verify("faulty-own-wrong", 500)
        self.assertGreater(raised.exception.result["wrong"], 0)
        self.assertEqual(raised.exception.result["rays"], 500)
        raytally.load_plugin(os.path.join(os.environ["RT_PLUGINS"], "own_hits.so"))
        uncounted = scene.accelerator("own-unnamed", threads=1)
        self.assert_refused("own-unnamed does not count", uncounted.counts, rays_from([0, 0, 5]))
        crashing = scene.accelerator("faulty-crash-rare", threads=1)
        self.assert_refused("it crashed", crashing.nearest, scene.accelerator("bvh").record(), threads=1)

    def test_warnings_of_a_file_have_their_places(self):
        with open("odd.obj", "w", encoding="utf-8") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n")
        warnings = raytally.Scene("odd.obj").warnings
        self.assertEqual(len(warnings), 1)
        self.assertIn("odd.obj:5: face 1", warnings[0])
        self.assertEqual(two_objects().warnings, [])


class Lifetimes(Case):
    def test_an_accelerator_keeps_its_scene_and_a_view_its_rays(self):
        accel = two_objects().accelerator("bvh")
        view = numpy.asarray(raytally.Rays(rays_from([0, 0, 5])))
        gc.collect()
        self.assertEqual(accel.nearest(view).tolist(), [(5, 0)])
        self.assertEqual(accel.scene.object_count, 2)
        self.assertEqual(numpy.asarray(raytally.Rays(view))[0, 2], 5)
        self.assertEqual(raytally.Rays(view).source.tolist(), [0])
        with self.assertRaises(ValueError):
            view[0] = 0

    def test_what_nobody_uses_is_freed(self):
        scene = two_objects()
        accel = scene.accelerator("bvh")
        self.assert_refused("free them first", scene.set_sampling, 8, 8)
        del accel
        scene.set_sampling(8, 8, 2)
        scene.set_camera([0, 0, 9], numpy.zeros(3), (0, 1, 0), 40)
        accel = scene.accelerator("bvh")
        self.assertEqual(len(accel.record()), 8 * 8 * 2 * 2)
        self.assertEqual(numpy.asarray(accel.record())[0, 2], 9)

    def test_in_a_cycle_an_accelerator_is_freed_before_its_scene(self):
        freed = []
        library = raytally._library
        with unittest.mock.patch.object(raytally, "_library") as watched:
            for name in raytally._FUNCTIONS:
                setattr(watched, "raytally_" + name, getattr(library, "raytally_" + name))
            for what in ("scene", "accelerator"):
                setattr(watched, f"raytally_{what}_free", lambda handle, what=what: freed.append(what) or
                        getattr(library, f"raytally_{what}_free")(handle))
            for _ in range(20):
                accel = two_objects().accelerator("bvh")
                accel.scene.of = cycle = [accel]
                cycle.append(cycle)
                del accel, cycle
                gc.collect()
        self.assertEqual(freed, ["accelerator", "scene"] * 20)

    def test_threads_share_what_they_trace(self):
        scene = raytally.Scene("balls:size=2")
        scene.set_sampling(128, 128)
        rays = scene.accelerator("bvh").record("diffuse")
        for spec in ("wide", "ideal"):
            accel = scene.accelerator(spec)
            hits, counts = accel.nearest(rays, threads=1), accel.counts(rays, threads=1)
            with concurrent.futures.ThreadPoolExecutor(8) as pool:
                for each in pool.map(lambda i: accel.counts(rays) if i % 3 else accel.nearest(rays, threads=i % 4), range(12)):
                    self.assert_same(each, counts if each.dtype == raytally.COUNTS else hits)


class Library(Case):
    def run_python(self, code, **environment):
        return subprocess.run([sys.executable, "-c", code], env={**os.environ, **environment}, capture_output=True, text=True,
                              check=False)

    def test_it_is_found_where_it_was_installed(self):
        os.makedirs("prefix/lib/python3/dist-packages")
        shutil.copy(raytally.__file__, "prefix/lib/python3/dist-packages")
        installed = os.path.abspath("prefix/lib/libraytally.so.1")
        os.symlink(os.path.abspath(os.environ["RAYTALLY_LIBRARY"]), installed)
        found = self.run_python("import raytally; print(raytally._library._name)", RAYTALLY_LIBRARY="",
                                PYTHONPATH=os.path.abspath("prefix/lib/python3/dist-packages"))
        self.assertTrue(os.path.samefile(found.stdout.strip(), installed), found.stderr)

    def test_without_numpy_the_import_says_what_to_do(self):
        failed = self.run_python("import sys; sys.modules['numpy'] = None; import raytally")
        self.assertRegex(failed.stderr, "ImportError: .*raytally needs NumPy: Debian's python3-numpy")

    def test_without_it_the_import_says_what_to_do(self):
        for path, says in (("/no/such.so", "no/such.so"), ("libm.so.6", "raytally_abi_version")):
            failed = self.run_python("import raytally", RAYTALLY_LIBRARY=path)
            self.assertRegex(failed.stderr, f"ImportError: .*{says}.*: set RAYTALLY_LIBRARY to the path of libraytally.so.1")
        with unittest.mock.patch("ctypes.CDLL") as other:
            other.return_value.raytally_abi_version.return_value = 2
            with self.assertRaisesRegex(ImportError, "interface 2: expected 1"):
                raytally._load()

    def test_functions_have_the_types_and_structs_the_sizes_of_the_header(self):
        with open(os.path.join(TREE, "tests/library/interface_1.txt"), encoding="utf-8") as file:
            record = file.read()
        types = [(r"void", "-"), (r"const char \*", "s"), (r".*\*.*", "p"), (r"bool", "b"), (r"uint32_t", "u"),
                 (r"size_t|uint64_t", "z"), (r"int|enum .*|raytally_status", "i")]

        def letter(name):
            return next(letter for pattern, letter in types if re.fullmatch(pattern, name))

        for name, known in raytally._FUNCTIONS.items():
            result, parameters = re.search(rf"^function raytally_{name} (.*)\((.*)\)$", record, re.MULTILINE).groups()
            wanted = "".join(map(letter, [result, *(p for p in parameters.split(", ") if p != "void")]))
            self.assertEqual(known, wanted, name)
        for struct, layout in (("objects", "PIPIPII"), ("record_options", "IiQQ"), ("verify_options", "QQiP"),
                               ("time_options", "IdiQ")):
            size = int(re.search(rf"^grows raytally_{struct} (\d+)$", record, re.MULTILINE)[1])
            self.assertEqual(len(raytally._options(layout, *[0] * len(layout))), size)
        for struct, dtype in (("ray", raytally._RAY), ("hit", raytally.HIT), ("estimate", raytally.ESTIMATE), ("time", raytally.TIME)):
            self.assertEqual(dtype.itemsize, int(re.search(rf"^fixed raytally_{struct} (\d+)$", record, re.MULTILINE)[1]))
        self.assertIn(f"value RAYTALLY_WARNING_CHARS {raytally._WARNING}\n", record)

    def test_everything_public_is_named(self):
        public = {name for name, member in vars(raytally).items() if name[0] != "_"
                  and not inspect.ismodule(member) and getattr(member, "__module__", "raytally") in ("raytally", None)}
        self.assertLessEqual(public, set(raytally.__all__) | {"annotations"})
        self.assertLessEqual({*raytally.__all__}, {*vars(raytally)})
        for name in ("HIT", "COUNTS", "ESTIMATE", "TIME", "KINDS", *raytally.COUNTERS):
            self.assertRegex(raytally.__doc__, rf"\b{name}\b")

    def test_everything_public_has_a_docstring(self):
        members = [member for _, owner in inspect.getmembers(raytally, inspect.isclass) if owner.__module__ == "raytally"
                   for name, member in vars(owner).items() if name[0] != "_"]
        functions = [function for _, function in inspect.getmembers(raytally, inspect.isfunction)]
        for each in members + functions:
            if callable(each) and not each.__name__.startswith("_"):
                self.assertTrue(each.__doc__, each)


if __name__ == "__main__":
    unittest.main()
