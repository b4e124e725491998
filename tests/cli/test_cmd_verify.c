/* SPDX-License-Identifier: Apache-2.0 */
/* raytally verify, as a user runs it: the document it prints, the exit codes, what it refuses. */
#include "command_testing.h"

#include "core/base/file.h"

#include <jansson.h>
#include <signal.h>

#define OUT RT_BINARY_DIR "/test_cmd_verify"

/* Runs `raytally verify ARGUMENTS`, output to OUT.out and messages to OUT.err; gives the exit code. */
static int verify(const char *arguments) {
    return raytally_to("> '" OUT ".out' 2> '" OUT ".err'", "verify %s", arguments);
}

static json_t *document(const char *arguments) {
    assert_int_equal(verify(arguments), 0);
    assert_string_equal(text_of(OUT ".err"), "");
    json_t *json = json_load_file(OUT ".out", 0, NULL);
    assert_non_null(json);
    return json;
}

static json_int_t number(const json_t *row, const char *key) {
    const json_t *value = json_object_get(row, key);
    assert_true(json_is_integer(value));
    return json_integer_value(value);
}

RT_TEST(a_row_says_how_each_ray_was_answered) {
    json_auto_t *json =
        document("balls:size=1 tetra:size=2 --accel bvh --accel grid:density=1 --rays 1001 --seed 9 --json");
    assert_int_equal(number(json, "seed"), 9);
    const json_t *rows = json_object_get(json, "rows");
    assert_int_equal(json_array_size(rows), 4);
    const char *const accels[2] = {"bvh", "grid:density=1"};
    for (size_t i = 0; i < 4; i++) {
        const json_t *row = json_array_get(rows, i);
        assert_string_equal(json_string_value(json_object_get(row, "scene")),
                            i < 2 ? "balls:size=1" : "tetra:size=2");
        assert_string_equal(json_string_value(json_object_get(row, "accel")), accels[i % 2]);
        assert_string_equal(json_string_value(json_object_get(row, "against")), "brute");
        assert_int_equal(number(row, "rays"), 1001);
        assert_int_equal(number(row, "equal"), 1001);
        assert_int_equal(number(row, "tie") + number(row, "marginal") + number(row, "wrong"), 0);
        assert_int_equal(number(row, "occluded_wrong"), 0);
        assert_true(json_is_null(json_object_get(row, "first_wrong")));
    }
}

RT_TEST(the_spread_tries_each_value_of_each_parameter) {
    json_auto_t *json = document("balls:size=1 --accel bvh --spread --rays 10 --json");
    const json_t *rows = json_object_get(json, "rows");
    bool leaf = false;
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const char *accel = json_string_value(json_object_get(json_array_get(rows, i), "accel"));
        assert_true(strncmp(accel, "bvh", 3) == 0);
        leaf |= strcmp(accel, "bvh:max_leaf_size=1") == 0;
    }
    assert_true(leaf && json_array_size(rows) > 5);
}

RT_TEST(all_is_the_default_and_threads_change_nothing) {
    static char one[65536];
    assert_int_equal(verify("random:n=30,shape=mixed --rays 5000 --threads 1"), 0);
    strcpy(one, text_of(OUT ".out"));
    assert_non_null(strstr(one, " brute "));
    assert_non_null(strstr(one, " grid "));
    assert_non_null(strstr(one, " comparisons: nothing wrong\n"));
    assert_int_equal(verify("random:n=30,shape=mixed --rays 5000 --threads 3 --accel all"), 0);
    assert_string_equal(text_of(OUT ".out"), one);
}

/* Coincident objects tie, which is held against nobody. */
RT_TEST(embree_is_judged_if_it_is_named_and_says_how_much_could_be_seen) {
    assert_int_equal(verify("random:n=40,distribution=coincident --rays 3001"), 0);
    const char *said = text_of(OUT ".err");
    if (!*said) { /* built without Embree */
        assert_null(strstr(text_of(OUT ".out"), "embree"));
        return;
    }
    assert_non_null(strstr(said, "embree has its own arithmetic, so it is not among `all`"));
    json_auto_t *json =
        document("random:n=40,distribution=coincident random:n=0 --rays 3001 --accel embree --json");
    const json_t *rows = json_object_get(json, "rows");
    assert_true(json_array_size(rows) >= 2);
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        assert_int_equal(number(row, "rays"), 3001);
        if (json_is_true(json_object_get(row, "exact"))) continue;
        assert_int_equal(number(row, "certain_of"), 3001);
        assert_true(number(row, "certain") > 1000);
    }
    assert_said(verify("random:n=40 --rays 300 --accel embree"), 1, OUT ".err", "undecided: of 300 rays");
    assert_non_null(strstr(text_of(OUT ".out"), "1 row undecided; rows that fail: 1 of embree"));
}

static const char *accel_of(const json_t *rows, size_t i) {
    return json_string_value(json_object_get(json_array_get(rows, i), "accel"));
}

/* Left to itself light hands all on to what lies below it here. */
RT_TEST(what_would_be_left_unused_is_tried_beside_the_default) {
    json_auto_t *json =
        document("balls:size=1 --accel light+wide --accel bvh --accel wide:max_leaf_size=2 --rays 10 --json");
    const json_t *rows = json_object_get(json, "rows");
    assert_int_equal(json_array_size(rows), 4);
    assert_string_equal(accel_of(rows, 0), "light+wide");
    assert_string_equal(accel_of(rows, 1), "light:cells=100+wide:sharing=0");
    assert_string_equal(accel_of(rows, 2), "bvh");
}

/* Those of the fewest objects first. */
RT_TEST(hard_scenes_are_verified_unasked_and_the_small_ones_with_quick) {
    json_auto_t *json = document("--accel bvh --rays 20 --json"),
                *quick = document("--accel bvh --quick --json");
    const json_t *rows = json_object_get(json, "rows"), *few = json_object_get(quick, "rows");
    assert_true(json_array_size(few) > 20 && json_array_size(few) < json_array_size(rows));
    for (size_t i = 0; i < json_array_size(few); i++) {
        assert_string_equal(json_string_value(json_object_get(json_array_get(few, i), "scene")),
                            json_string_value(json_object_get(json_array_get(rows, i), "scene")));
        assert_int_equal(number(json_array_get(few, i), "rays"), 2000);
    }
    assert_int_equal(verify("--accel bvh --quick"), 0);
    const char *last = strstr(text_of(OUT ".out"), "--quick used 2000 rays");
    assert_non_null(last);
    assert_non_null(strstr(last, "larger scenes. Omit it for the full check."));
    assert_said(verify("balls:size=1 --accel bvh"), 0, OUT ".out",
                "\n1 scene, 1 accelerator, 20000 rays, 20000 comparisons");
    assert_null(strstr(text_of(OUT ".out"), "--quick used"));
}

RT_TEST(what_cannot_be_verified_is_refused_before_anything_is_printed) {
    const struct {
        const char *arguments, *says;
    } cases[] = {
        {"nothing.yaml", "nothing.yaml"},
        {"balls:size=99999", "size=99999"},
        {"ball", "balls"},
        {"tetra:size=1 nothing.yaml", "nothing.yaml"},
        {"balls --accel gird", "did you mean 'grid'"},
        {"balls --accel bvh:max_leaf_size=0", "1..1024"},
        {"--rays 0", "whole number 1.."},
        {"--rays 1e6", "whole number"},
        {"--threads -1", "whole number"},
        {"--memory 0", "as in 512M or 4G"},
        {"--memory 4Gi", "as in 512M or 4G"},
        {"--invalid", "unrecognized option"},
        {"--families", "unrecognized option"},
        {"--resume", "--out DIR"},
        {"--force", "--out DIR"},
        {"family:kind=silvers", "did you mean 'slivers'"},
        {"family:kind=", "empty|one-sphere|"},
        {"family:kind=slivers,sed=1", "did you mean 'seed'?"},
        {"family:kind=slivers,seed=", "seed"},
        {"balls:size=1 --hits-from x.npy", "of the rays of --rays-from"},
        {"balls:size=1 tetra:size=1 --rays-from r.npy --hits-from x.npy", "on one SCENE"},
        {"balls:size=1 tetra:size=1 --differing-rays x.npy", "of one SCENE"},
        {"balls:size=1 --differing-rays x.txt", "ends in .npy"},
        {"balls:size=1 --differing-rays x.npy --out d --resume", "no --resume"},
        {"balls:size=1 --rays-from x.npy --differing-rays x.npy", "'x.npy' is named twice"},
        {"--replay nothing.json", "nothing.json"},
        {"--replay nothing.json balls", "takes no SCENE"},
        {"--replay nothing.json --json", "prints text"},
        {"--replay " RT_SOURCE_DIR "/README.md", "not JSON"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_said(verify(cases[i].arguments), 2, OUT ".err", cases[i].says);
        assert_string_equal(text_of(OUT ".out"), "");
    }
}

RT_TEST(scenes_of_families_have_the_seed_of_the_rays) {
    json_auto_t *json = document("families family:kind=soup,seed=9 --accel grid --rays 40 --seed 3 --json");
    const json_t *rows = json_object_get(json, "rows");
    size_t count = json_array_size(rows);
    assert_true(count > 20);
    const char *first = json_string_value(json_object_get(json_array_get(rows, 0), "scene"));
    const char *last = json_string_value(json_object_get(json_array_get(rows, count - 1), "scene"));
    assert_string_equal(first, "family:kind=empty,seed=3");
    assert_string_equal(last, "family:kind=soup,seed=9");
}

RT_TEST(triangles_are_the_default_scenes_without_other_shapes) {
    json_auto_t *json = document("triangles --accel bvh --rays 40 --json");
    const json_t *rows = json_object_get(json, "rows");
    static const char *const others[] = {"balls", "shape=mixed", "=two", "csg", "spheres"};
    bool tetra = false, slivers = false;
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const char *scene = json_string_value(json_object_get(json_array_get(rows, i), "scene"));
        for (size_t k = 0; k < sizeof others / sizeof others[0]; k++) assert_null(strstr(scene, others[k]));
        tetra |= strcmp(scene, "tetra:size=3") == 0;
        slivers |= strcmp(scene, "family:kind=slivers,seed=1") == 0;
    }
    assert_true(tetra && slivers && json_array_size(rows) > 8);
}

RT_TEST(what_needs_more_memory_than_is_allowed_is_refused_and_the_others_are_verified) {
    assert_said(verify("random:n=20000 --accel kd --accel brute --rays 40 --memory 1M --json"), 0, OUT ".err",
                "refused: it needs more than 1 MB of memory (--memory)");
    json_auto_t *json = json_load_file(OUT ".out", 0, NULL);
    const json_t *rows = json_object_get(json, "rows");
    assert_int_equal(json_array_size(rows), 2);
    assert_int_equal(number(json_array_get(rows, 0), "rays"), 0);
    assert_int_equal(number(json_array_get(rows, 1), "equal"), 40);
}

RT_TEST(a_verification_stops_when_its_time_is_over) {
    assert_int_equal(verify("random:n=2000 --accel brute --rays 20000000 --time 1"), 2);
    assert_string_equal(text_of(OUT ".err"), "raytally: stopped after 1 s (--time)\n");
}

/* Interrupted once it has finished the first row. */
RT_TEST(an_interruption_says_what_is_kept_and_how_to_go_on) {
    static const char arguments[] = "-a bvh --rays 200000 --out " OUT ".part tetra:size=1 random:n=20000";
    remove(OUT ".part/rows.jsonl");
    assert_int_equal(raytally_to("> '" OUT ".out' 2> '" OUT ".err' & "
                                 "until [ $(cat " OUT ".part/rows.jsonl 2> /dev/null | wc -l) -ge 2 ] || "
                                 "! kill -0 $!; do sleep 0.01; done; kill $! && wait $!",
                                 "verify --force %s", arguments),
                     128 + SIGTERM);
    char expected[1024];
    snprintf(expected, sizeof expected,
             "raytally: interrupted; what is finished is kept in " OUT ".part. To continue:\n"
             "  raytally verify --resume %s\n",
             arguments);
    assert_string_equal(text_of(OUT ".err"), expected);
}

/* Verifies whatever an earlier round of this test has left in --out. */
static void begin_anew(const char *arguments) {
    char anew[1024];
    snprintf(anew, sizeof anew, "%s --force", arguments);
    assert_int_equal(verify(anew), 0);
}

/* Prints what a run that was not interrupted prints. */
RT_TEST(a_run_is_gone_on_with) {
    static char whole[65536], table[65536];
    const char *arguments =
        "random:n=20,shape=mixed tetra:size=1 --accel bvh --accel grid --rays 500 --out '" OUT ".rows'";
    char again[1024];
    begin_anew(arguments);
    snprintf(again, sizeof again, "%s --resume", arguments);
    strcpy(whole, text_of(OUT ".out"));
    strcpy(table, text_of(OUT ".rows/verify.csv"));
    assert_non_null(
        strstr(table, "scene,accel,against,rays,equal,tie,marginal,wrong,occluded_wrong,problem"));
    assert_non_null(strstr(table, "tetra:size=1,grid,brute,500,500,0,0,0,0,,0,0,0,0,0,,,,,0,0,0,0,0\n"));
    assert_int_equal(verify(again), 0);
    assert_string_equal(text_of(OUT ".out"), whole);
    assert_string_equal(text_of(OUT ".rows/verify.csv"), table);
    snprintf(again, sizeof again, "%s --resume --seed 2", arguments);
    assert_said(verify(again), 2, OUT ".err", "another verification, with different seed");
}

RT_TEST(rows_that_are_there_are_not_begun_anew_unasked) {
    static char rows[65536];
    const char *arguments = "tetra:size=1 --accel bvh --rays 50 --out '" OUT ".kept'";
    char other[1024];
    begin_anew(arguments);
    strcpy(rows, text_of(OUT ".kept/rows.jsonl"));
    assert_said(verify(arguments), 2, OUT ".err", OUT ".kept holds a finished run");
    assert_string_equal(text_of(OUT ".out"), "");
    assert_int_equal(remove(OUT ".kept/manifest.json"), 0);
    assert_said(verify(arguments), 2, OUT ".err", "holds an unfinished run: use --resume to continue it");
    /* A scene that cannot be opened is found before anything is lost. */
    snprintf(other, sizeof other, "nothing.nff %s --force", arguments);
    assert_int_equal(verify(other), 2);
    assert_string_equal(text_of(OUT ".kept/rows.jsonl"), rows);
    assert_int_equal(remove(OUT ".kept/rows.jsonl"), 0);
    snprintf(other, sizeof other, "%s --resume", arguments);
    assert_said(verify(other), 2, OUT ".err", "verify.csv, but no rows.jsonl");
}

static void write_sphere(const char *path, int radius) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "objects: [{sphere: {center: [0, 0, 0], radius: %d}}]\n", radius);
    fclose(file);
}

RT_TEST(a_run_is_not_gone_on_with_where_a_scene_file_was_edited) {
    const char *arguments = "'" OUT ".yaml' --accel bvh --rays 50 --out '" OUT ".edited'";
    char again[1024];
    write_sphere(OUT ".yaml", 1);
    begin_anew(arguments);
    snprintf(again, sizeof again, "%s --resume", arguments);
    write_sphere(OUT ".yaml", 2);
    assert_said(verify(again), 2, OUT ".err", "with different fingerprints");
}

/* No accelerator lies, so the journal is made to say so of one, and gone on with. */
RT_TEST(the_last_line_tells_of_wrong_answers_to_occluded_too) {
    const char *arguments = "random:n=20 --accel bvh --accel grid --rays 50 --out '" OUT ".lies'";
    char again[1024];
    begin_anew(arguments);
    snprintf(again, sizeof again, "%s --resume", arguments);
    assert_int_equal(system("sed -i -e '2s/\"occluded_wrong\": *0/\"occluded_wrong\": 3/' "
                            "-e '2s/\"problem\": *null/\"problem\": \"a lie\"/' '" OUT ".lies/rows.jsonl'"),
                     0);
    assert_int_equal(verify(again), 1);
    assert_non_null(strstr(text_of(OUT ".out"), "1 scene, 2 accelerators, 50 rays, 100 comparisons: 0 wrong, "
                                                "3 occluded wrong; rows that fail: 1 of bvh\n"));
    assert_non_null(strstr(text_of(OUT ".err"), "a lie"));
}

/* A replay file of a scene that is not what it was, with what it was shrunk to or "null". */
static void write_replay(const char *path, const char *shrunk) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(
        file,
        "{\"scene\": \"random:n=1\", \"fingerprint\": \"0000000000000000\", \"accel\": \"bvh\",\n"
        " \"sampling\": [4, 4], \"query\": \"nearest\", \"kernel\": \"timed\", \"stream\": 1, \"asked\": 0,\n"
        " \"rays\": [{\"kind\": \"random\", \"source\": 0, \"org_dir_tmin_tmax\":\n"
        "  [\"0x0p+0\", \"0x0p+0\", \"0x1p+3\", \"-0x0p+0\", \"0x0p+0\", \"-0x1p+0\", \"0x0p+0\", "
        "\"inf\"]}],\n"
        " \"shrunk\": %s}\n",
        shrunk);
    fclose(file);
}

/* What was wrong once and is not any more: the answer that the file tells of does not count, the one now
 * does. */
RT_TEST(a_replay_says_whether_the_answer_is_still_wrong) {
    write_replay(OUT ".json", "{\"yaml\": \"objects: [{sphere: {center: [0, 0, 0], radius: 1}}]\"}");
    assert_said(verify("--replay '" OUT ".json'"), 0, OUT ".err", "has changed since");
    assert_non_null(strstr(text_of(OUT ".out"), "reduced: right: ray 0, nearest, timed kernel"));
    assert_non_null(strstr(text_of(OUT ".out"), "expected object 0 at t = 7, got object 0 at t = 7"));
}

/* By exit code 1 a bisection would take it for the fault that it looks for. */
RT_TEST(a_replay_that_cannot_be_asked_is_not_called_wrong) {
    write_replay(OUT ".json", "null");
    assert_said(verify("--replay '" OUT ".json'"), 2, OUT ".err", "has changed since");
}

/* ---- hits from files ---- */

#define GIVEN "balls:size=1 --rays-from '" OUT ".rays.npy' --hits-from '" OUT ".hits.npy'"

/* Writes the rays, and our own hits; in `wrong` rays from the first that hits on another t, by this factor.
 */
static void write_hits(int wrong, float factor) {
    assert_int_equal(raytally_to("> /dev/null", "rays balls:size=1 --size 40x40 -o '" OUT ".rays.npy'"), 0);
    assert_int_equal(
        raytally_to("> /dev/null",
                    "bench balls:size=1 --accel bvh --count-only --rays nearest --rays-from '" OUT
                    ".rays.npy' --hits '" OUT ".hits.npy'"),
        0);
    struct __attribute__((packed)) {
        float t;
        int64_t object;
    } hit;
    FILE *file = fopen(OUT ".hits.npy", "r+b");
    assert_non_null(file);
    fseek(file, 128, SEEK_SET); /* behind the header */
    while (wrong > 0 && fread(&hit, sizeof hit, 1, file) == 1) {
        if (hit.object < 0) continue;
        hit.t *= factor;
        fseek(file, -(long)sizeof hit, SEEK_CUR);
        assert_int_equal(fwrite(&hit, sizeof hit, 1, file), 1);
        fseek(file, 0, SEEK_CUR);
        wrong--;
    }
    fclose(file);
}

RT_TEST(hits_of_another_program_are_judged_without_an_accelerator) {
    write_hits(3, 1.0000001f);
    json_auto_t *json = document(GIVEN " --json");
    const json_t *rows = json_object_get(json, "rows"), *row = json_array_get(rows, 0);
    assert_int_equal(json_array_size(rows), 1);
    assert_string_equal(accel_of(rows, 0), OUT ".hits.npy");
    assert_int_equal(number(row, "rays"), 1600);
    assert_int_equal(number(row, "equal"), 1600);
    assert_int_equal(number(row, "certain_of"), 1600);
    assert_true(json_is_false(json_object_get(row, "exact")));
    assert_true(json_is_null(json_object_get(row, "occluded_wrong")));
    assert_int_equal(verify(GIVEN " --accel grid"), 0);
    assert_non_null(
        strstr(text_of(OUT ".out"), "2 accelerators, 1600 rays, 3200 comparisons: 1600 bit for bit"));
}

RT_TEST(the_first_wrong_hit_of_another_program_is_kept_as_a_scene_and_all_their_rays_as_a_file) {
    write_hits(5, 1.5f);
    assert_int_equal(verify(GIVEN " --differing-rays '" OUT ".wrong.npy' --out '" OUT ".near' --force"), 1);
    assert_non_null(strstr(text_of(OUT ".err"), "wrong.npy: 5 rays that differ by more than a tie"));
    assert_non_null(strstr(text_of(OUT ".out"), "displaced 5\n"));
    const char *scene = strstr(text_of(OUT ".out"), "raytally trace '" OUT ".near/0001-");
    assert_non_null(scene);
    char again[1024], expected[64];
    snprintf(again, sizeof again, "%.*s", (int)(strstr(scene, " --svg") - scene - 9), scene + 9);
    const char *says = strstr(text_of(OUT ".out"), "at t = ");
    snprintf(expected, sizeof expected, "%.*s", (int)strcspn(says, ","), says);
    assert_int_equal(raytally_to("> '" OUT ".out'", "%s", again), 0);
    assert_non_null(strstr(text_of(OUT ".out"), expected));
    /* The same file of rays, and no wrong answer. */
    assert_int_equal(verify("balls:size=1 --accel bvh --rays-from '" OUT ".wrong.npy' --differing-rays '" OUT
                            ".none.npy'"),
                     0);
    assert_non_null(strstr(text_of(OUT ".out"), "5 comparisons: nothing wrong"));
    assert_non_null(strstr(text_of(OUT ".err"), "none.npy: 0 rays that differ by more than a tie"));
}

RT_TEST(hits_are_judged_again_only_if_they_are_the_same) {
    write_hits(0, 1);
    begin_anew(GIVEN " --out '" OUT ".judged'");
    assert_int_equal(verify(GIVEN " --out '" OUT ".judged' --resume"), 0);
    assert_non_null(strstr(text_of(OUT ".judged/verify.md"), "1600 comparisons are with hits of a file"));
    write_hits(1, 1.5f);
    assert_said(verify(GIVEN " --out '" OUT ".judged' --resume"), 2, OUT ".err", "with different hits_hash");
}

/* Judges these hits of rays on a scene, all written first. */
static int judge_texts(const char *scene, const char *rays, const char *hits) {
    const char *const texts[] = {scene, rays, hits}, *const names[] = {"scene.yaml", "rays.csv", "hits.csv"};
    for (int i = 0; i < 3; i++) {
        char path[512];
        snprintf(path, sizeof path, OUT ".%s", names[i]);
        assert_ok(rt_file_write(path, texts[i], strlen(texts[i]), error));
    }
    return verify("'" OUT ".scene.yaml' --rays-from '" OUT ".rays.csv' --hits-from '" OUT
                  ".hits.csv' --differing-rays '" OUT ".differing.csv'");
}

RT_TEST(a_miss_between_two_triangles_is_no_fault_but_is_told_and_kept) {
    const char *quad = "objects:\n"
                       "  - triangle: {vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0]]}\n"
                       "  - triangle: {vertices: [[0, 0, 0], [1, 1, 0], [0, 1, 0]]}\n";
    assert_said(judge_texts(quad, "ox,oy,oz,dx,dy,dz\n.5,.5,1,0,0,-1\n.5,.25,1,0,0,-1\n", "t\ninf\n1\n"), 0,
                OUT ".out", "by verdicts, nothing wrong but 1 exact hit missed\n");
    assert_non_null(strstr(text_of(OUT ".err"), "the hits name no objects: they are judged by t alone"));
    assert_non_null(strstr(text_of(OUT ".err"), "differing.csv: 1 ray that differs by more than a tie"));
    assert_string_equal(text_of(OUT ".differing.csv"),
                        "ox,oy,oz,tmin,dx,dy,dz,tmax\n0.5,0.5,1,0,0,0,-1,inf\n");
}

RT_TEST(rays_that_hit_nothing_decide_nothing) {
    const char *sphere = "objects:\n  - sphere: {center: [0, 0, 0], radius: 1}\n";
    assert_said(judge_texts(sphere, "ox,oy,oz,dx,dy,dz\n5,5,5,0,0,1\n", "t\ninf\n"), 1, OUT ".err",
                "undecided: of 1 rays, 0 of which hit");
}

RT_TEST(how_far_rounding_lets_t_be_off_is_told) {
    const char *floor =
        "objects:\n  - triangle: {vertices: [[-1e5, -1e5, 0], [1e5, -1e5, 0], [0, 1e5, 0]]}\n";
    assert_said(judge_texts(floor, "ox,oy,oz,dx,dy,dz\n1,1,1,0,0,-1\n", "t,object\n1.1,0\n"), 0, OUT ".out",
                "; t is off by up to 10 %, which rounding explains here\n");
}

RT_TESTS(cmd_verify, NULL, NULL)
