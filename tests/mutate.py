#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Do the tests and `raytally verify` find faults that chance makes?

A mutant is the tree with one token of accel/ or src/core/shape/ changed: an operator, a sign, a constant, a
minimum for a maximum. N of all mutants are picked at random. Each is compiled in a copy of the tree,
build/mutants, and run until something fails: the tests of its directory, the golden counts and
`raytally verify --quick`, the shortest first; then `raytally verify` and all tests of accelerators. A test that takes ten
times as long as usual fails, too. If the compiler makes the same code as before, the mutant is equivalent. A mutant that
survives is explained by a line of tests/mutants.tsv (tests/faults/README.md) or is a hole in the tests.

accel/plugin is left out: it passes data between processes, and check_plugins.sh tests it with faulty plugins.
"""
import argparse
import bisect
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
COPY = os.path.join(HERE, "build/mutants")
BUILD = os.path.join(COPY, "build")
RESULTS = os.path.join(COPY, "results.tsv")
TABLE = os.path.join(HERE, "tests/mutants.tsv")
PROGRAMS = ["raytally", "test_accel", "test_shape", "test_scene", "test_exact", "test_verify"]
LIBRARIES = ["shape", "accel"]  # with what they hold of kernels; these, and tests of a header, are compiled anew
MEMORY = 12 << 30  # bytes of address space; a mutant that wants more fails

# What tests a directory: groups of test_accel, the shortest first, and specs for `verify`. The longest prefix of a
# path counts.
SUBJECTS = {
    "accel/": ("best counters overlays extents error_bounds watertight builds lanes",
               "bvh wide ideal cache+bvh extents:kind=sphere"),
    "accel/brute/": ("lanes", "bvh"),
    "accel/bvh/": ("trees bvh bvh_spatial", "bvh bvh:build=spatial"),
    "accel/clusters/": ("trees clusters", "clusters clusters:width=4 clusters:extent=sphere"),
    "accel/embree/": ("embree embree_native embree_user", "embree embree:mode=user embree:mode=user,query=stream"),
    "accel/extent.": ("extents error_bounds largest_errors extents_exact clusters",
                      "extents:kind=sphere extents:kind=obb extents:kind=slabs clusters:extent=sphere"),
    "accel/extents/": ("extents extents_exact", "extents extents:lanes=1 extents:kind=sphere"),
    "accel/grid/": ("grid overlap nested_grid", "grid grid:depth=2 grid:overlap=exact"),
    "accel/item/": ("error_bounds largest_errors item_exact item", "item+bvh item:settle=off+bvh"),
    "accel/kd/": ("overlap kd", "kd kd:overlap=exact"),
    "accel/light/": ("light_exact light_cells error_bounds light", "light+bvh light:cells=16,longest=1+bvh"),
    "accel/octree/": ("octree", "octree octree:traversal=points octree:traversal=neighbours"),
    "accel/raster/": ("item_exact light_exact light_cells item light", "item+bvh light+bvh"),
    "accel/sphere_": ("error_bounds largest_errors lanes wide wide_exact", "wide brute"),
    "accel/surface.": ("overlap kd", "kd:overlap=exact grid:overlap=exact"),
    "accel/tree/": ("trees quality predictions reinsertion bvh tree_orders bvh_spatial builds clusters",
                    "bvh bvh:build=spatial clusters:method=goldsmith-salmon"),
    "accel/wide/": ("wide_layout wide leaves wide_exact watertight", "wide wide:build=spatial,sharing=0"),
    "src/core/shape/": ("overlap extents_exact csg_memory", "bvh clusters:extent=sphere kd:overlap=exact embree"),
}


def fail(message):
    print(f"mutate.py: {message}", file=sys.stderr)
    raise SystemExit(2)


# ---- mutants ----

SWAPS = {"<": ["<=", ">"], "<=": ["<", ">="], ">": [">=", "<"], ">=": [">", "<="], "==": ["!="], "!=": ["=="],
         "&&": ["||"], "||": ["&&"], "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["*"], "&": ["|"],
         "|": ["&"], "<<": [">>"], ">>": ["<<"], "+=": ["-="], "-=": ["+="], "*=": ["/="], "/=": ["*="],
         "&=": ["|="], "|=": ["&="], "++": ["--"], "--": ["++"]}
PAIRS = ["rt_minf rt_maxf", "rt_min rt_max", "rt_vec_min rt_vec_max", "fmin fmax", "floor ceil", "true false", "lo hi",
         "rt_float_below rt_float_above", "rt_lt_bits rt_le_bits"]
NAMES = {a: b for pair in PAIRS for a, b in (pair.split(), pair.split()[::-1])}
TOKEN = re.compile(r"""
    (?P<binary> (?<=[ ]) (?:<=|>=|==|!=|<<=?|>>=?|&&|\|\||[-+*/&|]=|[-<>+*/%&|]) (?=[ \n]))
  | (?P<step>   \+\+|--)
  | (?P<unary>  (?<=[(\[ ,]) [-!~] (?=[\w(]))
  | (?P<number> (?<![\w.]) (?:0x[\da-fA-F.]+p[-+]?\d+|\d+\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+|0x[\da-fA-F]+|\d+) [fuUlL]* \b)
  | (?P<name>   (?<!\w) (?:NAMES) \b)""".replace("NAMES", "|".join(NAMES)), re.VERBOSE)
BLANKED = re.compile(r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.DOTALL)
TABLE_MACRO = re.compile(r'#define(?:[^\n]*\\\n)*[^\n]*"')  # tables of parameters and names


def alternatives(match):
    """What may stand in the place of a token."""
    kind, token = match.lastgroup, match.group()
    if kind in ("binary", "step"):
        return SWAPS.get(token, [])
    if kind == "unary":
        return [""]
    if kind == "name":
        return [NAMES[token]]
    digits = token.rstrip("fuUlL") if not token.startswith("0x") or "p" in token else token.rstrip("uUlL")
    suffix = token[len(digits):]
    if "p" in digits or "." in digits or ("e" in digits and not digits.startswith("0x")):
        return [f"({token} * 0x1.ep-1f)", f"({token} / 2)", f"({token} * 2)"]
    value = int(digits, 0)
    return [f"{value + by}{suffix}" for by in (-1, 1) if value + by >= 0]


def blank(match):
    return re.sub(r"[^\n]", " ", match.group())


def code_of(path, source):
    """The source, with blanks for what is not mutated: comments, texts, directives, tables of parameters; and
    in headers what is outside of functions, since not all that includes them is compiled anew."""
    source = TABLE_MACRO.sub(blank, BLANKED.sub(lambda m: m.group() if m.group()[0] == '"' else blank(m), source))
    source = BLANKED.sub(blank, source)
    source = re.sub(r"(?m)^ *#(?! *define)[^\n]*", blank, source)
    source = re.sub(r"(?m)^( *# *define +\w+)(?=[ (])(\([^)\n]*\))?", blank, source)
    if path.endswith(".h"):
        inside, depth, kept = [], 0, list(source)
        for i, c in enumerate(source):
            if c == "{":
                depth += 1
                inside.append(bool(inside and inside[-1]) or source[:i].rstrip().endswith((")", "\\")))
            elif c == "}" and inside:
                inside.pop()
            elif not (inside and inside[-1]) and not re.match(r"[\n]", c):
                kept[i] = " " if not line_is_constant(source, i) else c
        source = "".join(kept)
    return source


def line_is_constant(source, at):
    """Is this in the value of an object-like macro of one line, like 0x1p-50?"""
    begin, end = source.rfind("\n", 0, at) + 1, source.find("\n", at)
    return re.fullmatch(r" +-?0x1\.?[\da-f]*p[-+]?\d+f? *", source[begin:end]) is not None


class Mutant:
    def __init__(self, path, source, starts, match, new):
        self.path, self.new, self.begin, self.end = path, new, match.start(), match.end()
        line = bisect.bisect_right(starts, self.begin)
        end = source.find("\n", self.begin)
        self.line = line
        whole = source[starts[line - 1]:end]
        at = self.begin - starts[line - 1]
        self.text = " ".join(whole.split())
        self.instead = " ".join((whole[:at] + new + whole[at + len(match.group()):]).split())

    def apply(self, source):
        return source[:self.begin] + self.new + source[self.end:]


def all_mutants():
    listed = subprocess.run(["git", "-C", HERE, "ls-files", "accel", "src/core/shape"], check=True,
                            capture_output=True, text=True).stdout.split()
    for path in sorted(listed):
        if not path.endswith((".c", ".h")) or path.startswith("accel/plugin"):
            continue
        with open(os.path.join(HERE, path)) as file:
            source = file.read()
        starts = [0] + [m.end() for m in re.finditer("\n", source)]
        for match in TOKEN.finditer(code_of(path, source)):
            for new in alternatives(match):
                yield Mutant(path, source, starts, match, new)


# ---- building ----

def shell(command, cwd, limit=None, program="raytally"):
    """Runs a command in a process group of its own; returns its exit code, or None after `limit` seconds."""
    def bounded():
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    env = dict(os.environ, CCACHE_DISABLE="1", RT_PROGRAM=os.path.join(BUILD, program))
    with open(os.path.join(COPY, "log"), "w") as log:
        process = subprocess.Popen(command, shell=isinstance(command, str), cwd=cwd, env=env, stdout=log,
                                   stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, start_new_session=True,
                                   preexec_fn=bounded)
        try:
            return process.wait(limit)
        except subprocess.TimeoutExpired:
            return None
        finally:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()


def ninja(*arguments):
    return subprocess.run(["ninja", "-C", BUILD, *arguments], check=True, capture_output=True, text=True).stdout


def included_by_tests(paths):
    """The headers that a test, or what it includes of tests/, includes itself: it tests what is in them."""
    included = set()
    for path in paths:
        if path.startswith("tests/"):
            with open(os.path.join(COPY, path)) as file:
                included |= set(re.findall(r'#include "((?:accel|core/shape)/[^"]*)"', file.read()))
    return [path for path in paths if path.removeprefix("src/") in included]


class Tree:
    """The copy, built, and how to build parts of it anew without ninja, which would build more."""

    def __init__(self, jobs):
        os.makedirs(COPY, exist_ok=True)
        script = 'here=$1; source "$1/tests/faults/copy.sh"; copy_tree "$2"; configure "$2"; ninja -C "$2/build" -j "$3" "${@:4}"'
        with open(os.path.join(COPY, "build.log"), "w") as log:
            if subprocess.run(["bash", "-euc", script, "-", HERE, COPY, str(jobs), *PROGRAMS], stdout=log,
                              stderr=log).returncode:
                fail(f"the tree does not build: {log.name}")
        for name in ("experiment.yaml", "counts.csv"):  # the copy has kernels for one instruction set alone
            path = os.path.join(COPY, "tests/golden", name)
            with open(path) as file:
                lines = [line for line in file if "isa=portable" not in line]
            with open(path, "w") as file:
                file.writelines(lines)
        ours = re.compile(r"CMakeFiles/(raytally_(%s|kernels_\w+)|test_\w+)\.dir/" % "|".join(LIBRARIES))
        commands = json.loads(ninja("-t", "compdb"))
        self.compile = {entry["output"]: entry["command"] for entry in commands if ours.match(entry["output"])}
        self.objects = {}  # of each file, those to compile
        for block in ninja("-t", "deps").split("\n\n"):
            output, *files = block.split("\n")
            output = output.split(":")[0]
            if output not in self.compile:
                continue
            paths = [os.path.relpath(os.path.join(BUILD, file.strip()), COPY) for file in files]
            if output.startswith("CMakeFiles/test_"):
                paths = included_by_tests(paths)
            for path in paths:
                self.objects.setdefault(path, []).append(output)
        for program in PROGRAMS:
            shutil.copy2(os.path.join(BUILD, program), os.path.join(BUILD, program + ".clean"))
        self.link = {target: ninja("-t", "commands", "-s", target).strip() for target in
                     PROGRAMS + [f"libraytally_{name}.a" for name in LIBRARIES]}

    def build(self, target):
        if shell(self.link[target], BUILD) != 0:
            fail(f"{target} does not link: {COPY}/log")


def try_mutant(tree, mutant, steps):
    """Returns killed (by what), survived, equivalent, or does not compile."""
    path = os.path.join(COPY, mutant.path)
    objects = [os.path.join(BUILD, o) for o in tree.objects.get(mutant.path, [])]
    date = os.stat(path)
    with open(path) as file:
        source = file.read()
    try:
        with open(path, "w") as file:
            file.write(mutant.apply(source))
        changed = False
        for o in objects:
            os.rename(o, o + ".before")
        for o in objects:
            if shell(tree.compile[os.path.relpath(o, BUILD)], BUILD) != 0:
                return "does not compile"
            changed |= subprocess.run(["cmp", "-s", o, o + ".before"]).returncode != 0
        return run_steps(tree, steps) if changed else "equivalent"
    finally:
        for o in objects:
            if os.path.exists(o + ".before"):
                os.replace(o + ".before", o)
        with open(path, "w") as file:
            file.write(source)
        os.utime(path, ns=(date.st_atime_ns, date.st_mtime_ns))


# ---- tests ----

usual_times = {}  # of the steps that were run without a fault, in seconds


class Step:
    def __init__(self, name, command, program):
        self.name, self.command, self.program = name, command, program

    def limit(self):
        """From the time that the step takes without a fault."""
        key = tuple(self.command)
        if key not in usual_times:
            began = time.monotonic()
            clean = [word + ".clean" if word == "build/" + self.program else word for word in self.command]
            if shell(clean, COPY, program="raytally.clean") not in (0, 77):
                fail(f"{' '.join(key)} fails without a fault: {COPY}/log")
            usual_times[key] = time.monotonic() - began
        return 20 + 10 * usual_times[key]

    def run(self):
        return shell(self.command, COPY, self.limit())


def steps_for(path):
    """The short ones, each for a group of tests or an accelerator, and the long ones: what fails soon comes first."""
    groups, specs = SUBJECTS[max((p for p in SUBJECTS if path.startswith(p)), key=len)]
    verify = ["build/raytally", "verify", "--seed=1"]
    short = []
    if path.startswith("src/core/shape/"):
        for group in "bounds csg csg_points csg_trees hits shape solid_cases solid_faces solids triangle".split():
            short.append(Step("tests", ["build/test_shape", group], "test_shape"))
        short.append(Step("tests", ["build/test_scene", "csg_scene"], "test_scene"))
        for group in "border referee exact_mesh exact_trees".split():
            short.append(Step("tests", ["build/test_exact", group], "test_exact"))
    short += [Step("tests", ["build/test_accel", group], "test_accel") for group in groups.split()]
    short += [Step("quick verify", [*verify, "--quick", "--accel", spec], "raytally") for spec in specs.split()]
    short.append(Step("counts", ["tests/check_counts.sh"], "raytally"))
    long = [Step("verify", [*verify, "--accel", spec], "raytally") for spec in specs.split()]
    long.append(Step("all tests", ["build/test_verify", "conformance", "counter_sums"], "test_verify"))
    long.append(Step("all tests", ["build/test_accel"], "test_accel"))
    return short, long


def run_steps(tree, steps):
    for name in LIBRARIES:
        tree.build(f"libraytally_{name}.a")
    built = set()
    for step in steps:
        if step.program not in built:
            tree.build(step.program)
            built.add(step.program)
        code = step.run()
        if code is None:
            return f"killed: {step.name} (time)"
        if code not in (0, 77):
            return f"killed: {step.name}" + (" (crash)" if code < 0 or code > 128 else "")
    return "survived"


# ---- the run ----

def read_table():
    """What explains the survivors: (file, text, instead) to the reason."""
    with open(TABLE) as file:
        rows = [line.rstrip("\n").split("\t") for line in file if not line.startswith("#")]
    return {tuple(row[:3]): row[3] for row in rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=500, help="how many mutants (default 500)")
    parser.add_argument("--first", type=int, default=1, help="begin with this one of them, to continue a run")
    parser.add_argument("--seed", type=int, default=1, help="which ones (default 1)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processors for the first build")
    parser.add_argument("--quick", action="store_true", help="leave out the last: verify in full, and all tests")
    parser.add_argument("--list", action="store_true", help="print the mutants, and do nothing")
    parser.add_argument("paths", nargs="*", help="mutate only files whose path begins with one of these")
    options = parser.parse_args()

    mutants = [m for m in all_mutants() if m.path.startswith(tuple(options.paths) or "")]
    possible = len(mutants)
    mutants = random.Random(options.seed).sample(mutants, min(options.count, possible))[options.first - 1:]
    if options.list:
        for m in mutants:
            print(m.path, m.line, m.text, m.instead, sep="\t")
        return 0
    explained, counts, left = read_table(), {}, 0
    tree = Tree(options.jobs)
    with open(RESULTS, "a" if options.first > 1 else "w") as results:
        for number, m in enumerate(mutants, options.first):
            began = time.monotonic()
            short, long = steps_for(m.path)
            verdict = try_mutant(tree, m, short if options.quick else short + long)
            if verdict == "survived" and (m.path, m.text, m.instead) in explained:
                verdict = "explained"
            left += verdict == "survived"
            counts[verdict] = counts.get(verdict, 0) + 1
            print(number, verdict, f"{time.monotonic() - began:.1f}", m.path, m.line, m.text, m.instead, sep="\t",
                  file=results, flush=True)
            if sys.stderr.isatty() or verdict == "survived":
                print(f"[{number}/{options.count}] {verdict}: {m.path}:{m.line}: {m.instead}", file=sys.stderr)
    killed = sum(n for verdict, n in counts.items() if verdict.startswith("killed"))
    print(f"{len(mutants)} of {possible} mutants, seed {options.seed}:")
    for verdict, n in sorted(counts.items(), key=lambda item: -item[1]):
        print(f"{n:6d}  {verdict}")
    if killed + left > 0:
        print(f"{killed} of {killed + left} that change an answer or a count are killed ({100 * killed / (killed + left):.1f} %)")
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
