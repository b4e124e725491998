/* SPDX-License-Identifier: Apache-2.0 */
/* forest: trees on hilly ground, a million small triangles in random orientations, most of them in
 * overlapping crowns: measures how builders scale, from 10^3 to 10^7 triangles.
 *
 * Trees stand one per square of a grid, n of them from the front on, at a random position within it. A
 * broadleaf is a trunk that forks LEVELS times into FORKS (tapered prisms), with leaves around every twig;
 * a conifer is a trunk with whorls of boughs, each with a few broad hanging triangles of needles. Tree i
 * depends only on random stream i. As an instance, it is one of a few trees, scaled and turned about the
 * vertical; the ground, which would take most of the memory, then has a quarter of the triangles. The ground
 * is noise from lattices of random heights (Perlin 1985, in its simplest form); lengths are in metres. */
#include "core/base/elementary.h"
#include "scenes/builtin.h"

#define PARAMS(X)                                                                                            \
    X(N, "n", RT_INT("1000", 1, 1e6, "1|5"), "trees, of about 1020 triangles each", "a million triangles")   \
    X(SEED, RT_BUILTIN_SEED)                                                                                 \
    X(INSTANCES, RT_BUILTIN_INSTANCES)                                                                       \
    X(PARTS, RT_BUILTIN_PARTS("trees"))

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

enum { BARK, BIRCH_BARK, SOIL, NEEDLES, DARK_NEEDLES, LEAVES, MATERIALS = LEAVES + 9 };

/* Leaves come in three shades of each of three colours. */
static const RtMaterial materials[MATERIALS] = {
    [BARK] = RT_MATTE("bark", 0.3f, 0.2f, 0.13f),
    [BIRCH_BARK] = RT_MATTE("birch bark", 0.75f, 0.72f, 0.66f),
    [SOIL] = RT_MATTE("soil", 0.26f, 0.3f, 0.12f),
    [NEEDLES] = RT_MATTE("needles", 0.1f, 0.3f, 0.14f),
    [DARK_NEEDLES] = RT_MATTE("dark needles", 0.06f, 0.22f, 0.13f),
    [LEAVES] = RT_MATTE("green leaves", 0.2f, 0.42f, 0.08f),
    [LEAVES + 1] = RT_MATTE("green leaves", 0.26f, 0.5f, 0.1f),
    [LEAVES + 2] = RT_MATTE("green leaves", 0.14f, 0.34f, 0.08f),
    [LEAVES + 3] = RT_MATTE("light leaves", 0.45f, 0.52f, 0.1f),
    [LEAVES + 4] = RT_MATTE("light leaves", 0.52f, 0.56f, 0.14f),
    [LEAVES + 5] = RT_MATTE("light leaves", 0.38f, 0.46f, 0.1f),
    [LEAVES + 6] = RT_MATTE("autumn leaves", 0.75f, 0.38f, 0.06f),
    [LEAVES + 7] = RT_MATTE("autumn leaves", 0.65f, 0.22f, 0.06f),
    [LEAVES + 8] = RT_MATTE("autumn leaves", 0.8f, 0.55f, 0.12f),
};

enum { LEVELS = 3, FORKS = 4, TWIG_LEAVES = 8 };
enum { WHORLS = 14, BOUGHS = 7, BOUGH_TUFTS = 7 };

static const double square = 6; /* edge of a tree's ground */

/* ---- the ground ---- */

/* Streams of lattice points follow those of trees. */
#define LATTICE_STREAM (UINT64_C(1) << 63)
#define PART_STREAM    (UINT64_C(1) << 62)

static double lattice_height(uint64_t seed, uint32_t octave, uint32_t x, uint32_t y) {
    RtRandom random = rt_random(seed, LATTICE_STREAM | (uint64_t)octave << 60 | (uint64_t)x << 30 | y);
    return 2 * (double)rt_random_unit(&random) - 1;
}

/* Smooth and flat at both ends. */
static double ease(double t) {
    return t * t * (3 - 2 * t);
}

static double height_at(uint64_t seed, double x, double y) {
    static const double wave[3] = {60, 25, 9}, amplitude[3] = {7, 2.2, 0.5};
    const double beyond = 1000; /* lattice points have no negative numbers */
    double height = 0;
    for (uint32_t octave = 0; octave < 3; octave++) {
        double u = x / wave[octave] + beyond, v = y / wave[octave] + beyond;
        uint32_t i = (uint32_t)u, j = (uint32_t)v;
        double s = ease(u - i), t = ease(v - j);
        double near =
            (1 - s) * lattice_height(seed, octave, i, j) + s * lattice_height(seed, octave, i + 1, j);
        double far =
            (1 - s) * lattice_height(seed, octave, i, j + 1) + s * lattice_height(seed, octave, i + 1, j + 1);
        height += amplitude[octave] * ((1 - t) * near + t * far);
    }
    return height;
}

typedef struct Ground {
    uint64_t seed;
    uint32_t edge;  /* squares with trees along an edge */
    uint32_t cells; /* along a square */
} Ground;

enum { MARGIN = 3 }; /* squares without trees around */

static RtVec3d ground_point(const void *of, uint32_t column, uint32_t row) {
    const Ground *ground = of;
    double x = square * ((double)column / ground->cells - MARGIN);
    double y = square * ((double)row / ground->cells - MARGIN);
    return rt_vec3d(x, y, height_at(ground->seed, x, y));
}

static void add_ground(RtSceneBuilder *b, const Ground *ground) {
    uint32_t cells = (ground->edge + 2 * MARGIN) * ground->cells;
    b->material = SOIL;
    rt_build_grid_mesh(
        b,
        &(RtGridMesh){.columns = cells, .rows = cells, .smooth = true, .point = ground_point, .of = ground});
}

/* ---- trees ---- */

typedef struct Tree {
    RtSceneBuilder *b;
    RtRandom random;
    uint32_t bark, leaves; /* materials; for leaves the first of three */
    bool conifer;
} Tree;

static double between(Tree *tree, double lo, double hi) {
    return rt_random_betweend(&tree->random, lo, hi);
}

static void add_leaf(Tree *tree, RtVec3d at) {
    RtVec3d along = rt_random_direction(&tree->random);
    RtVec3d across = rt_normalized(rt_crossd(along, rt_random_direction(&tree->random)));
    double length = between(tree, 0.35, 0.65);
    RtVec3d tip = rt_add_scaledd(at, along, length), middle = rt_add_scaledd(at, along, 0.4 * length);
    tree->b->material = tree->leaves + rt_random_below(&tree->random, 3);
    rt_build_triangle(tree->b, at, rt_add_scaledd(middle, across, 0.6 * length), tip);
}

/* A branch from `base` with its forks or leaves. */
static void add_branch(Tree *tree, RtVec3d base, RtVec3d direction, double length, uint32_t level) {
    static const uint32_t sides[LEVELS + 1] = {6, 4, 3, 3};
    double radius = length * (level == 0 ? 0.045 : 0.03);
    RtVec3d tip = rt_add_scaledd(base, direction, length);
    tree->b->material = tree->bark;
    rt_build_prism(tree->b, base, radius, tip, 0.5 * radius, sides[level]);
    for (uint32_t i = 0; level == LEVELS && i < TWIG_LEAVES; i++)
        add_leaf(tree, rt_add_scaledd(base, direction, length * between(tree, 0.2, 1.1)));
    for (uint32_t i = 0; level < LEVELS && i < FORKS; i++) {
        double along = level == 0 ? 0.55 + 0.15 * i : 0.4 + 0.2 * i;
        RtVec3d out = rt_normalized(rt_crossd(direction, rt_random_direction(&tree->random)));
        RtVec3d fork =
            rt_add_scaledd(rt_scaled(direction, i + 1 == FORKS ? 1.2 : 0.6), out, between(tree, 0.7, 1));
        fork.z += 0.2;
        add_branch(tree, rt_add_scaledd(base, direction, length * along), rt_normalized(fork),
                   length * between(tree, 0.5, 0.62), level + 1);
    }
}

/* A bough from the trunk at height `up` (0 to 1) of the tree, outwards and slightly down. */
static void add_bough(Tree *tree, RtVec3d foot, double height, double up) {
    RtVec3d turn = rt_random_direction(&tree->random);
    RtVec3d out = rt_normalized(rt_vec3d(turn.x, turn.y, 0)), across = {-out.y, out.x, 0};
    double length = height * (0.04 + 0.28 * (1 - up)) * between(tree, 0.8, 1.1);
    RtVec3d base = {foot.x, foot.y, foot.z + height * up};
    RtVec3d tip = rt_add_scaledd(base, out, length);
    tip.z -= 0.35 * length;
    tree->b->material = tree->bark;
    rt_build_prism(tree->b, base, 0.02 * length, tip, 0, 3);
    for (uint32_t i = 0; i < BOUGH_TUFTS; i++) {
        RtVec3d from = rt_add_scaledd(base, rt_subd(tip, base), 0.14 * i);
        double width = (0.36 - 0.035 * i) * length, hang = -0.12 * length;
        RtVec3d end = rt_add_scaledd(base, rt_subd(tip, base), 0.14 * i + 0.2);
        RtVec3d left = rt_add_scaledd(end, across, -width), right = rt_add_scaledd(end, across, width);
        left.z += hang, right.z += hang * between(tree, 0.6, 1.2);
        tree->b->material = rt_random_below(&tree->random, 2) ? NEEDLES : DARK_NEEDLES;
        rt_build_triangle(tree->b, from, right, left);
    }
}

static void add_conifer(Tree *tree, RtVec3d foot, double height) {
    RtVec3d top = {foot.x, foot.y, foot.z + height};
    tree->b->material = tree->bark;
    rt_build_prism(tree->b, foot, 0.02 * height, top, 0, 6);
    for (uint32_t i = 0; i < WHORLS * BOUGHS; i++)
        add_bough(tree, foot, height, 0.16 + 0.82 * i / (WHORLS * BOUGHS));
}

/* A tree of a random kind. */
static Tree plant(RtSceneBuilder *b, uint64_t seed, uint64_t stream) {
    Tree tree = {.b = b, .random = rt_random(seed, stream), .bark = BARK};
    uint32_t die = rt_random_below(&tree.random, 12);
    tree.conifer = die < 4;
    tree.leaves = LEAVES + (die < 9 ? 0 : die < 11 ? 3 : 6);
    if (die == 9 || die == 10) tree.bark = BIRCH_BARK;
    return tree;
}

/* A place on the ground of tree `i`. */
static RtVec3d choose_foot(Tree *tree, const Ground *ground, uint64_t i) {
    uint64_t column = i % ground->edge, row = i / ground->edge;
    double x = square * ((double)column + between(tree, 0.1, 0.9));
    double y = square * ((double)row + between(tree, 0.1, 0.9));
    return rt_vec3d(x, y, height_at(ground->seed, x, y) - 0.3);
}

static void add_tree(Tree *tree, RtVec3d foot) {
    if (tree->b->counting) {
        /* All trees of a kind have equally many triangles. */
        const uint64_t broadleaf = 12 + 4 * 8 + 16 * 6 + 64 * (6 + TWIG_LEAVES);
        tree->b->count += tree->conifer ? 6 + WHORLS * BOUGHS * (3 + BOUGH_TUFTS) : broadleaf;
        return;
    }
    if (tree->conifer) {
        add_conifer(tree, foot, between(tree, 6, 12));
        return;
    }
    double lean_x = between(tree, -0.12, 0.12), lean_y = between(tree, -0.12, 0.12);
    RtVec3d lean = {lean_x, lean_y, 1};
    add_branch(tree, foot, rt_normalized(lean), between(tree, 3.2, 5), 0);
}

static void make_parts(RtSceneBuilder *b, uint64_t seed, uint32_t parts) {
    for (uint32_t i = 0; i < parts; i++) {
        rt_build_begin_part(b);
        rt_build_materials(b, materials, MATERIALS);
        Tree tree = plant(b, seed, PART_STREAM | i);
        add_tree(&tree, rt_vec3d(0, 0, 0));
        rt_build_end_part(b);
    }
}

/* The coarse ground may be lower than the hill, so it stands deeper. */
static void add_instance(RtSceneBuilder *b, const Ground *ground, uint64_t i) {
    Tree tree = {.random = rt_random(ground->seed, i)};
    const uint32_t part = rt_random_below(&tree.random, b->part_count);
    RtVec3d foot = b->counting ? rt_vec3d(0, 0, 0) : choose_foot(&tree, ground, i);
    RtTurn turn = rt_turn(between(&tree, 0, 360));
    double scale = between(&tree, 0.8, 1.25), c = scale * turn.cosine, s = scale * turn.sine;
    const RtTransform to_world = {{{c, -s, 0, foot.x}, {s, c, 0, foot.y}, {0, 0, scale, foot.z - 0.3}}};
    rt_build_instance(b, part, &to_world);
}

static uint64_t object_bytes(const RtValue *values) {
    return values[INSTANCES].choice == RT_INSTANCES_ON ? RT_BUILTIN_OBJECT_BYTES : RT_BUILTIN_TRIANGLE_BYTES;
}

/* ---- the scene ---- */

static void generate(RtSceneBuilder *b, const RtValue *values) {
    const bool instances = values[INSTANCES].choice != RT_INSTANCES_OFF;
    Ground ground = {.seed = (uint64_t)values[SEED].i, .edge = 1, .cells = instances ? 1 : 2};
    while ((uint64_t)ground.edge * ground.edge < (uint64_t)values[N].i) ground.edge++;
    double width = square * ground.edge, eye_y = -14;
    double eye_z = height_at(ground.seed, width / 2, eye_y) + 9;
    RtScene *scene = b->scene;
    scene->camera.from = rt_narrow(rt_vec3d(width / 2, eye_y, eye_z));
    scene->camera.at = rt_narrow(rt_vec3d(width / 2, eye_y + 20, eye_z - 3));
    scene->background = rt_vec3(0.55f, 0.7f, 0.9f);
    RtVec3d sun = {-2 * width - 40, -3 * width - 40, 4 * width + 60};
    RtVec3d sky = {3 * width + 40, -width, 3 * width + 60};
    rt_build_light(b, sun, rt_vec3(0.85f, 0.8f, 0.7f));
    rt_build_light(b, sky, rt_vec3(0.22f, 0.25f, 0.32f));
    b->transformed = true;
    rt_build_materials(b, materials, MATERIALS);
    add_ground(b, &ground);
    b->flattened = values[INSTANCES].choice == RT_INSTANCES_FLATTENED;
    if (instances) make_parts(b, ground.seed, (uint32_t)values[PARTS].i);
    for (uint64_t i = 0; i < (uint64_t)values[N].i; i++) {
        if (instances) {
            add_instance(b, &ground, i);
        } else {
            Tree tree = plant(b, ground.seed, i);
            add_tree(&tree, b->counting ? rt_vec3d(0, 0, 0) : choose_foot(&tree, &ground, i));
        }
    }
}

const RtBuiltin rt_builtin_forest = {
    .name = "forest",
    .summary = "n trees on hilly ground: a million small triangles in all orientations",
    .source = "made to measure how builders scale",
    RT_PARAMS_OF(params),
    .object_bytes = object_bytes,
    .generate = generate,
};
