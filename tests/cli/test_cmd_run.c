/* SPDX-License-Identifier: Apache-2.0 */
/* raytally run and reproduce with several experiments. With one: tests/experiment. */
#include "experiment_testing.h"

#include "cli/jobs.h"

#include <fcntl.h>
#include <signal.h>
#include <time.h>

static const char pattern[] =
    "name: small\nquestion: Which is cheaper?\nprediction: The hierarchy.\n"
    "scenes: [{scene: \"random:n=60\", label: cloud, size: 12x12}]\n"
    "accelerators: [{accel: bvh}, {accel: grid}]\nrays: [primary, random]\nlimit: 50\nrounds: 2\n"
    "milliseconds: 0\nexpect: [bytes of bvh < 1000000]\n";

/* The pattern in a.yaml, b.yaml and c.yaml, each under its own name. */
static int make_places(void **state) {
    if (make_place(state) != 0) return -1;
    write_changed(*state, "a.yaml", pattern, "name: small", "name: a");
    write_changed(*state, "b.yaml", pattern, "name: small", "name: b");
    write_changed(*state, "c.yaml", pattern, "name: small", "name: c");
    return 0;
}

static void change(const Place *place, const char *name, const char *from, const char *to) {
    OWNED_MEMORY char *text = read_in(place, name);
    write_changed(place, name, text, from, to);
}

static bool exists(const Place *place, const char *name) {
    return rt_file_exists(path_in(place, name).text);
}

PLACE_TEST(each_of_several_experiments_gets_its_directory_and_all_a_summary_and_an_index) {
    assert_runs(place, "run a.yaml b.yaml --threads 1");
    assert_true(exists(place, "results/a/report.html") && exists(place, "results/b/report.html"));
    assert_true(exists(place, "results/index.html") && exists(place, "results/index.md"));
    assert_in_file(place, "output", "== b, 2 of 2\n", "\na                                finished ",
                   "\nb                                finished ");
    assert_runs(place, "run a.yaml c.yaml --threads 1 --out other");
    assert_true(exists(place, "other/a/report.html") && exists(place, "other/c/report.html"));
    assert_equal_files(place, "results/a/counts.csv", "other/a/counts.csv");
}

/* Skipped without Embree. */
PLACE_TEST(answers_by_another_arithmetic_are_said_to_differ) {
    change(place, "a.yaml", "{accel: grid}", "{accel: \"embree:mode=native\"}");
    const int code = raytally(place, "run a.yaml --threads 1");
    if (code == 2) {
        assert_in_file(place, "output", "without Embree");
        RT_SKIP("Embree");
    }
    assert_int_equal(code, 0);
    assert_in_file(place, "output", "embree uses its own arithmetic. Answers that differ from");
}

PLACE_TEST(an_index_that_cannot_be_written_is_an_error) {
    assert_runs(place, "run a.yaml b.yaml --threads 1");
    remove(path_in(place, "results/index.md").text);
    assert_ok(rt_directory_create(path_in(place, "results/index.md").text, error));
    assert_ends(place, "run a.yaml b.yaml --threads 1 --resume", 2,
                "there is no index: results/index.md is a folder");
}

PLACE_TEST(one_that_fails_does_not_stop_the_others_and_the_worst_exit_code_counts) {
    change(place, "a.yaml", "random:n=60", "nowhere.yaml");
    change(place, "b.yaml", "bvh < 1000000", "bvh < 1");
    assert_ends(place, "run a.yaml b.yaml c.yaml --threads 1 --strict", 2,
                "2 of 3 experiments failed, the first: a");
    assert_in_file(place, "output", "a                                failed, exit code 2",
                   "b                                failed, exit code 1",
                   "c                                finished");
    assert_true(exists(place, "results/c/report.html"));
    assert_ends(place, "run b.yaml c.yaml --threads 1 --strict --resume", 1,
                "1 of 2 experiments failed, the first: b");
}

PLACE_TEST(what_is_odd_in_a_mesh_is_said_and_kept_by_every_command_and_an_error_if_strict) {
    static const char *const commands[] = {
        "info odd.obj",
        "convert odd.obj odd.ply -f",
        "render odd.obj --size 8x8 -o odd.png",
        "rays odd.obj --rays random -o odd.npy",
        "verify odd.obj --accel bvh --rays 9",
        "trace odd.obj --pixel 1,1",
        "bench odd.obj --accel bvh --rays random --rounds 2 --milliseconds 0"};
    char strict[200];
    write_in(place, "odd.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n");
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        snprintf(strict, sizeof strict, "%s --strict", commands[i]);
        assert_ends(place, commands[i], 0, "warning: odd.obj:5: face 1 (counted from 0) has 2 corners");
        assert_ends(place, strict, 2, "odd.obj:5: face 1 (counted from 0) has 2 corners");
    }
    change(place, "a.yaml", "random:n=60", "odd.obj");
    assert_ends(place, "run a.yaml --threads 1", 0, "odd.obj:5: face 1 (counted from 0) has 2 corners");
    assert_in_file(place, "results/a/manifest.json", "odd.obj:5: face 1 (counted from 0) has 2 corners");
    assert_ends(place, "run a.yaml --threads 1 --strict --force", 2, "odd.obj:5: face 1");
}

PLACE_TEST(all_are_parsed_before_the_first_is_measured) {
    change(place, "c.yaml", "limit: 50", "limmit: 50");
    assert_ends(place, "run a.yaml b.yaml c.yaml", 2, "c.yaml:7:1: unknown key 'limmit'");
    change(place, "b.yaml", "name: b", "name: a");
    assert_ends(place, "run a.yaml b.yaml", 2,
                "a.yaml ('a') and b.yaml ('a') would share the directory results/a");
    change(place, "b.yaml", "name: a", "name: x:Y");
    change(place, "a.yaml", "name: a", "name: X-y");
    assert_ends(place, "run a.yaml b.yaml", 2, "would share the directory results/x-Y");
    assert_ends(place, "run a.yaml c.yaml --update", 2, "--update is no longer there: use --resume");
    assert_ends(place, "run a.yaml --renew", 2, "--renew is no longer there: --resume measures");
    assert_ends(place, "run a.yaml c.yaml --shard 1/2", 2, "--only and --shard take one experiment");
    assert_false(exists(place, "results"));
}

PLACE_TEST(resume_finishes_and_starts_and_measures_nothing_again) {
    assert_runs(place, "run a.yaml --threads 1 --out all/a");
    assert_runs(place, "run b.yaml --threads 1 --out all/b --only cloud/grid/random");
    OWNED_MEMORY char *finished = read_in(place, "all/a/cells.jsonl"),
                      *part = read_in(place, "all/b/cells.jsonl");
    assert_ends(place, "run a.yaml b.yaml c.yaml --threads 1 --out all", 2, "2 of 3 experiments failed");
    assert_in_file(place, "message", "all/a holds a finished run: use --resume to rewrite its tables");
    assert_runs(place, "run a.yaml b.yaml c.yaml --threads 1 --out all --resume");
    assert_same_file(place, "all/a/cells.jsonl", finished);
    OWNED_MEMORY char *whole = read_in(place, "all/b/cells.jsonl");
    assert_memory_equal(whole, part, strlen(part));
    assert_true(exists(place, "all/b/report.html") && exists(place, "all/c/report.html"));
}

PLACE_TEST(resume_with_force_starts_over_only_what_cannot_be_resumed) {
    assert_runs(place, "run a.yaml b.yaml --threads 1");
    OWNED_MEMORY char *a = read_in(place, "results/a/cells.jsonl");
    change(place, "b.yaml", "limit: 50", "limit: 40");
    assert_ends(place, "run a.yaml b.yaml --threads 1 --resume", 2, "another version of it ('b')");
    assert_ends(
        place, "run a.yaml b.yaml c.yaml --threads 1 --resume --force", 0,
        "another version of it ('b'): replace it with --force, or choose another --out; --force starts "
        "results/b over");
    assert_same_file(place, "results/a/cells.jsonl", a);
    assert_in_file(place, "results/b/experiment.yaml", "limit: 40");
    assert_runs(place, "reproduce results/b");
}

PLACE_TEST(resume_keeps_a_run_of_another_experiment_or_variant_and_what_it_cannot_read) {
    assert_runs(place, "run a.yaml --threads 1 --out kept");
    OWNED_MEMORY char *kept = read_in(place, "kept/cells.jsonl");
    assert_ends(place, "run b.yaml --out kept --resume", 2, "this is a run of another experiment");
    assert_ends(place, "run a.yaml --out kept --resume --quick", 2, "this is a run without --quick");
    assert_ends(place, "run a.yaml --out kept --resume --shard 1/1", 2, "another --shard");
    assert_same_file(place, "kept/cells.jsonl", kept);
    change(place, "kept/cells.jsonl", "\"interior\":", "\"exterior\":");
    assert_ends(place, "run a.yaml --out kept --resume", 2, "kept/cells.jsonl:");
    assert_true(exists(place, "kept/report.html"));
}

PLACE_TEST(a_dry_run_of_several_sums_up_each_and_touches_nothing) {
    assert_runs(place, "run a.yaml b.yaml --dry-run");
    assert_in_file(place, "output", "== a, 1 of 2\n4 cells, 0 of them finished\n");
    assert_false(exists(place, "results"));
}

PLACE_TEST(an_interruption_stops_all_and_says_the_one_command_that_continues) {
    change(place, "b.yaml", "rounds: 2\nmilliseconds: 0", "rounds: 50\nmilliseconds: 100");
    pid_t child = start_raytally(place, "run a.yaml b.yaml c.yaml --threads 1 --out all");
    while (!exists(place, "all/b/cells.jsonl")) nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    kill(child, SIGINT);
    assert_int_equal(end_of(child), 128 + SIGINT);
    OWNED_MEMORY char *message = read_in(place, "message");
    const char *command = strstr(message, "To continue:\n  ");
    assert_non_null(command);
    assert_string_equal(command,
                        "To continue:\n  raytally run a.yaml b.yaml c.yaml --out all --threads 1 --resume\n");
    assert_true(exists(place, "all/a/report.html") && !exists(place, "all/c"));
}

/* As by nohup, or behind a shell's `&`. */
PLACE_TEST(a_signal_that_was_ignored_from_the_start_stays_ignored) {
    static const char *const commands[] = {"run a.yaml --threads 1 --out one",
                                           "run a.yaml b.yaml --threads 1 --out all"};
    for (int i = 0; i < 2; i++) {
        int how;
        signal(SIGINT, SIG_IGN);
        const pid_t child = start_raytally(place, commands[i]);
        signal(SIGINT, SIG_DFL);
        while (waitpid(child, &how, WNOHANG) == 0) {
            kill(child, SIGINT);
            nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
        }
        assert_true(WIFEXITED(how) && WEXITSTATUS(how) == 0);
    }
}

PLACE_TEST(an_interruption_between_two_experiments_says_how_to_continue_too) {
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        RtJob job = {.name = "a"};
        RtError failure;
        dup2(open(path_in(place, "message").text, O_WRONLY | O_CREAT | O_TRUNC, 0666), STDERR_FILENO);
        if (rt_job_run(&job, "raytally run all --resume", &failure) != RT_OK) _exit(1);
        if (!job.here) raise(SIGTERM);
        _exit(0);
    }
    assert_int_equal(end_of(child), 128 + SIGTERM);
    assert_in_file(place, "message", "To continue:\n  raytally run all --resume\n");
}

PLACE_TEST(a_limit_of_time_stops_all_and_says_the_command_that_continues) {
    change(place, "b.yaml", "rounds: 2\nmilliseconds: 0", "rounds: 50\nmilliseconds: 200");
    assert_ends(place, "run b.yaml --threads 1 --out one --time 1", 2,
                "raytally: stopped after 1 s (--time); what is finished is kept in one. To continue:");
    assert_in_file(place, "message", "To continue:\n  raytally run b.yaml --out one --threads 1 --resume\n");
    assert_ends(place, "run a.yaml b.yaml c.yaml --threads 1 --out all --time 4", 2,
                "stopped after 4 s (--time); ");
    assert_true(exists(place, "all/a/report.html") && !exists(place, "all/c"));
    assert_ends(place, "run b.yaml --time 0", 2, "--time: invalid value '0': expected a whole number 1..");
}

PLACE_TEST(a_directory_that_is_removed_in_mid_run_is_reported) {
    int how;
    char command[300];
    change(place, "a.yaml", "rounds: 2\nmilliseconds: 0", "rounds: 20\nmilliseconds: 50");
    pid_t child = start_raytally(place, "run a.yaml --threads 1 --out gone");
    while (!exists(place, "gone/cells.jsonl")) {
        assert_int_equal(waitpid(child, &how, WNOHANG), 0);
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    snprintf(command, sizeof command, "until rm -rf '%s'; do :; done", path_in(place, "gone").text);
    assert_int_equal(system(command), 0);
    assert_int_equal(end_of(child), 2);
    assert_in_file(place, "message", "raytally: gone");
}

PLACE_TEST(reproduce_takes_several_directories_and_goes_on_after_one_that_differs) {
    assert_runs(place, "run a.yaml b.yaml --threads 1");
    assert_runs(place, "verify tetra:size=1 --accel bvh --rays 10 --out results/judged");
    assert_runs(place, "reproduce results/*");
    write_in(place, "results/a/counts.csv", "scene\n");
    assert_ends(place, "reproduce results/*", 1, "results/a/counts.csv:1: differs from the new counts");
    assert_in_file(place, "output", "Reproduced: results/b/counts.csv, byte for byte");
    assert_ends(place, "reproduce results/a results/nowhere", 2, "2 of 2 directories failed");
}

PLACE_TEST(a_quick_reproduction_counts_the_scene_with_the_least_work) {
    change(place, "a.yaml", "random:n=60", "random:n=300|60|200");
    assert_runs(place, "run a.yaml b.yaml --threads 1");
    assert_runs(place, "reproduce results/a results/b --quick");
    assert_in_file(place, "output", "Reproduced: cloud:n=60 in results/a/counts.csv, byte for byte");
    assert_ends(place, "reproduce results/a --quick --only cloud", 2, "both choose scenes");
}

RT_TESTS(cmd_run, NULL, NULL)
