/* SPDX-License-Identifier: Apache-2.0 */
/* glTF 2.0, as JSON (.gltf) or binary (.glb): the triangles of all nodes of the scene, nodes depth first,
 * each with its matrices, at rest: morph targets with the weights of the file, skins in the pose of their
 * joints. A mesh of PART_TRIANGLES or more that is placed several times, by nodes or by
 * EXT_mesh_gpu_instancing, becomes a part and instances of it, where it needs no skin, is not far from its
 * own origin, and the file is the whole scene; else copies. Materials are ignored, animations
 * with a warning. Files that need another extension for their geometry are rejected.
 *
 * First all nodes are placed, because a skin needs the places of its joints; then come their meshes. */
#include "core/scene/gltf.h"

#include <math.h>
#include <string.h>

/* A node where the scene places it, and its mesh; a zeroed struct: it has none. */
typedef struct Place {
    RtGltfItem node, mesh;
    RtTransform transform;
} Place;

/* A mesh that may be placed several times. */
typedef struct Shared {
    uint64_t places; /* nodes that do */
    uint32_t part;   /* of the scene, plus 1; 0: not tried; NO_PART: too small */
} Shared;

typedef struct Instance {
    uint32_t part;
    RtTransform to_world;
} Instance;

typedef struct Nodes {
    RtGltf *document;
    uint32_t *last_of; /* one for each of the document's nodes: 1 + its last place; 0: not in the scene */
    Place *places;     /* [place_count] */
    uint32_t place_count, place_capacity;
    Shared *shared;      /* one for each of the document's meshes */
    Instance *instances; /* [instance_count], to be added after all triangles */
    uint32_t instance_count, instance_capacity;
} Nodes;

/* What a node adds to its mesh. */
typedef struct Pose {
    const json_t *weights; /* of morph targets */
    size_t joint_count;
    RtTransform *joints;   /* [joint_count], from the mesh to the scene; NULL: no skin */
    RtTransform transform; /* of what has no skin */
} Pose;

/* Below PART_TRIANGLES a ray would take longer to enter an instance than to test copies. */
enum { DEEPEST = 256, PART_TRIANGLES = 100 };
#define NO_PART UINT32_MAX

/* ---- primitives ---- */

enum { TRIANGLES = 4, STRIP = 5, FAN = 6 };

static RtStatus add_triangles(const RtGltf *g, uint64_t mode, uint32_t count, const double *indices) {
    if (count < 3) return rt_mesh_warn(g->mesh, "primitives of one or two corners are left out");
    if (mode == TRIANGLES && count % 3 != 0)
        return rt_mesh_fail(g->mesh, "a primitive of triangles has %u corners", count);
    for (uint32_t i = 0; i + 2 < count; i += mode == TRIANGLES ? 3 : 1) {
        const uint32_t odd = mode == STRIP ? i % 2 : 0; /* every other triangle of a strip is reversed */
        const uint32_t corners[3] = {mode == FAN ? 0 : i, i + 1 + odd, i + 2 - odd};
        for (int k = 0; k < 3; k++)
            RT_TRY(rt_mesh_add_index(g->mesh, indices ? indices[corners[k]] : corners[k]));
        RT_TRY(rt_mesh_add_polygon(g->mesh));
    }
    return RT_OK;
}

/* Adds the weighted targets of a primitive to its positions or normals. */
static RtStatus morph(RtGltf *g, const RtGltfItem *primitive, const json_t *weights, const char *key,
                      RtGltfValues *values) {
    const json_t *targets = json_object_get(primitive->object, "targets");
    json_t *target;
    size_t i;
    RT_TRY(rt_gltf_count_placed(g, json_array_size(targets)));
    json_array_foreach(targets, i, target) {
        RT_ARENA(memory);
        const RtGltfItem item = rt_gltf_inside(primitive, target);
        const json_t *member = json_array_get(weights, i);
        const double weight = json_number_value(member);
        RtGltfValues deltas = {0};
        if (member && !json_is_number(member)) return rt_gltf_fail(g, primitive, "expected weights, numbers");
        if (weight != 0) RT_TRY(rt_gltf_accessor(g, &item, key, 3, values->count, &memory, &deltas));
        for (size_t k = 0; deltas.at && k < 3 * (size_t)values->count; k++)
            values->at[k] += weight * deltas.at[k];
    }
    return RT_OK;
}

/* Moves positions and normals by the joints of a skin, into the scene; the node says only, by mirroring,
 * which side is the front. */
static RtStatus apply_skin(RtGltf *g, const RtGltfItem *attributes, const Pose *pose, RtGltfValues *positions,
                           RtGltfValues *normals) {
    RT_ARENA(memory);
    const size_t count = positions->count;
    RtTransform *blended = rt_arena_alloc(&memory, count, sizeof *blended);
    double *sums = rt_arena_alloc(&memory, count, sizeof *sums);
    const double sign = rt_transform_mirrors(&pose->transform) ? -1 : 1;
    char joints_key[24] = "JOINTS_0", weights_key[24] = "WEIGHTS_0";
    RT_TRY(rt_arena_check(&memory, "a skin of glTF", g->mesh->text.error));
    for (int set = 1; json_object_get(attributes->object, joints_key); set++) {
        RT_ARENA(of_set);
        RtGltfValues joints, weights;
        RT_TRY(rt_gltf_accessor(g, attributes, joints_key, 4, positions->count, &of_set, &joints));
        RT_TRY(rt_gltf_accessor(g, attributes, weights_key, 4, positions->count, &of_set, &weights));
        for (size_t i = 0; weights.at && i < 4 * count; i++) {
            if (weights.at[i] == 0) continue;
            if (!rt_gltf_is_index(joints.at[i], (double)pose->joint_count))
                return rt_gltf_fail(g, attributes, "a vertex names joint %g, but its skin has %zu",
                                    joints.at[i], pose->joint_count);
            const RtTransform *joint = &pose->joints[(size_t)joints.at[i]];
            for (int k = 0; k < 12; k++)
                blended[i / 4].m[k / 4][k % 4] += weights.at[i] * joint->m[k / 4][k % 4];
            sums[i / 4] += weights.at[i];
        }
        snprintf(joints_key, sizeof joints_key, "JOINTS_%d", set);
        snprintf(weights_key, sizeof weights_key, "WEIGHTS_%d", set);
    }
    for (size_t i = 0; i < count; i++) {
        if (fabs(sums[i] - 1) > 0.01)
            RT_TRY(rt_mesh_warn(
                g->mesh,
                "the joint weights of a vertex add up to %g: they are scaled to 1, or if 0, it stays",
                sums[i]));
        if (sums[i] == 0) blended[i] = pose->transform;
        for (int k = 0; k < 12; k++) blended[i].m[k / 4][k % 4] *= sign / (sums[i] == 0 ? 1 : sums[i]);
        positions->vectors[i] = rt_transform_pointd(&blended[i], positions->vectors[i]);
        if (normals->at) normals->vectors[i] = rt_transform_normald(&blended[i], normals->vectors[i]);
    }
    g->mesh->transform = rt_transform_identity();
    for (int a = 0; a < 3; a++) g->mesh->transform.m[a][a] = sign;
    return RT_OK;
}

static RtStatus add_primitive(RtGltf *g, const RtGltfItem *mesh, json_t *object, const Pose *pose) {
    RT_ARENA(memory);
    RtMeshReader *r = g->mesh;
    const RtGltfItem primitive = rt_gltf_inside(mesh, object),
                     attributes = rt_gltf_inside(mesh, json_object_get(object, "attributes"));
    uint64_t mode = 0;
    RtGltfValues positions, normals, uvs = {0}, indices;
    RT_TRY(rt_gltf_count_placed(g, 1));
    RT_TRY(rt_gltf_integer(g, &primitive, "mode", 0, TRIANGLES, &mode));
    if (mode > FAN) return rt_gltf_fail(g, &primitive, "expected mode, 0 to 6");
    if (mode < TRIANGLES) return rt_mesh_warn(r, "points and lines are left out");
    RT_TRY(rt_gltf_accessor(g, &attributes, "POSITION", 3, 0, &memory, &positions));
    if (!positions.at) return rt_mesh_warn(r, "primitives without positions are left out");
    RT_TRY(rt_gltf_accessor(g, &attributes, "NORMAL", 3, positions.count, &memory, &normals));
    if (r->textured)
        RT_TRY(rt_gltf_accessor(g, &attributes, "TEXCOORD_0", 2, positions.count, &memory, &uvs));
    RT_TRY(rt_gltf_accessor(g, &primitive, "indices", 1, 0, &memory, &indices));
    RT_TRY(morph(g, &primitive, pose->weights, "POSITION", &positions));
    RT_TRY(morph(g, &primitive, pose->weights, "NORMAL", &normals));
    r->transform = pose->transform;
    if (pose->joints && json_object_get(attributes.object, "JOINTS_0"))
        RT_TRY(apply_skin(g, &attributes, pose, &positions, &normals));
    r->vertex_count = r->normal_count = r->uv_count = 0;
    for (uint32_t i = 0; i < positions.count; i++) RT_TRY(rt_mesh_add_vertex(r, positions.vectors[i]));
    for (uint32_t i = 0; i < normals.count; i++) RT_TRY(rt_mesh_add_normal(r, rt_narrow(normals.vectors[i])));
    for (size_t i = 0; i < uvs.count; i++) /* v grows downward */
        RT_TRY(rt_mesh_add_uv(r, (RtUv){(float)uvs.at[2 * i], (float)(1 - uvs.at[2 * i + 1])}));
    return add_triangles(g, mode, indices.at ? indices.count : positions.count, indices.at);
}

/* ---- nodes ---- */

/* Moves by t, after the quaternion q (x y z w) has turned what s has scaled. */
static RtTransform compose_steps(const double t[3], const double q[4], const double s[3]) {
    const double x = q[0], y = q[1], z = q[2], w = q[3], square = x * x + y * y + z * z + w * w,
                 n = square > 0 ? 2 / square : 0; /* stored in few bits, its length is not quite 1 */
    return (RtTransform){
        {{(1 - n * (y * y + z * z)) * s[0], n * (x * y - z * w) * s[1], n * (x * z + y * w) * s[2], t[0]},
         {n * (x * y + z * w) * s[0], (1 - n * (x * x + z * z)) * s[1], n * (y * z - x * w) * s[2], t[1]},
         {n * (x * z - y * w) * s[0], n * (y * z + x * w) * s[1], (1 - n * (x * x + y * y)) * s[2], t[2]}}};
}

/* Of the 16 numbers of a matrix, column by column. */
static RtTransform transform_of(const double columns[16]) {
    RtTransform out;
    for (int i = 0; i < 12; i++) out.m[i % 3][i / 3] = columns[i / 3 * 4 + i % 3];
    return out;
}

/* A matrix, or translation, rotation and scale. */
static RtStatus get_transform(const RtGltf *g, const RtGltfItem *node, RtTransform *out) {
    double t[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1}, columns[16];
    const bool matrix = json_object_get(node->object, "matrix");
    RT_TRY(rt_gltf_numbers(g, node, "matrix", 16, columns));
    RT_TRY(rt_gltf_numbers(g, node, "translation", 3, t));
    RT_TRY(rt_gltf_numbers(g, node, "rotation", 4, q));
    RT_TRY(rt_gltf_numbers(g, node, "scale", 3, s));
    *out = matrix ? transform_of(columns) : compose_steps(t, q, s);
    return RT_OK;
}

static RtStatus place_node(Nodes *nodes, const RtGltfItem *node, const RtTransform *above, int depth) {
    RtGltf *g = nodes->document;
    Place place = {.node = *node};
    RtTransform own;
    RtGltfItem below = {0};
    const json_t *mesh = json_object_get(node->object, "mesh"), *child;
    size_t i;
    if (depth == DEEPEST)
        return rt_gltf_fail(g, node, "it is more than %d levels deep, or below itself", DEEPEST);
    RT_TRY(
        rt_gltf_count_placed(g, RT_GLTF_MOST_PLACED)); /* a place takes memory; a node has a byte at least */
    RT_TRY(get_transform(g, node, &own));
    place.transform = rt_transform_compose(&own, above);
    if (mesh) RT_TRY(rt_gltf_find(g, node, mesh, "meshes", &place.mesh));
    if (mesh) nodes->shared[place.mesh.index].places++;
    if (nodes->last_of[node->index])
        RT_TRY(rt_mesh_warn(g->mesh, "nodes[%zu] has several parents: it is placed below each", node->index));
    RT_TRY(rt_append(&nodes->places, &nodes->place_count, &nodes->place_capacity, &place, sizeof place,
                     g->mesh->text.error));
    nodes->last_of[node->index] = nodes->place_count;
    json_array_foreach(json_object_get(node->object, "children"), i, child) {
        RT_TRY(rt_gltf_find(g, node, child, "nodes", &below));
        RT_TRY(place_node(nodes, &below, &place.transform, depth + 1));
    }
    return RT_OK;
}

/* Places the nodes of the scene; without a scene, all. */
static RtStatus place_nodes(Nodes *nodes) {
    RtGltf *g = nodes->document;
    const json_t *scenes = json_object_get(g->root, "scenes"), *reference = json_object_get(g->root, "scene"),
                 *all = json_object_get(g->root, "nodes"), *child;
    const size_t count = json_array_size(all);
    RtGltfItem scene = {"scenes", 0, json_array_get(scenes, 0)};
    json_t *one;
    size_t i, k;
    bool *is_child = rt_arena_alloc(&g->memory, count, sizeof *is_child);
    nodes->last_of = rt_arena_alloc(&g->memory, count, sizeof *nodes->last_of);
    RT_TRY(rt_arena_check(&g->memory, "nodes of glTF", g->mesh->text.error));
    json_array_foreach(all, i, one) {
        json_array_foreach(json_object_get(one, "children"), k, child) {
            const double number = rt_gltf_number(child);
            if (rt_gltf_is_index(number, (double)count)) is_child[(size_t)number] = true;
        }
    }
    if (reference) RT_TRY(rt_gltf_find(g, &scene, reference, "scenes", &scene));
    if (!scene.object && !all)
        return rt_mesh_fail(g->mesh, "expected scenes, or nodes that place its meshes");
    if (!scene.object) RT_TRY(rt_mesh_warn(g->mesh, "it has no scene: all its nodes are read"));
    if (json_array_size(scenes) > 1) RT_TRY(rt_mesh_warn(g->mesh, "it has several scenes: only one is read"));
    json_array_foreach(scene.object ? json_object_get(scene.object, "nodes") : all, i, one) {
        RtGltfItem node = {"nodes", i, one};
        if (scene.object) RT_TRY(rt_gltf_find(g, &scene, one, "nodes", &node));
        if (scene.object && is_child[node.index])
            return rt_gltf_fail(g, &scene, "its nodes[%zu] is also below another node", node.index);
        if (!is_child[node.index]) RT_TRY(place_node(nodes, &node, &g->mesh->transform, 0));
    }
    return RT_OK;
}

/* ---- meshes ---- */

static RtStatus read_skin(Nodes *nodes, const RtGltfItem *node, RtArena *memory, Pose *pose) {
    RtGltf *g = nodes->document;
    const json_t *reference = json_object_get(node->object, "skin");
    RtGltfItem skin = {0}, joint = {0};
    RtGltfValues inverse;
    if (!reference) return RT_OK;
    RT_TRY(rt_gltf_find(g, node, reference, "skins", &skin));
    const json_t *joints = json_object_get(skin.object, "joints");
    pose->joint_count = json_array_size(joints);
    pose->joints = rt_arena_alloc(memory, pose->joint_count, sizeof *pose->joints);
    RT_TRY(rt_arena_check(memory, "a skin of glTF", g->mesh->text.error));
    RT_TRY(rt_gltf_accessor(g, &skin, "inverseBindMatrices", 16, 0, memory, &inverse));
    if (inverse.at && inverse.count < pose->joint_count)
        return rt_gltf_fail(g, &skin, "it has %zu joints, but %u matrices", pose->joint_count, inverse.count);
    RT_TRY(rt_gltf_count_placed(g, pose->joint_count));
    for (size_t i = 0; i < pose->joint_count; i++) {
        RT_TRY(rt_gltf_find(g, &skin, json_array_get(joints, i), "nodes", &joint));
        if (!nodes->last_of[joint.index])
            return rt_gltf_fail(g, &skin, "its joint nodes[%zu] is not in the scene", joint.index);
        const RtTransform bind = inverse.at ? transform_of(inverse.at + 16 * i) : rt_transform_identity();
        pose->joints[i] =
            rt_transform_compose(&bind, &nodes->places[nodes->last_of[joint.index] - 1].transform);
    }
    return RT_OK;
}

static RtStatus add_primitives(RtGltf *g, const RtGltfItem *mesh, const Pose *pose) {
    json_t *primitive;
    size_t k;
    json_array_foreach(json_object_get(mesh->object, "primitives"), k, primitive)
        RT_TRY(add_primitive(g, mesh, primitive, pose));
    return RT_OK;
}

/* Rays moved there would lose digits that copies keep. */
static bool is_far(const RtGeometry *g) {
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < g->triangle_count; i++)
        for (int k = 0; k < 3; k++) box = rt_box_add_point(box, g->triangles[i].v[k]);
    return rt_box_largest_coordinate(box) > 64 * rt_box_longest_side(box);
}

/* Makes a part of the mesh, as if it were a scene of its own, and adds that to the scene. */
static RtStatus make_part(Nodes *nodes, const RtGltfItem *mesh, const Pose *pose, Shared *shared) {
    RtGltf *g = nodes->document;
    RT_OWNED(RtScene, part, rt_scene_clear);
    RtMeshReader *r = g->mesh;
    RtScene *scene = r->scene;
    const uint32_t material = r->material;
    Pose unmoved = *pose;
    unmoved.transform = rt_transform_identity();
    rt_scene_init(&part);
    RT_TRY(rt_scene_share_material(&part, &scene->materials[material], &r->material, r->text.error));
    part.warnings = scene->warnings;
    r->scene = &part;
    const RtStatus status = add_primitives(g, mesh, &unmoved);
    r->scene = scene;
    r->material = material;
    scene->warnings = part.warnings;
    part.warnings = (RtWarnings){0};
    shared->part = NO_PART;
    if (status != RT_OK || part.geometry.triangle_count < PART_TRIANGLES || is_far(&part.geometry))
        return status;
    shared->part = scene->part_count + 1;
    return rt_scene_add_part(scene, &part, r->text.error);
}

/* *done: the mesh in this pose is an instance, and has no triangles of its own. */
static RtStatus place_instance(Nodes *nodes, const RtGltfItem *mesh, const Pose *pose, bool *done) {
    RtGltf *g = nodes->document;
    Shared *shared = &nodes->shared[mesh->index];
    RtTransform inverse;
    *done = false;
    if (rt_transform_invert(&pose->transform, &inverse, NULL) != RT_OK) return RT_OK;
    if (shared->part == 0) RT_TRY(make_part(nodes, mesh, pose, shared));
    if (shared->part == NO_PART) return RT_OK;
    const Instance instance = {shared->part - 1, pose->transform};
    *done = true;
    return rt_append(&nodes->instances, &nodes->instance_count, &nodes->instance_capacity, &instance,
                     sizeof instance, g->mesh->text.error);
}

static RtStatus add_instances(const Nodes *nodes) {
    RtMeshReader *r = nodes->document->mesh;
    RtScene *scene = r->scene;
    for (uint32_t i = 0; i < nodes->instance_count; i++)
        RT_TRY(rt_scene_add_instance(scene, scene, nodes->instances[i].part, &nodes->instances[i].to_world,
                                     RT_OWN_MATERIALS, r->text.error));
    return RT_OK;
}

/* Adds the mesh of a node, if it has one: skinned, in each of its instances, or once. */
static RtStatus add_mesh_at(Nodes *nodes, const Place *place) {
    RtGltf *g = nodes->document;
    static const double t[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    RT_ARENA(memory);
    const RtGltfItem *node = &place->node, *mesh = &place->mesh;
    const json_t *weights = json_object_get(node->object, "weights"),
                 *extensions = json_object_get(node->object, "extensions"),
                 *instancing = json_object_get(extensions, "EXT_mesh_gpu_instancing");
    const RtGltfItem attributes = rt_gltf_inside(node, json_object_get(instancing, "attributes"));
    Pose pose = {.weights = weights ? weights : json_object_get(mesh->object, "weights")};
    RtGltfValues moves, turns, scales;
    if (!mesh->object) return RT_OK;
    if (!json_is_array(json_object_get(mesh->object, "primitives")))
        return rt_gltf_fail(g, mesh, "expected primitives, a list");
    RT_TRY(read_skin(nodes, node, &memory, &pose));
    RT_TRY(rt_gltf_accessor(g, &attributes, "TRANSLATION", 3, 0, &memory, &moves));
    RT_TRY(rt_gltf_accessor(g, &attributes, "ROTATION", 4, moves.count, &memory, &turns));
    RT_TRY(
        rt_gltf_accessor(g, &attributes, "SCALE", 3, moves.at ? moves.count : turns.count, &memory, &scales));
    const uint32_t count = moves.at ? moves.count : turns.at ? turns.count : scales.count;
    const bool repeats =
        g->mesh->whole && !pose.joints && !weights && (count > 1 || nodes->shared[mesh->index].places > 1);
    if (count > 0 && pose.joints) return rt_gltf_fail(g, node, "expected a skin or instances, found both");
    for (size_t i = 0; i < (count > 0 ? count : 1); i++) {
        const RtTransform instance =
            compose_steps(moves.at ? moves.at + 3 * i : t, turns.at ? turns.at + 4 * i : q,
                          scales.at ? scales.at + 3 * i : s);
        pose.transform = rt_transform_compose(&instance, &place->transform);
        bool placed = false;
        if (repeats) RT_TRY(place_instance(nodes, mesh, &pose, &placed));
        if (!placed && count > 0)
            RT_TRY(rt_mesh_warn(g->mesh, "instances (EXT_mesh_gpu_instancing) become copies"));
        if (!placed) RT_TRY(add_primitives(g, mesh, &pose));
    }
    return RT_OK;
}

/* ---- the file ---- */

static RtStatus read_document(Nodes *nodes, const char *text, size_t size) {
    RtGltf *g = nodes->document;
    const RtScanner *file = &g->mesh->text;
    json_error_t where;
    if (size > RT_MESH_MAX_JSON)
        return rt_mesh_fail(g->mesh, "its JSON has %zu bytes: the limit is %d", size, RT_MESH_MAX_JSON);
    while (size > 0 && text[size - 1] == 0) size--; /* a chunk's padding should be blanks */
    g->root =
        json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_ALLOW_NUL | JSON_DECODE_INT_AS_REAL, &where);
    if (!g->root && json_error_code(&where) == json_error_out_of_memory)
        return rt_fail_memory(file->error, "glTF", size);
    if (!g->root)
        return rt_fail_at(file->error, file->path, (size_t)where.line, (size_t)where.column, "%s",
                          where.text);
    const char *version = json_string_value(json_object_get(json_object_get(g->root, "asset"), "version"));
    if (!version || strncmp(version, "2.", 2) != 0)
        return rt_mesh_fail(g->mesh, "expected glTF 2.0, with {\"asset\": {\"version\": \"2.0\"}}");
    g->buffers =
        rt_arena_alloc(&g->memory, json_array_size(json_object_get(g->root, "buffers")), sizeof *g->buffers);
    nodes->shared = rt_arena_alloc(&g->memory, json_array_size(json_object_get(g->root, "meshes")),
                                   sizeof *nodes->shared);
    RT_TRY(rt_arena_check(&g->memory, "buffers of glTF", file->error));
    RT_TRY(rt_gltf_check_extensions(g, "extensionsRequired", true));
    RT_TRY(rt_gltf_check_extensions(g, "extensionsUsed", false));
    if (json_array_size(json_object_get(g->root, "animations")) > 0)
        RT_TRY(rt_mesh_warn(g->mesh, "its animations are left out: everything is at rest"));
    RT_TRY(place_nodes(nodes));
    for (uint32_t i = 0; i < nodes->place_count; i++) RT_TRY(add_mesh_at(nodes, &nodes->places[i]));
    return add_instances(nodes);
}

static RtStatus read_all(RtMeshReader *r, const char *text, size_t size, RtGltfBuffer chunk) {
    RtGltf g = {.mesh = r, .chunk = chunk, .size = size};
    Nodes nodes = {.document = &g};
    RtStatus status = read_document(&nodes, text, size);
    for (size_t i = 0; g.buffers && i < json_array_size(json_object_get(g.root, "buffers")); i++) {
        if (g.buffers[i].data != chunk.data) rt_free(g.buffers[i].data);
    }
    rt_arena_clear(&g.memory);
    rt_free(nodes.places);
    rt_free(nodes.instances);
    json_decref(g.root);
    return status;
}

RtStatus rt_mesh_read_gltf(RtMeshReader *r) {
    RT_TRY(rt_mesh_begin_text(r));
    return read_all(r, r->text.at, (size_t)(r->text.end - r->text.at), (RtGltfBuffer){0});
}

enum { GLB_HEADER = 12, CHUNK_HEADER = 8 };

RtStatus rt_mesh_check_glb(RtMeshReader *r, const RtMeshHead *head) {
    const unsigned char *b = head->bytes;
    if (memcmp(b, "glTF", 4) != 0)
        return rt_mesh_fail(r, "this is no binary glTF: it does not begin with 'glTF'");
    if (rt_mesh_u32(b + 4) == 2) return RT_OK;
    return rt_mesh_fail(r, "this is glTF %u: only 2 can be read", rt_mesh_u32(b + 4));
}

/* Chunks of other types are ignored. */
RtStatus rt_mesh_read_glb(RtMeshReader *r) {
    RtScanner *text = &r->text;
    const ptrdiff_t size = text->end - text->at, declared = size < GLB_HEADER ? 0 : rt_mesh_u32(text->at + 8);
    RtGltfBuffer json = {0}, binary = {0};
    if (declared < GLB_HEADER || declared > size)
        return rt_mesh_fail(r, "the header declares %td bytes, but the file has %td: cut off", declared,
                            size);
    const char *end = text->at + declared;
    text->at += GLB_HEADER;
    while (end - text->at >= CHUNK_HEADER) {
        const RtGltfBuffer chunk = {(char *)text->at + CHUNK_HEADER, rt_mesh_u32(text->at)};
        const size_t left = (size_t)(end - chunk.data);
        if (chunk.size > left)
            return rt_mesh_fail(r, "a chunk declares %zu bytes, but has %zu", chunk.size, left);
        if (!json.data && memcmp(text->at + 4, "JSON", 4) == 0) json = chunk;
        if (!binary.data && memcmp(text->at + 4, "BIN", 4) == 0) binary = chunk;
        text->at = chunk.data + chunk.size;
    }
    if (!json.data) return rt_mesh_fail(r, "it has no chunk JSON");
    RT_TRY(rt_mesh_end_binary(r));
    return read_all(r, json.data, json.size, binary);
}
