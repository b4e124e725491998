/* SPDX-License-Identifier: Apache-2.0 */
/* measure/measure.h: arrays of rays as NumPy writes them, and files that are invalid or of other types. */
#include "experiment_testing.h"

#include "core/base/file.h"
#include "measure/measure.h"

#include <fcntl.h>

#define NEEDED      "expected float32 of the shape (N, 8)"
#define SHAPE(text) "{'descr': '<f4', 'fortran_order': False, 'shape': " text ", }"

/* A file of version `major`.`minor`, of this header, and `bytes` bytes of ones: each eight are a ray. */
static Path write_array(const Place *place, int major, int minor, const char *header, size_t bytes) {
    Path path = path_in(place, "some.npy");
    FILE *out = fopen(path.text, "wb");
    assert_non_null(out);
    size_t length = strlen(header);
    fputs("\x93NUMPY", out);
    const unsigned char rest[] = {(unsigned char)major,
                                  (unsigned char)minor,
                                  (unsigned char)(length & 255),
                                  (unsigned char)(length >> 8),
                                  0,
                                  0};
    fwrite(rest, 1, major == 1 ? 4 : 6, out);
    fputs(header, out);
    const float one = 1;
    for (size_t i = 0; i < bytes; i++) fputc(((const unsigned char *)&one)[i % 4], out);
    fclose(out);
    return path;
}

PLACES_WITH(NULL)

PLACE_TEST(headers_of_any_version_and_order_of_keys_are_read) {
    const struct {
        int major;
        const char *header;
    } cases[] = {{1, SHAPE("(2, 8)")},
                 {1, SHAPE("(2, 8)") "      \n"},
                 {2, SHAPE("(2, 8)")},
                 {3, SHAPE("(2,8,)")},
                 {1, "{\"shape\":(2,8),\"fortran_order\":False,\"descr\":\"<f4\"}"},
                 {1, "  { 'fortran_order' : False , 'descr' : '<f4' , 'shape' : ( 2 , 8 ) , }\n\n"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtRaySet set;
        Path path = write_array(place, cases[i].major, 0, cases[i].header, 64);
        assert_ok(rt_rays_load(path.text, RT_RAY_RANDOM, &set, error));
        assert_int_equal(set.count, 2);
        rt_rayset_clear(&set);
    }
}

PLACE_TEST(arrays_of_another_type_order_shape_or_length_are_refused) {
    const struct {
        int major, minor;
        const char *header;
        size_t bytes;
        const char *says;
    } cases[] = {
        {1, 1, SHAPE("(2, 8)"), 64, "version 1.1"},
        {4, 0, SHAPE("(2, 8)"), 64, "version 4.0"},
        {0, 0, SHAPE("(2, 8)"), 64, "version 0.0"},
        {1, 0, SHAPE("(2, 8)"), 63, "64 bytes, but 63 follow"},
        {1, 0, SHAPE("(2, 8)"), 65, "64 bytes, but 65 follow"},
        {1, 0, SHAPE("(2, 8)"), 0, "cut off"},
        {1, 0, SHAPE("(2, 7)"), 56, NEEDED},
        {1, 0, SHAPE("(16,)"), 64, NEEDED},
        {1, 0, SHAPE("()"), 4, NEEDED},
        {1, 0, SHAPE("(2, 8, 1)"), 64, NEEDED},
        {1, 0, SHAPE("(9223372036854775807, 8)"), 64, "at most"},
        {1, 0, SHAPE("(18446744073709551616, 8)"), 64, "the header is not"},
        {1, 0, SHAPE("(-2, 8)"), 64, "the header is not"},
        {1, 0, SHAPE("(2 8)"), 64, "the header is not"},
        {1, 0, SHAPE("(2)"), 64, NEEDED},
        {1, 0, SHAPE("(2, 8"), 64, "the header is not"},
        {1, 0, SHAPE("2, 8"), 64, "the header is not"},
        {1, 0, SHAPE("(2, 8)") "x", 64, "the header is not"},
        {1, 0, "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 8)}", 128, NEEDED},
        {1, 0, "{'descr': '>f4', 'fortran_order': False, 'shape': (2, 8)}", 64, NEEDED},
        {1, 0, "{'descr': [('t', '<f4')], 'fortran_order': False, 'shape': (2, 8)}", 64, NEEDED},
        {1, 0, "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 8)}", 64, "column-major"},
        {1, 0, "{'descr': '<f4', 'fortran_order': 0, 'shape': (2, 8)}", 64, "the header is not"},
        {1, 0, "{'descr': '<f4', 'shape': (2, 8)}", 64, "the header is not"},
        {1, 0, "{'descr': '<f4', 'fortran_order': False}", 64, "the header is not"},
        {1, 0, "{'fortran_order': False, 'shape': (2, 8)}", 64, "the header is not"},
        {1, 0, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 8), 'more': 1}", 64,
         "the header is not"},
        {1, 0, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 8), 'shape': (2, 8)}", 64,
         "the header is not"},
        {1, 0, "{'descr': '<f4, 'fortran_order': False, 'shape': (2, 8)}", 64, "the header is not"},
        {1, 0, "", 64, "the header is not"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtRaySet set;
        Path path = write_array(place, cases[i].major, cases[i].minor, cases[i].header, cases[i].bytes);
        assert_bad_input(rt_rays_load(path.text, RT_RAY_RANDOM, &set, error), cases[i].says);
    }
}

/* Whichever byte changes, and wherever the file ends, it is read as the array or rejected. */
PLACE_TEST(no_damage_to_a_file_goes_further_than_a_message) {
    const char header[] = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 8), }\n";
    Path path = write_array(place, 1, 0, header, 64);
    char bytes[256];
    int file = open(path.text, O_RDWR); /* written in place: a file that is replaced may wait for the disk */
    size_t size = (size_t)read(file, bytes, sizeof bytes);
    for (size_t at = 0; at < size - 64; at++) {
        for (int value = -1; value < 256; value++) { /* -1: cut off here */
            char damaged[sizeof bytes];
            RtRaySet set;
            RtError why = {RT_OK, ""};
            memcpy(damaged, bytes, size);
            if (value >= 0) damaged[at] = (char)value;
            assert_int_equal(pwrite(file, damaged, size, 0), size);
            assert_int_equal(ftruncate(file, (off_t)(value < 0 ? at : size)), 0);
            RtStatus status = rt_rays_load(path.text, RT_RAY_RANDOM, &set, &why);
            assert_true(status == RT_OK ? set.count == 2 : status == RT_BAD_INPUT && why.message[0]);
            rt_rayset_clear(&set);
        }
    }
    close(file);
}

/* ---- hits ---- */

/* A file of version 1.0 with these bytes after the header. */
static Path write_bytes(const Place *place, const char *header, const void *bytes, size_t size) {
    Path path = write_array(place, 1, 0, header, 0);
    FILE *out = fopen(path.text, "ab");
    assert_non_null(out);
    assert_int_equal(fwrite(bytes, 1, size, out), size);
    fclose(out);
    return path;
}

#define HITS(type, count) "{'descr': " type ", 'fortran_order': False, 'shape': (" count "), }"

PLACE_TEST(hits_with_integers_of_any_size_and_other_fields_are_read) {
    enum { MISS = -1 };
    const struct __attribute__((packed)) {
        float t;
        int64_t object;
    } longs[2] = {{2, 5}, {INFINITY, MISS}};
    const struct __attribute__((packed)) {
        uint32_t object;
        char padding[3];
        float t;
    } shorts[2] = {{5, {1, 1, 1}, 2}, {UINT32_MAX, {1, 1, 1}, 7}};
    const struct {
        const char *header;
        const void *bytes;
        size_t size;
    } cases[] = {
        {HITS("[('t', '<f4'), ('object', '<i8')]", "2,"), longs, sizeof longs},
        {HITS("[('t', '<f4'), ('object', '<u8')]", "2,"), longs, sizeof longs},
        {HITS("[('object', '<u4'), ('', '|V3'), ('t', '<f4')]", "2,"), shorts, sizeof shorts},
        {HITS("[('object', '<i4'), ('a', '|u1'), ('b', '<i2'), ('t', '<f4')]", "2,"), shorts, sizeof shorts}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        OWNED_MEMORY RtHit *hits = NULL;
        Path path = write_bytes(place, cases[i].header, cases[i].bytes, cases[i].size);
        assert_ok(rt_hits_load(path.text, 2, 6, &hits, error));
        assert_true(hits[0].t == 2 && hits[0].object == 5);
        assert_true(hits[1].t == INFINITY && hits[1].object == RT_NO_OBJECT);
    }
}

PLACE_TEST(a_hit_that_is_t_alone_has_no_name_and_a_miss_is_infinite) {
    const float t[2] = {2, INFINITY};
    const char *const headers[] = {HITS("'<f4'", "2,"), HITS("'<f4'", "2, 1")};
    for (size_t i = 0; i < 2; i++) {
        OWNED_MEMORY RtHit *hits = NULL;
        Path path = write_bytes(place, headers[i], t, sizeof t);
        assert_ok(rt_hits_load(path.text, 2, 6, &hits, error));
        assert_true(hits[0].t == 2 && hits[0].object == RT_UNNAMED_OBJECT);
        assert_true(hits[1].t == INFINITY && hits[1].object == RT_NO_OBJECT);
    }
}

PLACE_TEST(hits_of_other_types_lengths_and_objects_are_refused_with_what_to_write) {
    const float t[4] = {1, -1, NAN, 1};
    const struct {
        const char *header, *says;
        uint64_t rays;
    } cases[] = {{HITS("'<f4'", "4,"), "4 hits for 3 rays", 3},
                 {HITS("'<f4'", "4,"), "row 1 (the first is 0): t is -1: a miss is written as infinity", 4},
                 {HITS("'<f4'", "2, 2"), "expected float32 of the shape (N,)", 2},
                 {HITS("'<f8'", "2,"), "'t' (float32) and 'object' (int32", 2},
                 {HITS("'|b1'", "16,"), "expected float32 of the shape (N,)", 16},
                 {HITS("[('t', '<f4'), ('object', '<i2'), ('x', '<i2')]", "2,"), "expected float32", 2},
                 {HITS("[('t', '<f4'), ('object', '<f4')]", "2,"), "expected float32", 2},
                 {HITS("[('t', '<f8'), ('object', '<i8')]", "1,"), "expected float32", 1},
                 {HITS("[('t', '<f4'), ('id', '<i4')]", "2,"), "expected float32", 2},
                 {HITS("[('object', '<i4'), ('id', '<i4')]", "2,"), "expected float32", 2},
                 {HITS("[('t', '<f4'), ('object', '<i4', (1,))]", "2,"), "expected float32", 2},
                 {HITS("[('t', '<f4'), ('object', '<i4')]", "2, 1"), "expected float32", 2},
                 {HITS("[('t', '<f4'), ('object', '<i4'), ('x', '|V9999')]", "2,"), "expected float32", 2},
                 {HITS("[('t', '<f4'), ('object', '<i4'), ('x', '')]", "2,"), "expected float32", 2},
                 {HITS("[('t', '<f4'), ('object', '<i4'), ('x', '<')]", "2,"), "expected float32", 2},
                 {HITS("[('t', '<f4'), ('object', '<i4')]", "1,"), "8 bytes, but 16 follow", 1},
                 {HITS("[('t', '<f4'), ('object', '<i4')]", "2,"),
                  "row 0 (the first is 0): there is no object -1082130432: the scene has 6, from 0 on", 2}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtHit *hits;
        Path path = write_bytes(place, cases[i].header, t, sizeof t);
        assert_bad_input(rt_hits_load(path.text, cases[i].rays, 6, &hits, error), cases[i].says);
        assert_null(hits);
    }
}

/* ---- text ---- */

static Path write_text(const Place *place, const char *text) {
    Path path = path_in(place, "some.csv");
    assert_ok(rt_file_write(path.text, text, strlen(text), error));
    return path;
}

PLACE_TEST(rays_as_text_keep_every_bit) {
    RtRay rays[] = {
        {.org = {{0.1f, -0.0f, 1e-45f}}, .tmin = 0x1.fffffep-1f, .dir = {{3e38f, 1, 2}}, .tmax = 3e38f},
        {.org = {{1000.00006f, 1 / 3.0f, -5e17f}}, .dir = {{0, 0, -1e-40f}}, .tmax = INFINITY}};
    const RtRaySet set = {.kind = RT_RAY_PRIMARY, .count = 2, .rays = rays};
    RtRaySet read;
    Path path = path_in(place, "some.csv");
    assert_ok(rt_rays_save(&set, path.text, error));
    assert_ok(rt_rays_load(path.text, RT_RAY_PRIMARY, &read, error));
    assert_int_equal(read.count, 2);
    assert_memory_equal(read.rays, rays, sizeof rays);
    rt_rayset_clear(&read);
}

PLACE_TEST(columns_of_text_are_found_by_name_and_an_interval_may_be_left_out) {
    RtRaySet set;
    Path path = write_text(place, "dz,dy,pixel, dx,oz,oy,ox\r\n6,5,a,4,3,2,1\r\n\r\n-6,5,b,4,3,2,1");
    assert_ok(rt_rays_load(path.text, RT_RAY_RANDOM, &set, error));
    assert_int_equal(set.count, 2);
    const RtRay ray = {.org = {{1, 2, 3}}, .dir = {{4, 5, -6}}, .tmax = INFINITY, .kind = RT_RAY_RANDOM};
    assert_memory_equal(&set.rays[1], &ray, sizeof ray);
    rt_rayset_clear(&set);
}

PLACE_TEST(hits_as_text_have_an_object_or_t_alone) {
    const char *const texts[] = {"object,t\n5,2\n-1,inf\n", "t,u\n2,0.5\ninf,0\n",
                                 "\xEF\xBB\xBFobject ,t\r\n5,2\r\n-1,inf\r\n"};
    for (size_t i = 0; i < 3; i++) {
        OWNED_MEMORY RtHit *hits = NULL;
        Path path = write_text(place, texts[i]);
        assert_ok(rt_hits_load(path.text, 2, 6, &hits, error));
        assert_true(hits[0].t == 2 && hits[0].object == (i == 1 ? RT_UNNAMED_OBJECT : 5));
        assert_true(hits[1].t == INFINITY && hits[1].object == RT_NO_OBJECT);
    }
}

PLACE_TEST(text_without_its_columns_or_numbers_is_refused) {
    const struct {
        const char *text, *says;
        bool hits;
    } cases[] = {
        {"", "expected ox,oy,oz,tmin,dx,dy,dz,tmax, with or without", false},
        {"ox,oy,oz,dx,dy\n1,2,3,4,5\n", "the first line names the columns", false},
        {"1,2,3,4,5,6,7,8\n", "the first line names the columns", false},
        {"ox,oy,oz,dx,dy,dz\n", "it contains no rays", false},
        {"ox,oy,oz,dx,dy,dz\n1,2,3,4,5\n", "row 0 (the first is 0) has not the 6 columns", false},
        {"ox,oy,oz,dx,dy,dz\n1,2,3,4,5,6,7\n", "row 0 (the first is 0) has not the 6 columns", false},
        {"ox,oy,oz,dx,dy,dz\n1,2,3,4,5,6\n1,2,,4,5,6\n", "row 1 (the first is 0): oz is ''", false},
        {"ox,oy,oz,dx,dy,dz\n1,2,3,4,5,6x\n", "dz is '6x': no number", false},
        {"ox,oy,oz,dx,dy,dz\n1,2,3,0,0,0\n", "row 0 (the first is 0) is not a valid ray", false},
        {"object\n1\n", "expected t,object or t", true},
        {"t,object\n1,2.5\n", "object is '2.5': no integer", true},
        {"t,object\n1,6\n", "there is no object 6", true},
        {"t\n-1\n", "a miss is written as infinity", true},
        {"t\n1\n1\n", "2 hits for 1 ray", true},
        {"t,object,t\n1,0,1\n", "the first line names 't' twice", true}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtRaySet set;
        RtHit *hits;
        Path path = write_text(place, cases[i].text);
        if (cases[i].hits)
            assert_bad_input(rt_hits_load(path.text, 1, 6, &hits, error), cases[i].says);
        else
            assert_bad_input(rt_rays_load(path.text, RT_RAY_RANDOM, &set, error), cases[i].says);
    }
}

RT_TESTS(ray_file, NULL, NULL)
