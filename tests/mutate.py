#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Do the tests and `raytally verify` find faults that chance makes?

A mutant is the tree with one token of accel/ or src/core/shape/ changed: an operator, a sign, a constant, a
minimum for a maximum. The seed puts all mutants in an order, of which the first N are tried; an edit of the source
changes only the mutants of its lines. Each is compiled in a copy of the tree, and run until a step fails: tests that
concern its file, golden counts, `raytally verify --quick`; first those that killed much in little time. Survivors take
the long steps, too: long tests, `raytally verify`, all tests of accelerators. To take far longer than usual is to fail.
If the compiler makes the same code as before, the mutant is equivalent. Results, and what explains a survivor:
tests/faults/README.md.

accel/plugin is left out: it passes data between processes, and check_plugins.sh tests it with faulty plugins.
"""
import argparse
import collections
import concurrent.futures
import hashlib
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time

HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PLACE = os.path.join(HERE, "build/mutants")  # copies of the tree: 1, 2, ...
RESULTS = os.path.join(PLACE, "results.tsv")
TIMES = os.path.join(PLACE, "times.json")  # of steps without a fault
TABLE = os.path.join(HERE, "tests/mutants.tsv")
PROGRAMS = ["raytally", "test_accel", "test_shape", "test_scene", "test_exact", "test_picture", "test_verify"]
LIBRARIES = ["shape", "accel"]  # with what they hold of kernels; these, and tests of a header, are compiled anew
MEMORY = 4 << 20  # KiB of address space; a mutant that wants more fails
SHORT = 6  # seconds of processor time: a step that takes longer is a long one
LONGEST = 600  # seconds of processor time of a long step, and of a compiler

# What tests a file: groups of test_accel, and specs for `verify` and for the golden counts. The longest prefix of its
# path counts.
SUBJECTS = {
    "accel/": ("counters overlays extents error_bounds watertight builds lanes",
               "bvh wide ideal cache+bvh extents:kind=sphere"),
    "accel/batch.": ("lanes embree", "wide embree"),
    "accel/brute/": ("lanes", "bvh"),
    "accel/bvh/": ("trees bvh_spatial clusters", "bvh bvh:build=spatial"),
    "accel/clusters/": ("trees clusters", "clusters clusters:width=2 clusters:extent=sphere"),
    "accel/embree/": ("embree", "embree embree:query=8 embree:mode=user embree:mode=user,query=stream"),
    "accel/extent.": ("extents error_bounds clusters",
                      "extents:kind=sphere extents:kind=obb extents:kind=slabs clusters:extent=sphere"),
    "accel/extents/": ("extents", "extents extents:lanes=1 extents:kind=sphere"),
    "accel/grid/": ("grid overlap nested_grid", "grid grid:depth=2 grid:overlap=exact"),
    "accel/item/": ("error_bounds item", "item+bvh"),
    "accel/kd/": ("overlap kd", "kd kd:overlap=exact"),
    "accel/light/": ("light_exact error_bounds light", "light+bvh light:cells=16,longest=1+bvh"),
    "accel/octree/": ("octree", "octree:max_leaf_size=1 octree:max_leaf_size=1,traversal=points octree:traversal=neighbours"),
    "accel/raster/": ("light_exact item light", "item+bvh light+bvh"),
    "accel/registry.": ("overlays plugins", "bvh"),
    "accel/sphere_": ("error_bounds lanes wide wide_exact", "wide brute"),
    "accel/clipping.": ("overlap kd", "kd:overlap=exact grid:overlap=exact"),
    "accel/tree/": ("trees descriptions reinsertion bvh_spatial builds clusters",
                    "bvh bvh:build=spatial clusters:method=goldsmith-salmon"),
    "accel/tree/hierarchy.": ("descriptions bvh_spatial", "bvh bvh:build=spatial"),
    "accel/tree/reinsertion.": ("reinsertion builds", "bvh:reinsertion=2"),
    "accel/tree/spatial": ("bvh_spatial builds", "bvh:build=spatial"),
    "accel/watertight.": ("watertight lanes wide_layout wide item light_exact", "wide item+bvh light+bvh"),
    "accel/wide/": ("wide_layout wide descriptions wide_exact watertight", "wide wide:build=spatial,sharing=0"),
    "src/core/shape/": ("overlap extents csg_memory", "brute bvh clusters:extent=sphere kd:overlap=exact embree"),
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
TABLE_MACRO = re.compile(r'#define(?:[^\n]*\\\n)*[^\n]*"|X\(\w+, 0x[\da-f]{6}\)')  # tables of parameters, names, colours


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
    def __init__(self, path, source, match, new):
        self.path, self.new, self.begin, self.end = path, new, match.start(), match.end()
        self.line = source.count("\n", 0, self.begin) + 1
        begin, end = source.rfind("\n", 0, self.begin) + 1, source.find("\n", self.begin)
        self.text = " ".join(source[begin:end].split())
        self.instead = " ".join((source[begin:self.begin] + new + source[self.end:end]).split())
        self.key = None  # path, text, instead, and which of those that are alike in the file

    def apply(self, source):
        return source[:self.begin] + self.new + source[self.end:]


def all_mutants(seed):
    """All mutants in the order of a seed, which depends on the text of their lines, not on other lines."""
    listed = subprocess.run(["git", "-C", HERE, "ls-files", "accel", "src/core/shape"], check=True,
                            capture_output=True, text=True).stdout.split()
    mutants, alike = [], collections.Counter()
    for path in listed:
        if not path.endswith((".c", ".h")) or path.startswith("accel/plugin"):
            continue
        with open(os.path.join(HERE, path)) as file:
            source = file.read()
        for match in TOKEN.finditer(code_of(path, source)):
            for new in alternatives(match):
                m = Mutant(path, source, match, new)
                alike[path, m.text, m.instead] += 1
                m.key = (path, m.text, m.instead, str(alike[path, m.text, m.instead]))
                mutants.append(m)
    return sorted(mutants, key=lambda m: hashlib.sha256("\t".join((str(seed), *m.key)).encode()).digest())


# ---- building ----

LIMITED = f'ulimit -c 0; ulimit -v {MEMORY}; ulimit -t "$1"; shift; exec "$@"'


def ninja(build, *arguments):
    return subprocess.run(["ninja", "-C", build, *arguments], check=True, capture_output=True, text=True).stdout


class Tree:
    """A copy, built, and how to build parts of it anew without ninja, which would build more."""

    def __init__(self, number, processors):
        self.root = os.path.join(PLACE, str(number))
        os.makedirs(self.root, exist_ok=True)
        build = os.path.join(self.root, "build")
        script = 'here=$1; source "$1/tests/faults/copy.sh"; copy_tree "$2"; configure "$2"; ninja -C "$2/build" -j "$3" "${@:4}"'
        products = PROGRAMS + [f"libraytally_{name}.a" for name in LIBRARIES]
        for name in products:  # they may be those of a mutant
            if os.path.exists(os.path.join(build, name)):
                os.remove(os.path.join(build, name))
        env = dict(os.environ, CCACHE_BASEDIR=self.root, CCACHE_NOHASHDIR="1")
        if shutil.which("ld.lld"):
            env["LDFLAGS"] = "-fuse-ld=lld"  # which links in a fraction of the time
        with open(os.path.join(PLACE, f"build-{number}.log"), "w") as log:
            if subprocess.run(["bash", "-euc", script, "-", HERE, self.root, str(processors), "plugins", *PROGRAMS], env=env,
                              stdout=log, stderr=log).returncode:
                fail(f"the tree does not build: {log.name}")
        ours = re.compile(r"CMakeFiles/(raytally_(%s|kernels_\w+)|test_\w+)\.dir/" % "|".join(LIBRARIES))
        commands = json.loads(ninja(build, "-t", "compdb"))
        self.compile = {entry["output"]: entry["command"] for entry in commands if ours.match(entry["output"])}
        self.objects = collections.defaultdict(list)  # of each file, those to compile
        for block in ninja(build, "-t", "deps").split("\n\n"):
            output, *files = block.split("\n")
            output = output.split(":")[0]
            if output not in self.compile:
                continue
            paths = [os.path.relpath(os.path.join(build, file.strip()), self.root) for file in files]
            if output.startswith("CMakeFiles/test_"):
                paths = self.included_by_tests(paths)
            for path in paths:
                self.objects[path].append(output)
        for program in PROGRAMS:
            shutil.copy2(os.path.join(build, program), os.path.join(build, program + ".clean"))
        self.link = {name: ninja(build, "-t", "commands", "-s", name).strip() for name in products}

    def included_by_tests(self, paths):
        """The headers that a test, or what it includes of tests/, includes itself: it tests what is in them."""
        included = set()
        for path in paths:
            if path.startswith("tests/"):
                with open(os.path.join(self.root, path)) as file:
                    included |= set(re.findall(r'#include "((?:accel|core/shape)/[^"]*)"', file.read()))
        return [path for path in paths if path.removeprefix("src/") in included]

    def shell(self, command, limit=LONGEST):
        """The exit code of a command; None if it takes more than `limit` seconds of processor time, or waits for
        five times as long."""
        with open(os.path.join(self.root, "log"), "w") as log:
            process = subprocess.Popen(["sh", "-c", LIMITED, "-", str(limit), "sh", "-c", command], cwd=self.root,
                                       env=dict(os.environ, CCACHE_DISABLE="1", CMOCKA_TEST_ABORT="1"), stdout=log,
                                       stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, process_group=0)
            try:
                code = process.wait(5 * limit)
            except subprocess.TimeoutExpired:
                code = None
            finally:
                try:
                    os.killpg(process.pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
                process.wait()
        return None if code in (-signal.SIGKILL, 128 + signal.SIGKILL) else code

    def build(self, target):
        if self.shell(f"cd build && {self.link[target]}") != 0:
            fail(f"{target} does not link: {self.root}/log")

    def try_mutant(self, mutant, steps):
        """The verdict, and the step that killed it."""
        path = os.path.join(self.root, mutant.path)
        objects = {name: os.path.join(self.root, "build", name) for name in self.objects[mutant.path]}
        with open(path) as file:
            source = file.read()
        date = os.stat(path)
        try:
            with open(path, "w") as file:
                file.write(mutant.apply(source))
            for o in objects.values():
                os.rename(o, o + ".before")
            changed = False
            for name, o in objects.items():
                if self.shell(f"cd build && {self.compile[name]}") != 0:
                    return "does not compile", ""
                changed |= subprocess.run(["cmp", "-s", o, o + ".before"]).returncode != 0
            return self.run_steps(steps) if changed else ("equivalent", "")
        finally:
            for o in objects.values():
                if os.path.exists(o + ".before"):
                    os.replace(o + ".before", o)
            with open(path, "w") as file:
                file.write(source)
            os.utime(path, ns=(date.st_atime_ns, date.st_mtime_ns))

    def run_steps(self, steps):
        for name in LIBRARIES:
            self.build(f"libraytally_{name}.a")
        built = set()
        for step in steps:
            if step.program not in built:
                self.build(step.program)
                built.add(step.program)
            code = self.shell(step.command, min(LONGEST, int(2 + 5 * step.seconds(self))))
            if code is None:
                return "killed (time)", step.name
            if code not in (0, 77):
                aborted = code in (-signal.SIGABRT, 128 + signal.SIGABRT)  # which a failed test does, too
                return "killed (crash)" if not aborted and (code < 0 or code > 128) else "killed", step.name
        return SURVIVED, ""


# ---- tests ----

SURVIVED, SURVIVED_SHORT, UNTRIED = "survived", "survived the short steps", "not tried"
times = {}  # of each command, the seconds of processor time that it takes without a fault
times_lock = threading.Lock()


def children_seconds():
    """The processor time of all commands that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Step:
    def __init__(self, kind, program, arguments, long=None, before="", after=""):
        self.name, self.program, self.long = f"{kind}: {arguments}", program, long
        self.command = f"{before}build/{program} {arguments}{after}"

    def seconds(self, tree):
        """The processor time that it takes without a fault, measured once. With other jobs it seems to be more."""
        if self.long:
            return LONGEST
        if self.command not in times:
            began = children_seconds()
            clean = self.command.replace("build/" + self.program, f"build/{self.program}.clean")
            if tree.shell(clean, LONGEST) not in (0, 77):
                fail(f"without a fault this fails, see {tree.root}/log: {self.command}")
            with times_lock:
                times[self.command] = children_seconds() - began
                with open(TIMES, "w") as file:
                    json.dump(times, file, indent=0)
        return times[self.command]

    def is_long(self, tree):
        return self.seconds(tree) > SHORT if self.long is None else self.long


def subject_of(path):
    return max((p for p in SUBJECTS if path.startswith(p)), key=len)


def counts_of(specs):
    """That the golden counts of these accelerators, if there are any, are as they were. The first one is
    the baseline, and the copy has kernels for one instruction set alone."""
    ours = r'{accel: "?(%s)\b' % "|".join(sorted({re.match(r"\w+", spec).group() for spec in specs}))
    with open(os.path.join(HERE, "tests/golden/experiment.yaml")) as file:
        if not re.search(ours, file.read()):
            return []
    choose = f"grep -E '^[^ ]|{{scene|{{accel: bvh}}|{ours}' tests/golden/experiment.yaml | grep -v isa=portable >build/counts.yaml"
    return [Step("counts", "raytally", "run build/counts.yaml --threads 2 --out build/counts", long=False,
                 before=f"rm -rf build/counts && {choose} && ",
                 after=" && ! grep -vxFf tests/golden/counts.csv build/counts/counts.csv")]


def steps_for(subject):
    groups, specs = (words.split() for words in SUBJECTS[subject])
    steps = [Step("tests", "test_accel", group) for group in groups] + counts_of(specs)
    if subject == "src/core/shape/":
        steps += [Step("tests", "test_shape", group) for group in
                  "bounds csg csg_points csg_trees hits shape solid_cases solid_faces solids".split()]
        steps += [Step("tests", "test_exact", group) for group in "border referee exact_trees".split()]
        steps += [Step("tests", "test_scene", group) for group in ("csg_scene", "yaml_refusals")]
    else:
        steps += [Step("tests", "test_picture", group) for group in ("path", "structure")]
    steps += [Step("quick verify", "raytally", f"verify --seed=1 --quick --accel {spec}") for spec in specs]
    steps += [Step("verify", "raytally", f"verify --seed=1 --accel {spec}", long=True) for spec in specs]
    return steps + [Step("all tests", "test_verify", "conformance counter_sums hostile", long=True),
                    Step("all tests", "test_accel", "", long=True)]


# ---- the run ----

def read_rows(path):
    """The lines of a table, split at tabs."""
    if not os.path.exists(path):
        return []
    with open(path) as file:
        return [line.rstrip("\n").split("\t") for line in file if not line.startswith("#")]


def try_all(mutants, trees, known, long):
    """Tries mutants with the short steps or the long ones, each in the next free tree; adds to `known` and to its file
    what became of them."""
    waiting = iter(mutants)

    def work(tree):
        for m in waiting:
            began, subject = time.monotonic(), subject_of(m.path)
            steps = [step for step in steps_for(subject) if step.is_long(tree) == long]
            kills = collections.Counter(name for key, (_, name) in list(known.items()) if subject_of(key[0]) == subject)
            steps.sort(key=lambda step: step.seconds(tree) / (1 + kills[step.name]))
            verdict, name = tree.try_mutant(m, steps)
            if verdict == SURVIVED and not long:
                verdict = SURVIVED_SHORT
            known[m.key] = verdict, name
            with open(RESULTS, "a") as file:
                print(verdict, name, f"{time.monotonic() - began:.1f}", m.line, *m.key, sep="\t", file=file)
            if verdict.startswith(SURVIVED):
                print(f"{verdict}: {m.path}:{m.line}: {m.instead}", file=sys.stderr)
    with concurrent.futures.ThreadPoolExecutor(len(trees)) as pool:
        try:
            list(pool.map(work, trees))
        finally:
            list(waiting)  # if one fails, the others come to an end


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=500, help="how many mutants (default 500)")
    parser.add_argument("--seed", type=int, default=1, help="which ones (default 1)")
    parser.add_argument("--jobs", type=int, default=1, help="how many at a time, each in a copy of the tree (default 1)")
    parser.add_argument("--quick", action="store_true", help="leave out the long steps")
    parser.add_argument("--again", action="store_true", help="try those again that survived without an explanation")
    parser.add_argument("--list", action="store_true", help="print the mutants with what is known, and do nothing")
    parser.add_argument("paths", nargs="*", help="mutate only files whose path begins with one of these")
    options = parser.parse_args()

    mutants = [m for m in all_mutants(options.seed) if m.path.startswith(tuple(options.paths) or "")]
    possible, mutants = len(mutants), mutants[:options.count]
    explained = {tuple(row[:3]) for row in read_rows(TABLE)}
    known = {tuple(row[4:]): (row[0], row[1]) for row in read_rows(RESULTS)}  # verdict and step; the last line counts

    def verdict(m):
        name = known.get(m.key, (UNTRIED, ""))[0]
        return "explained" if name.startswith(SURVIVED) and m.key[:3] in explained else name

    def those(*verdicts):
        return [m for m in mutants if verdict(m).startswith(verdicts)]
    if options.list:
        for m in mutants:
            print(verdict(m), m.line, *m.key, sep="\t")
        return 0
    if those(UNTRIED, SURVIVED if options.again else UNTRIED if options.quick else SURVIVED_SHORT):
        os.makedirs(PLACE, exist_ok=True)
        if os.path.exists(TIMES):
            with open(TIMES) as file:
                times.update(json.load(file))
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            trees = list(pool.map(lambda i: Tree(i + 1, -(-os.cpu_count() // options.jobs)), range(options.jobs)))
        try_all(those(UNTRIED, SURVIVED if options.again else UNTRIED), trees, known, long=False)
        if not options.quick:
            try_all(those(SURVIVED_SHORT), trees, known, long=True)
    counts = collections.Counter(map(verdict, mutants))
    killed, left = (sum(n for name, n in counts.items() if name.startswith(kind)) for kind in ("killed", SURVIVED))
    print(f"{len(mutants)} of {possible} mutants, seed {options.seed}:")
    for name, n in counts.most_common():
        print(f"{n:6d}  {name}")
    by = collections.Counter(known[m.key][1].split(":")[0] for m in those("killed"))
    print("killed by " + ", ".join(f"{kind} {n}" for kind, n in by.most_common()))
    if killed + left > 0:
        print(f"{killed} of {killed + left} that change an answer or a count are killed ({100 * killed / (killed + left):.1f} %)")
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
