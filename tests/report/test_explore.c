/* SPDX-License-Identifier: Apache-2.0 */
/* The data of the explorer's page, read back: bytes, rays and paths of pixels, objects, boxes and cells. In a
 * browser: tests/check_pages.sh. */
#include "accel_testing.h"

#include "render/render_testing.h"
#include "report/explore_record.h"

#include <zlib.h>

#define OWNED_BYTES     OWNED(rt_bytes_clear) RtBytes
#define OWNED_RECORDING OWNED(rt_recorded_pixels_clear) RtRecordedPixels

/* ---- reading ---- */

typedef struct Reader {
    const uint8_t *data;
    size_t at, count;
} Reader;

static uint64_t take_number(Reader *r) {
    uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
        assert_true(r->at < r->count);
        const uint8_t byte = r->data[r->at++];
        value |= (uint64_t)(byte & 127) << shift;
        if (byte < 128) return value;
    }
}

static uint32_t take_u32(Reader *r) {
    uint32_t value = 0;
    assert_true(r->at + 4 <= r->count);
    for (int i = 0; i < 4; i++) value |= (uint32_t)r->data[r->at++] << 8 * i;
    return value;
}

static float take_float(Reader *r) {
    const uint32_t bits = take_u32(r);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static RtVec3 take_vector(Reader *r) {
    RtVec3 v;
    for (int a = 0; a < 3; a++) v.at[a] = take_float(r);
    return v;
}

static Reader read_bytes(const RtBytes *bytes) {
    assert_int_equal(bytes->status, RT_OK);
    return (Reader){bytes->data, 0, bytes->count};
}

/* What compressed bytes hold; a buffer of the caller's. */
static Reader expand(const RtBytes *bytes, uint8_t *buffer, size_t size) {
    uLongf count = size;
    assert_int_equal(uncompress(buffer, &count, bytes->data, bytes->count), Z_OK);
    return (Reader){buffer, 0, count};
}

/* ---- bytes ---- */

static RtStatus fill_and_compress(RtError *error) {
    OWNED_BYTES bytes = {0};
    for (uint32_t i = 0; i < 3000; i++) rt_bytes_put_number(&bytes, i);
    return rt_bytes_compress(&bytes, error);
}

RT_TEST(bytes_that_memory_does_not_suffice_for_fail_when_they_are_compressed) {
    assert_fails_cleanly(fill_and_compress(error), (void)0);
}

/* ---- pixels ---- */

enum { WIDTH = 19, HEIGHT = 17, DEPTH = 4, ROOM = 1 << 23 };
static const char *const specs[] = {"item+light:cells=4+bvh", "grid"};
enum { SPECS = sizeof specs / sizeof specs[0] };

static RtScene open_busy(void) {
    RtScene scene = busy_scene();
    assert_ok(rt_scene_sample(&scene, WIDTH, HEIGHT, 1, false, error));
    return scene;
}

static RtRecordedPixels record(RtAccel *const accels[SPECS], uint32_t bytes) {
    RtRecordedPixels recording;
    const RtExploreOptions options = {.depth = DEPTH, .bytes = bytes};
    assert_ok(rt_recorded_pixels_make(&recording, accels, SPECS, &options, error));
    return recording;
}

typedef struct ReadRay {
    uint32_t kind, source;
    uint64_t object;
    float t;
    RtVec3 added, diffuse;
} ReadRay;

/* The ray of index `i` of its tree. */
static ReadRay take_ray(Reader *r, uint32_t i) {
    ReadRay ray = {.kind = (uint32_t)take_number(r)};
    take_number(r); /* its level */
    const uint64_t parent = take_number(r);
    assert_true(i == 0 ? parent == 0 : parent > 0 && parent <= i);
    assert_true((ray.kind == RT_RAY_PRIMARY) == (i == 0));
    ray.source = (uint32_t)take_number(r);
    take_number(r); /* flags */
    take_vector(r);
    take_vector(r);
    take_float(r);
    ray.object = take_number(r);
    ray.t = take_float(r);
    ray.added = take_vector(r);
    if (ray.kind == RT_RAY_SHADOW) ray.diffuse = take_vector(r);
    for (uint64_t left = ray.kind == RT_RAY_PRIMARY ? take_number(r) : 0; left > 0; left--) {
        take_number(r);
        take_float(r);
    }
    return ray;
}

/* Begins a pixel: returns where it ends. */
static size_t begin_pixel(Reader *r, uint64_t *number) {
    *number = take_number(r);
    const uint32_t length = take_u32(r);
    return r->at + length;
}

RT_TEST(each_pixel_is_recorded_once_and_its_rays_add_up_to_the_color_of_the_frame_bit_for_bit) {
    OWNED_SCENE scene = open_busy();
    OWNED_ACCEL RtAccel *item = open_accel(&scene, specs[0]), *grid = open_accel(&scene, specs[1]);
    OWNED_RECORDING recording = record((RtAccel *[]){item, grid}, ROOM);
    OWNED_FRAME frame;
    OWNED_MEMORY uint8_t *buffer = rt_alloc(ROOM, 1);
    bool seen[WIDTH * HEIGHT] = {false};
    Reader r = expand(&recording.rays, buffer, ROOM);
    uint32_t pixels = 0, highlights = 0;
    assert_ok(rt_frame_trace(&frame, grid, &(RtFrameOptions){.depth = DEPTH}, error));
    assert_int_equal(recording.stride, 1);
    for (; r.at < r.count; pixels++) {
        uint64_t number;
        RtVec3 color = rt_vec3(0, 0, 0);
        const size_t end = begin_pixel(&r, &number);
        assert_true(number < WIDTH * HEIGHT && !seen[number]);
        seen[number] = true;
        for (uint32_t i = 0; r.at < end; i++) {
            const ReadRay ray = take_ray(&r, i);
            color = rt_add(color, ray.added);
            highlights += ray.kind == RT_RAY_SHADOW && ray.added.x > ray.diffuse.x;
            if (ray.kind == RT_RAY_SHADOW) assert_true(ray.added.x >= ray.diffuse.x && ray.diffuse.x >= 0);
            if (i == 0) assert_int_equal(ray.source, number);
        }
        assert_int_equal(r.at, end);
        assert_memory_equal(&color, &frame.color[number], sizeof color);
    }
    assert_int_equal(pixels, WIDTH * HEIGHT);
    assert_true(highlights > 0);
}

/* Of a path, the counters are in *tally. */
static uint64_t take_path(Reader *r, const RtRecordedPaths *paths, float *t, RtTally *tally) {
    const uint64_t object = take_number(r);
    *t = take_float(r);
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        const uint64_t value = take_number(r);
        if (strcmp(rt_tally_name(i), "object_tests") == 0) tally->object_tests = value;
    }
    if (take_number(r) > 0) {
        for (int i = 0; i < 3; i++) take_number(r); /* of its cell */
    }
    const uint64_t rows = take_number(r), kept = take_number(r);
    uint64_t tests = 0;
    assert_true(kept <= rows && kept <= RT_MAX_RECORDED_ROWS);
    for (uint64_t i = 0; i < kept; i++) {
        const uint64_t event = take_number(r);
        assert_true(event < paths->event_count);
        const RtPathRow *row = &paths->forms[paths->events[event].form];
        tests += row->kind == RT_TRACED_OBJECT_TEST;
        if (row->kind == RT_TRACED_OBJECT_TEST && row->met) take_float(r);
    }
    if (kept == rows) assert_int_equal(tests, tally->object_tests);
    return object;
}

RT_TEST(each_path_ends_at_the_hit_of_its_ray_and_its_rows_add_up_to_its_counters) {
    OWNED_SCENE scene = open_busy();
    OWNED_ACCEL RtAccel *item = open_accel(&scene, specs[0]), *grid = open_accel(&scene, specs[1]);
    OWNED_RECORDING recording = record((RtAccel *[]){item, grid}, ROOM);
    OWNED_MEMORY uint8_t *ray_buffer = rt_alloc(ROOM, 1), *buffer = rt_alloc(ROOM, 1);
    for (uint32_t a = 0; a < SPECS; a++) {
        Reader rays = expand(&recording.rays, ray_buffer, ROOM);
        Reader paths = expand(&recording.of[a].paths, buffer, ROOM);
        while (rays.at < rays.count) {
            uint64_t number, of_path;
            const size_t end = begin_pixel(&rays, &number), path_end = begin_pixel(&paths, &of_path);
            assert_int_equal(number, of_path);
            for (uint32_t i = 0; rays.at < end; i++) {
                RtTally tally = {0};
                float t;
                const ReadRay ray = take_ray(&rays, i);
                const uint64_t object = take_path(&paths, &recording.of[a], &t, &tally);
                if (ray.kind == RT_RAY_SHADOW) {
                    assert_true((object == 0) == (ray.object == 0));
                } else {
                    assert_int_equal(object, ray.object);
                    assert_memory_equal(&t, &ray.t, sizeof t);
                }
            }
            assert_int_equal(paths.at, path_end);
        }
        assert_int_equal(paths.at, paths.count);
    }
}

RT_TEST(pixels_are_left_out_evenly_until_the_record_fits) {
    OWNED_SCENE scene = open_busy();
    OWNED_ACCEL RtAccel *item = open_accel(&scene, specs[0]), *grid = open_accel(&scene, specs[1]);
    OWNED_RECORDING recording = record((RtAccel *[]){item, grid}, 30000);
    OWNED_MEMORY uint8_t *buffer = rt_alloc(ROOM, 1);
    Reader r = expand(&recording.rays, buffer, ROOM);
    const uint32_t stride = recording.stride;
    uint32_t pixels = 0;
    assert_in_range(stride, 2, 8);
    for (; r.at < r.count; pixels++) {
        uint64_t number;
        const size_t end = begin_pixel(&r, &number);
        const uint64_t column = number % recording.columns * stride + stride / 2,
                       row = number / recording.columns * stride + stride / 2;
        assert_int_equal(take_ray(&r, 0).source, row * WIDTH + column);
        r.at = end;
    }
    assert_int_equal(pixels, recording.columns * recording.rows);
}

RT_TEST(a_record_that_cannot_hold_a_single_pixel_is_refused) {
    OWNED_SCENE scene = open_busy();
    OWNED_ACCEL RtAccel *grid = open_accel(&scene, "grid");
    RtRecordedPixels recording;
    const RtExploreOptions options = {.depth = DEPTH, .bytes = 20};
    assert_fails_with(rt_recorded_pixels_make(&recording, &grid, 1, &options, error), RT_BAD_INPUT,
                      "a single pixel do not fit");
}

/* ---- what is drawn ---- */

static uint64_t skip_shapes(Reader *r, int floats) {
    const uint64_t count = take_number(r);
    for (uint64_t i = 0; i < count; i++) {
        for (int f = 0; f < floats; f++) take_float(r);
        take_number(r); /* its material */
    }
    return count;
}

static void assert_shapes(const RtScene *scene, uint64_t every, uint64_t spheres, uint64_t triangles,
                          uint64_t boxes) {
    OWNED_BYTES bytes = {0};
    assert_int_equal(rt_explore_objects(scene, &bytes), every);
    Reader r = read_bytes(&bytes);
    assert_int_equal(skip_shapes(&r, 4), spheres);
    assert_int_equal(skip_shapes(&r, 9), triangles);
    assert_int_equal(skip_shapes(&r, 6), boxes);
    assert_int_equal(r.at, r.count);
}

RT_TEST(objects_are_drawn_as_spheres_triangles_and_boxes) {
    OWNED_SCENE busy = open_busy(), csg = open_scene(RT_SOURCE_DIR "/scenes/prism.yaml");
    /* four squares of two triangles each, a triangle, and a cone of 16 quadrangles */
    assert_shapes(&busy, 1, 10, 4 * 2 + 1 + 16 * 2, 0);
    assert_shapes(&csg, 1, 0, 4, 1);
}

RT_TEST(every_second_object_is_drawn_if_there_are_too_many) {
    OWNED_SCENE scene = open_scene("random:n=100001,shape=sphere");
    assert_shapes(&scene, 2, 50001, 0, 0);
}

enum { LEVELS = 64 };

static void count_level(void *context, const RtBoxView *view) {
    if (view->depth < LEVELS) ((uint32_t *)context)[view->depth]++;
}

/* Reads the boxes, and counts those of each depth. */
static RtShownBoxes count_shown(const RtAccel *accel, uint32_t counts[LEVELS], uint64_t *listed) {
    OWNED_BYTES bytes = {0};
    const RtShownBoxes shown = rt_explore_boxes(accel, &bytes);
    Reader r = read_bytes(&bytes);
    uint32_t boxes = 0;
    for (*listed = 0; r.at < r.count; boxes++) {
        const RtVec3 lo = take_vector(&r), hi = take_vector(&r);
        assert_true(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z);
        const uint64_t depth = take_number(&r), list = take_number(&r);
        assert_true(depth < LEVELS);
        counts[depth]++;
        *listed += list > 0 ? list - 1 : 0;
    }
    assert_int_equal(boxes, shown.shown);
    return shown;
}

RT_TEST(all_boxes_of_a_small_structure_are_shown_also_below_overlays) {
    OWNED_SCENE scene = open_busy();
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, specs[0]);
    uint32_t counts[LEVELS] = {0}, all[LEVELS] = {0};
    uint64_t listed;
    const RtShownBoxes shown = count_shown(accel, counts, &listed);
    assert_string_equal(shown.layer->ops->name, "bvh");
    assert_int_equal(shown.level, UINT32_MAX);
    assert_int_equal(listed, scene.geometry.object_count);
    shown.layer->ops->each_box(shown.layer, (RtBoxViewer){count_level, all});
    assert_memory_equal(counts, all, sizeof all);
}

RT_TEST(of_too_many_boxes_the_upper_levels_are_shown_in_full_and_a_part_of_the_next) {
    OWNED_SCENE scene = open_scene("random:n=60000");
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "bvh:build=lbvh");
    uint32_t counts[LEVELS] = {0}, all[LEVELS] = {0};
    uint64_t listed;
    const RtShownBoxes shown = count_shown(accel, counts, &listed);
    accel->ops->each_box(accel, (RtBoxViewer){count_level, all});
    assert_true(shown.all > RT_MAX_SHOWN_BOXES && shown.shown <= RT_MAX_SHOWN_BOXES);
    assert_true(shown.level < LEVELS);
    for (uint32_t depth = 0; depth < LEVELS; depth++) {
        const uint32_t part = (all[depth] + shown.every - 1) / shown.every;
        assert_int_equal(counts[depth], depth < shown.level ? all[depth] : depth == shown.level ? part : 0);
    }
}

/* The direction in the middle of a map's pixel as seen from the light: sides are -x, +x, -y, ..., columns go
 * along the next axis, rows along the one after. */
static RtVec3 seen_from_light(uint32_t side, uint32_t column, uint32_t row) {
    const uint32_t axis = side / 2;
    RtVec3 away;
    away.at[axis] = side % 2 ? 1 : -1;
    away.at[(axis + 1) % 3] = ((float)column + 0.5f) / (RT_CELL_MAP / 2) - 1;
    away.at[(axis + 2) % 3] = ((float)row + 0.5f) / (RT_CELL_MAP / 2) - 1;
    return away;
}

RT_TEST(the_map_around_a_light_shows_the_cell_that_a_shadow_ray_is_looked_up_in) {
    OWNED_SCENE scene = open_busy();
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "light:cells=4+bvh");
    OWNED_BYTES bytes = {0};
    rt_explore_cells(accel, &bytes);
    Reader r = read_bytes(&bytes);
    uint32_t found = 0, sides = 6 * scene.light_count;
    for (uint32_t i = 0; i < sides * RT_CELL_MAP * RT_CELL_MAP; i++) {
        const uint32_t side = i / (RT_CELL_MAP * RT_CELL_MAP), row = i / RT_CELL_MAP % RT_CELL_MAP;
        const RtVec3 away = seen_from_light(side % 6, i % RT_CELL_MAP, row);
        const RtRay ray = {.dir = rt_scale(away, -1), .kind = RT_RAY_SHADOW, .source = side / 6};
        RtCellView cell;
        const bool inside = accel->ops->find_cell(accel, &ray, &cell);
        found += inside;
        assert_int_equal(take_number(&r), inside ? (uint64_t)cell.number + 1 : 0);
        assert_int_equal(take_number(&r), inside ? cell.length : 0);
    }
    assert_int_equal(r.at, r.count);
    assert_true(found > 1000);
}

RT_TESTS(explore, NULL, assert_nothing_is_kept)
