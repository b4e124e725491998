/* SPDX-License-Identifier: Apache-2.0 */
/* measure/node_file.h: the rows of a structure are those that it describes, and form a tree. */
#include "scene_testing.h"

#include "accel/accel.h"
#include "measure/node_file.h"
#include "scenes/open.h"

static const char path[] = RT_BINARY_DIR "/test_node_file.csv";

typedef struct Row {
    uint32_t level, children, objects, found; /* found: rows that name it as their parent */
    bool leaf;
    RtBox box;
} Row;

enum { MOST = 20000 };
static Row rows[MOST];

static RtBox box_of(const float at[6]) {
    return (RtBox){{{at[0], at[1], at[2]}}, {{at[3], at[4], at[5]}}};
}

static bool is_inside(const RtBox *in, const RtBox *out) {
    for (int a = 0; a < 3; a++)
        if (in->lo.at[a] < out->lo.at[a] || in->hi.at[a] > out->hi.at[a]) return false;
    return true;
}

/* Reads the file into rows; each follows its parent, and lies one level below it, inside its box. */
static uint32_t read_rows(bool nested) {
    char line[400];
    uint32_t count = 0;
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_non_null(fgets(line, sizeof line, file));
    assert_string_equal(line, "node,parent,level,leaf,children,objects,lo_x,lo_y,lo_z,hi_x,hi_y,hi_z\n");
    for (; fgets(line, sizeof line, file); count++) {
        Row row = {0};
        float at[6];
        const char *cells[12] = {line};
        uint32_t cell = 1;
        for (char *c = line; *c; c++)
            if (*c == ',') *c = '\0', cells[cell++] = c + 1;
        assert_int_equal(cell, 12);
        assert_int_equal(atoi(cells[0]), count);
        row.level = (uint32_t)atoi(cells[2]);
        row.leaf = strcmp(cells[3], "true") == 0;
        row.children = (uint32_t)atoi(cells[4]);
        row.objects = (uint32_t)atoi(cells[5]);
        for (int i = 0; i < 6; i++) at[i] = strtof(cells[6 + i], NULL);
        row.box = box_of(at);
        if (*cells[1]) {
            Row *parent = &rows[atoi(cells[1])];
            assert_true((uint32_t)atoi(cells[1]) < count && parent->level + 1 == row.level);
            if (nested) assert_true(is_inside(&row.box, &parent->box));
            parent->found++;
        }
        assert_true(count < MOST);
        rows[count] = row;
    }
    fclose(file);
    return count;
}

RT_TEST(the_nodes_in_a_file_are_those_that_the_structure_describes_and_form_a_tree) {
    static const struct {
        const char *spec;
        bool nested;
    } cases[] = {{"bvh", true},
                 {"clusters", false},
                 {"kd", true},
                 {"octree", true},
                 {"octree:max_leaf_size=1", true},
                 {"extents", false},
                 {"wide", true},
                 {"grid", true},
                 {"grid:depth=2", true},
                 {"item+bvh", true}};
    OWNED_SCENE scene;
    assert_ok(rt_scene_open("balls:size=2", &scene, error));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtAccel *accel;
        RtDescription structure;
        uint32_t count;
        uint64_t leaves = 0, objects = 0;
        assert_ok(rt_accel_open(cases[i].spec, &scene, &accel, error));
        assert_ok(rt_nodes_save(accel, path, &count, error));
        assert_int_equal(read_rows(cases[i].nested), count);
        const RtAccel *layer = accel;
        while (!layer->ops->each_box) layer = layer->below;
        layer->ops->describe(layer, (structure = (RtDescription){0}, &structure));
        for (uint32_t k = 0; k < count; k++) {
            assert_int_equal(rows[k].children, rows[k].found);
            assert_true(!rows[k].leaf || rows[k].children == 0);
            leaves += rows[k].leaf;
            objects += rows[k].objects;
        }
        if (layer->ops->shows_lists) {
            assert_int_equal(leaves, structure.leaves);
            assert_int_equal(objects, structure.references);
        }
        rt_accel_destroy(accel);
    }
}

RT_TEST(a_structure_without_boxes_is_refused) {
    OWNED_SCENE scene;
    RtAccel *accel;
    uint32_t count;
    assert_ok(rt_scene_open("balls:size=1", &scene, error));
    assert_ok(rt_accel_open("brute", &scene, &accel, error));
    assert_bad_input(rt_nodes_save(accel, path, &count, error), "brute has no nodes or voxels to write");
    rt_accel_destroy(accel);
}

RT_TESTS(node_file, NULL, NULL)
