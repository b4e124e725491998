/* SPDX-License-Identifier: Apache-2.0 */
/* Shards of one experiment, joined. */
#include "csv_testing.h"
#include "experiment_testing.h"

#include "core/base/file.h"

#include <sys/stat.h>

static const char sharded[] =
    "name: small\nquestion: On how many machines?\nprediction: It does not matter.\n"
    "scenes:\n"
    "  - {scene: \"balls:size=1|2\", size: 12x12}\n"
    "  - {scene: \"random:n=50..200*2\", label: cloud, size: 12x12}\n"
    "accelerators:\n"
    "  - {accel: bvh}\n"
    "  - {accel: \"grid:density=1|4\"}\n"
    "rays: [primary, shadow]\nlimit: 100\nrounds: 2\nmilliseconds: 0\n"
    "expect: [object_tests of grid falls with density on cloud]\n";

static int make_places(void **state) {
    if (make_place_with(state, sharded) != 0) return -1;
    for (int i = 1; i <= 4; i++) {
        char command[128];
        snprintf(command, sizeof command, "run small.yaml --threads 1 --shard %d/4 --out s%d", i, i);
        if (raytally(*state, command) != 0) return -1;
    }
    return 0;
}

static void refused(const Place *place, const char *arguments, const char *says) {
    assert_ends(place, arguments, 2, says);
    assert_false(rt_file_exists(path_in(place, "all").text));
}

PLACE_TEST(four_shards_make_the_counts_of_one_run) {
    Csv csv;
    assert_runs(place, "run small.yaml --threads 1 --out one");
    assert_runs(place, "merge s3 s1 s4 s2 -o all");
    assert_in_file(place, "output", "undecided        object_tests of grid falls with density on cloud");
    assert_in_file(place, "message", "joined 4 shards: 30 cells of 5 scenes");
    assert_not_in_file(place, "message", "nothing was left to measure");
    assert_equal_files(place, "one/counts.csv", "all/counts.csv");
    assert_true(rt_file_exists(path_in(place, "all/manifest.json").text));
    assert_true(rt_file_exists(path_in(place, "all/images/cloud-n-200.png").text));
    assert_in_file(place, "all/report.html", "cloud:n=200");
    assert_runs(place, "reproduce all");
    Path times = path_in(place, "all/times.csv");
    read_csv(&csv, times.text);
    assert_int_equal(csv.rows, 5 * 2 * 4);
    assert_true(*csv_field(&csv, 0, csv_find(&csv, "host")));
    assert_true(csv_find(&csv, "cpu") < csv.columns);
    clear_csv(&csv);
    assert_int_equal(raytally(place, "merge s1 s2 s3 s4 -o all"), 2);
    assert_runs(place, "merge s1 s2 s3 s4 -o all --force");
}

PLACE_TEST(what_does_not_make_a_whole_is_refused_and_nothing_is_written) {
    refused(place, "merge s1 s2 s4 -o all", "shard 3 of 4 is missing");
    refused(place, "merge s1 s2 s3 s4 s2 -o all", "shard 2 of 4 is given twice: s2 and s2");
    refused(place, "merge s1 s2 nowhere -o all", "nowhere is not the directory of a run");
    refused(place, "merge s1 s2", "the result directory is missing: -o DIR");
    assert_runs(place, "run small.yaml --threads 1 --out whole");
    refused(place, "merge s1 whole -o all", "whole is not a shard");
    assert_runs(place, "run small.yaml --threads 1 --shard 2/3 --out third");
    refused(place, "merge s1 third -o all", "s1 and third have different numbers of shards");
    write_changed(place, "small.yaml", sharded, "limit: 100", "limit: 99");
    assert_runs(place, "run small.yaml --threads 1 --shard 2/4 --out other");
    refused(place, "merge s1 other s3 s4 -o all", "s1 and other have different experiments");
    refused(place, "merge s1 s2 s3 s4 -o all", "small.yaml has changed since the shards were made");
    assert_int_equal(remove(path_in(place, "s3/manifest.json").text), 0);
    refused(place, "merge s1 s2 s3 s4 -o all", "s3 is not finished: finish it");
}

/* A disk that is full fails alike: at a file that is to be written. */
PLACE_TEST(a_merge_that_fails_loses_nothing_of_earlier_results) {
    const char *const kept[] = {"all/cells.jsonl", "all/counts.csv", "all/report.html", "all/manifest.json"};
    char *before[4];
    assert_runs(place, "merge s1 s2 s3 s4 -o all");
    for (int i = 0; i < 4; i++) before[i] = read_in(place, kept[i]);
    Path picture = path_in(place, "s4/images/cloud-n-100.png");
    assert_int_equal(remove(picture.text), 0);
    assert_int_equal(mkdir(picture.text, 0777), 0);
    assert_ends(place, "merge s1 s2 s3 s4 -o all --force", 2,
                "s4/images/cloud-n-100.png: this is not a file");
    for (int i = 0; i < 4; i++) {
        assert_same_file(place, kept[i], before[i]);
        rt_free(before[i]);
    }
    assert_true(rt_file_exists(path_in(place, "all/images/cloud-n-200.png").text));
}

PLACE_TEST(a_merge_into_the_directory_of_another_run_is_refused_and_removes_nothing) {
    RtLock lock = RT_NO_LOCK;
    assert_runs(place, "merge s1 s2 s3 s4 -o all");
    OWNED_MEMORY char *before = read_in(place, "all/counts.csv");
    assert_ok(rt_lock_take(&lock, path_in(place, "all").text, error));
    assert_ends(place, "merge s1 s2 s3 s4 -o all --force", 2, "is writing");
    assert_same_file(place, "all/counts.csv", before);
    rt_lock_release(&lock);
}

PLACE_TEST(a_shard_is_gone_on_with_as_the_shard_that_it_is) {
    assert_ends(place, "run small.yaml --threads 1 --shard 3/4 --out s2 --resume", 2,
                "this is a run with another --shard (2/4)");
    assert_ends(place, "run small.yaml --threads 1 --shard 2/4 --out s2 --resume", 0,
                "nothing was left to measure");
}

/* Times on one thread are processor time, those on two are wall time. */
PLACE_TEST(cells_timed_on_other_numbers_of_threads_are_not_mixed) {
    assert_runs(place, "run small.yaml --threads 2 --shard 3/4 --out two");
    refused(place, "merge s1 s2 two s4 -o all",
            "s1 was timed on 1 thread, and two on 2: their times are not comparable. Run one of them again");
    assert_runs(place, "run small.yaml --threads 2 --out part --only cloud:n=50");
    assert_ends(place, "run small.yaml --out part --resume", 2,
                "part was timed on 2 threads so far, and this command would use 1");
    assert_runs(place, "run small.yaml --threads 2 --out part --resume");
    assert_runs(place, "run small.yaml --out part --resume"); /* nothing is left to time */
}

/* A program with a byte more at its end does the same, but is another one. What a clean commit makes may
 * differ by paths. */
PLACE_TEST(another_program_of_uncommitted_sources_is_another_build) {
    char command[512], program[512];
    snprintf(command, sizeof command, "cd '%s' && cp '%s' other && printf x >>other && mv s2 mine",
             place->folder, RT_PROGRAM);
    assert_int_equal(system(command), 0);
    snprintf(command, sizeof command,
             "cd '%s' && ./other run small.yaml --threads 1 --shard 2/4 --out s2 2>message", place->folder);
    assert_int_equal(system(command), 0);
    snprintf(program, sizeof program,
             "cd '%s' && grep -h '\"program\"' s2/manifest.json mine/manifest.json "
             "| sort -u | wc -l | grep -qx 2",
             place->folder);
    assert_int_equal(system(program), 0);
    OWNED_MEMORY char *journal = read_in(place, "s2/cells.jsonl");
    const bool uncommitted = strstr(journal, "(program "); /* or of a source archive, which may be changed */
    int code = raytally(place, "merge s1 s2 s3 s4 -o all");
    assert_int_equal(code, uncommitted ? 2 : 0);
    if (!uncommitted) return;
    assert_in_file(place, "message", "s1 and s2 have different builds of raytally");
    assert_ends(place, "run small.yaml --threads 1 --shard 2/4 --out s2 --resume", 2,
                "another build began this run");
    refused(place, "merge s2 s2 -o all", "s2 was measured by another build of raytally");
}

RT_TESTS(merge, NULL, NULL)
