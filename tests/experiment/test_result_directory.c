/* SPDX-License-Identifier: Apache-2.0 */
/* A result directory: what is in it is not lost, whoever runs into it, whatever fails.
 *
 * Linked so that openings of scenes come here, to be counted. */
#include "small_run_testing.h"

#include "core/base/file.h"
#include "scenes/open.h"

#include <sys/stat.h>

static RtStatus run(const Place *place, const char *directory, RtStart start, RtError *error) {
    return run_small(place, directory, false, (RtRunOptions){.start = start}, error);
}

/* ---- calls that come here ---- */

RtStatus __real_rt_scene_open(const char *spec, RtScene *scene, RtError *error);
RtStatus __wrap_rt_scene_open(const char *spec, RtScene *scene, RtError *error);

static int scenes_opened;

RtStatus __wrap_rt_scene_open(const char *spec, RtScene *scene, RtError *error) {
    scenes_opened++;
    return __real_rt_scene_open(spec, scene, error);
}

/* ---- whose results they are ---- */

PLACE_TEST(results_are_refused_unless_they_are_gone_on_with_or_begun_anew) {
    assert_runs(place, "run small.yaml");
    OWNED_MEMORY char *journal = read_in(place, "results/small/cells.jsonl"),
                      *page = read_in(place, "results/small/manifest.json");
    assert_ends(place, "run small.yaml", 2, "holds a finished run: use --resume to rewrite its tables");
    assert_ends(place, "run small.yaml --out results/small", 2, "--force to start over");
    assert_ends(place, "run small.yaml --quick", 2, "without --quick");
    write_changed(place, "other.yaml", small_experiment, "limit: 100", "limit: 99");
    assert_ends(place, "run other.yaml", 2, "another version of it ('small')");
    assert_ends(place, "run other.yaml --resume", 2, "another version of it ('small')");
    assert_ends(place, "verify tetra:size=1 --accel bvh --rays 10 --out results/small", 2, "of another kind");
    assert_ends(place, "verify tetra:size=1 --accel bvh --rays 10 --out results/small --resume", 2,
                "of another kind");
    assert_same_file(place, "results/small/cells.jsonl", journal);
    assert_same_file(place, "results/small/manifest.json", page);
    assert_int_equal(remove(path_in(place, "results/small/manifest.json").text), 0);
    assert_ends(place, "run small.yaml", 2, "holds an unfinished run: use --resume to continue it");
    assert_same_file(place, "results/small/cells.jsonl", journal);
    assert_runs(place, "run other.yaml --resume --force");
    assert_ends(place, "run other.yaml --force --resume", 0, "nothing was left to measure");
}

/* ---- formats ---- */

/* Changes the member `format` of both files of a run, or removes it for "". */
static void set_format(const Place *place, const char *member) {
    char command[512];
    snprintf(command, sizeof command,
             "cd '%s/results/small' && sed -Ei 's/^  \"format\": [0-9]+,/  %s/' manifest.json && "
             "sed -Ei '1s/\"format\":[0-9]+,/%s/' cells.jsonl",
             place->folder, member, member);
    assert_int_equal(system(command), 0);
}

PLACE_TEST(results_of_0_1_which_name_no_format_are_read_and_those_of_a_later_format_refused) {
    const char *const reading[] = {"report results/small", "reproduce results/small",
                                   "run small.yaml --resume", "compare results/small results/small"};
    assert_runs(place, "run small.yaml --threads 1");
    assert_in_file(place, "results/small/manifest.json", "\"format\": 1");
    assert_in_file(place, "results/small/cells.jsonl", "{\"format\":1,");
    set_format(place, "");
    assert_not_in_file(place, "results/small/cells.jsonl", "format");
    for (size_t i = 0; i < sizeof reading / sizeof reading[0]; i++) assert_runs(place, reading[i]);
    assert_runs(place, "run small.yaml --threads 1 --force");
    set_format(place, "\"format\": 2,");
    for (size_t i = 0; i < sizeof reading / sizeof reading[0]; i++)
        assert_ends(place, reading[i], 2, "its format is 2, and raytally " RT_VERSION " reads formats 1..1");
}

PLACE_TEST(counts_of_another_version_may_differ_and_reproduce_says_so) {
    assert_runs(place, "run small.yaml");
    OWNED_MEMORY char *manifest = read_in(place, "results/small/manifest.json");
    assert_runs(place, "reproduce results/small");
    assert_not_in_file(place, "output", "some may differ");
    write_changed(place, "results/small/manifest.json", manifest, "\"counts\": 2", "\"counts\": 1");
    assert_ends(place, "reproduce results/small", 0,
                "counts of version 1, and this raytally makes version 2");
}

/* ---- what is measured ---- */

PLACE_TEST(run_and_bench_thin_a_set_to_the_same_rays) {
    write_in(place, "thin.yaml",
             "name: thin\nquestion: a\nprediction: b\nscenes: [{scene: balls:size=1, size: 200x200}]\n"
             "accelerators: [{accel: bvh}, {accel: grid}]\nlimit: 17000\ncount_only: yes\n");
    assert_runs(place, "run thin.yaml");
    assert_ends(place,
                "bench balls:size=1 --size 200x200 --accel bvh --accel grid --limit 17000 --count-only "
                "--csv thin.csv",
                0, "");
    assert_in_file(place, "output", "\nwrote thin.csv\n");
    assert_equal_files(place, "results/thin/counts.csv", "thin.csv");
    /* Runs are as long as when it was measured, even if the default has changed since. */
    assert_runs(place, "reproduce results/thin");
    OWNED_MEMORY char *manifest = read_in(place, "results/thin/manifest.json");
    write_changed(place, "results/thin/manifest.json", manifest, "\"coherent_run\": 256",
                  "\"coherent_run\": 1");
    assert_ends(place, "reproduce results/thin", 1, "differs from the new counts");
}

/* Times depend on the machine: the mark is put into the journal. */
PLACE_TEST(rays_that_are_learnt_are_marked_and_cause_a_warning) {
    const char *warning = "with other rays between their passes: on balls:size=1, 72 primary rays (";
    char command[256];
    write_changed(place, "short.yaml", small_experiment, "count_only: yes", "rounds: 2\nmilliseconds: 1");
    assert_runs(place, "run short.yaml");
    assert_in_file(place, "results/small/times.csv", ",structures,learnt,");
    snprintf(command, sizeof command,
             "cd '%s' && sed -Ei 's/\"learnt\":[^,]+,/\"learnt\":1.3,/' results/small/cells.jsonl",
             place->folder);
    assert_int_equal(system(command), 0);
    assert_runs(place, "report results/small");
    assert_in_file(place, "results/small/report.html", warning);
    write_changed(place, "once.yaml", small_experiment, "count_only: yes", "rounds: 2\nmilliseconds: 0");
    assert_runs(place, "run once.yaml --force"); /* one pass a round: other rays lie between */
    assert_not_in_file(place, "output", "Too few rays");
    assert_not_in_file(place, "results/small/report.html", "Too few rays");
}

PLACE_TEST(a_finished_run_that_is_resumed_shows_its_table_and_keeps_its_manifest) {
    assert_runs(place, "run small.yaml --threads 1 --resume");
    OWNED_MEMORY char *table = read_in(place, "output"),
                      *manifest = read_in(place, "results/small/manifest.json");
    assert_non_null(strstr(table, "cloud"));
    assert_int_equal(remove(path_in(place, "results/small/counts.csv").text), 0);
    assert_ends(place, "run small.yaml --threads 2 --resume", 0, "nothing was left to measure");
    assert_same_file(place, "output", table);
    assert_same_file(place, "results/small/manifest.json", manifest);
    assert_true(rt_file_exists(path_in(place, "results/small/counts.csv").text));
}

PLACE_TEST(results_without_their_journal_are_not_gone_on_with) {
    assert_runs(place, "run small.yaml");
    OWNED_MEMORY char *counts = read_in(place, "results/small/counts.csv");
    assert_int_equal(remove(path_in(place, "results/small/cells.jsonl").text), 0);
    assert_ends(place, "run small.yaml --resume", 2, "no cells.jsonl");
    assert_same_file(place, "results/small/counts.csv", counts);
}

PLACE_TEST(what_begins_anew_leaves_nothing_of_what_was_there) {
    assert_runs(place, "verify tetra:size=1 --accel bvh --rays 10 --out out");
    assert_ends(place, "run small.yaml --out out --resume", 2, "no cells.jsonl");
    assert_runs(place, "run small.yaml --out out --force");
    write_in(place, "out/plots/old.svg", "<svg/>");
    write_in(place, "out/plots/old.pdf", "%PDF");
    write_in(place, "out/notes.txt", "mine");
    assert_runs(place, "run small.yaml --out out --force");
    for (int i = 0; i < 4; i++) {
        const char *const gone[] = {"out/rows.jsonl", "out/verify.csv", "out/plots/old.svg",
                                    "out/plots/old.pdf"};
        assert_false(rt_file_exists(path_in(place, gone[i]).text));
    }
    assert_in_file(place, "out/notes.txt", "mine");
}

/* Each of these fails; with --force, too, no byte of the results that are there has changed then. */
PLACE_TEST(nothing_is_touched_before_all_that_may_fail_was_tried) {
    const struct {
        const char *from, *to;
    } faults[] = {{"limit: 100\n", "limit: -1\n"},  {"limit: 100\n", "limit: 100\nplots: [nowhere.gp]\n"},
                  {"accel: grid", "accel: gird"},   {"accel: grid", "accel: \"grid:density=-1\""},
                  {"random:n=50", "random:n=-50"},  {"\"random:n=50\"", "nowhere.obj"},
                  {"\"random:n=50\"", "broken.nff"}};
    write_in(place, "broken.nff", "s 0 0 0 nan\n");
    assert_runs(place, "run small.yaml --out out");
    OWNED_MEMORY char *journal = read_in(place, "out/cells.jsonl"),
                      *yaml = read_in(place, "out/experiment.yaml"),
                      *manifest = read_in(place, "out/manifest.json");
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        write_changed(place, "faulty.yaml", small_experiment, faults[i].from, faults[i].to);
        assert_ends(place, "run faulty.yaml --out out --force", 2, "");
        assert_same_file(place, "out/cells.jsonl", journal);
        assert_same_file(place, "out/experiment.yaml", yaml);
        assert_same_file(place, "out/manifest.json", manifest);
    }
    /* A file that cannot be replaced, even by root. */
    assert_int_equal(remove(path_in(place, "out/experiment.yaml").text), 0);
    assert_int_equal(mkdir(path_in(place, "out/experiment.yaml").text, 0777), 0);
    assert_ends(place, "run small.yaml --out out --force", 2, "out/experiment.yaml is a folder");
    assert_same_file(place, "out/cells.jsonl", journal);
    assert_same_file(place, "out/manifest.json", manifest);
}

/* ---- two at a time ---- */

PLACE_TEST(a_second_process_is_refused) {
    const char *const writing[] = {"run small.yaml --out out --force", "run small.yaml --out out --resume",
                                   "verify tetra:size=1 --rays 10 --out out --force", "plot out",
                                   "report out"};
    RtLock lock;
    assert_runs(place, "run small.yaml --out out");
    assert_ok(rt_lock_take(&lock, path_in(place, "out").text, error));
    assert_true(rt_lock_is_held(&lock));
    for (size_t i = 0; i < sizeof writing / sizeof writing[0]; i++)
        assert_ends(place, writing[i], 2, "out: another process is writing");
    assert_ends(place, "reproduce out", 0, "");
    assert_bad_input(run(place, "out", RT_START_ANEW, error), "is writing");
    rt_lock_release(&lock);
    for (size_t i = 0; i < sizeof writing / sizeof writing[0]; i += 3) assert_runs(place, writing[i]);
}

/* ---- plots ---- */

PLACE_TEST(a_script_that_lies_elsewhere_is_copied_into_the_directory) {
    assert_ok(rt_directory_create(path_in(place, "here").text, error));
    assert_ok(rt_directory_create(path_in(place, "there/deep").text, error));
    write_in(place, "x.gp", "print 1\n");
    write_in(place, "there/deep/y.gp", "print 2\n");
    write_changed(place, "here/small.yaml", small_experiment, "limit: 100\n",
                  "limit: 100\nplots: [../x.gp, ../there/deep/y.gp]\n");
    assert_runs(place, "run here/small.yaml --out out/deep");
    assert_in_file(place, "out/deep/plots/x.gp", "print 1");
    assert_in_file(place, "out/deep/plots/y.gp", "print 2");
    assert_false(rt_file_exists(path_in(place, "out/deep/x.gp").text));
    assert_runs(place, "plot out/deep --trust");
}

PLACE_TEST(two_scripts_of_one_name_are_refused_with_their_line) {
    const char *const lists[] = {"[x.gp,\n  ../x.gp]", "[x.gp,\n  there/]", "[x.gp,\n  ..]"};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        char plots[64];
        snprintf(plots, sizeof plots, "limit: 100\nplots: %s\n", lists[i]);
        write_changed(place, "small.yaml", small_experiment, "limit: 100\n", plots);
        assert_bad_input(load_small(place, false, error), "small.yaml:13:3:");
    }
}

PLACE_TEST(an_experiment_that_is_named_like_a_folder_above_is_refused) {
    write_changed(place, "small.yaml", small_experiment, "name: small", "name: ..");
    assert_bad_input(load_small(place, false, error), "small.yaml:1:");
}

/* A gnuplot of our own, in the folder bin of the place. */
static void make_gnuplot(const Place *place, const char *script) {
    assert_ok(rt_directory_create(path_in(place, "bin").text, error));
    write_in(place, "bin/gnuplot", script);
    assert_int_equal(chmod(path_in(place, "bin/gnuplot").text, 0777), 0);
}

static void assert_ends_with_path(const Place *place, const char *path, const char *arguments, int code,
                                  const char *says) {
    char *kept = strdup(getenv("PATH"));
    setenv("PATH", path, 1);
    int ended = raytally(place, arguments);
    setenv("PATH", kept, 1);
    free(kept);
    assert_ended(place, arguments, ended, code, says);
}

PLACE_TEST(gnuplot_that_fails_is_told_of_by_exit_code_1_and_its_own_words) {
    Path bin = path_in(place, "bin");
    write_in(place, "x.gp", "plot nonsense\n");
    write_changed(place, "small.yaml", small_experiment, "limit: 100\n", "limit: 100\nplots: [x.gp]\n");
    make_gnuplot(place,
                 "#!/bin/sh\necho '\"plots/x.gp\" line 1: undefined variable: nonsense' >&2\nexit 1\n");
    const char *says = "gnuplot failed:\n\"plots/x.gp\" line 1: undefined variable: nonsense";
    assert_ends_with_path(place, bin.text, "run small.yaml --out out", 1, says);
    assert_in_file(place, "out/counts.csv", "cloud");
    assert_in_file(place, "out/report.html", "</html>");
    assert_ends_with_path(place, bin.text, "plot out --trust", 1, says);
    assert_ends_with_path(place, bin.text, "run small.yaml --out out --resume", 1, says);
    make_gnuplot(place, "#!/bin/sh\nexit 3\n");
    assert_ends_with_path(place, bin.text, "plot out --trust", 1, "its scripts: plots/x.gp");
}

PLACE_TEST(where_there_is_no_gnuplot_a_note_says_so) {
    write_in(place, "x.gp", "print 1\n");
    write_changed(place, "small.yaml", small_experiment, "limit: 100\n", "limit: 100\nplots: [x.gp]\n");
    assert_ends_with_path(place, "/nowhere", "run small.yaml --out out", 0, "gnuplot is not installed");
    assert_ends_with_path(place, "/nowhere", "plot out --trust", 0, "gnuplot is not installed");
    assert_ends_with_path(place, "/nowhere", "run small.yaml --out out --resume", 0,
                          "gnuplot is not installed");
}

/* ---- whose scripts are run ---- */

/* raytally, with a gnuplot that leaves a file: whether it was run is the last argument. */
static void assert_draws(const Place *place, const char *arguments, int code, const char *says, bool runs) {
    Path ran = path_in(place, "ran");
    char script[320];
    snprintf(script, sizeof script, "#!/bin/sh\n: >'%s'\n", ran.text);
    make_gnuplot(place, script);
    remove(ran.text);
    assert_ends_with_path(place, path_in(place, "bin").text, arguments, code, says);
    if (rt_file_exists(ran.text) != runs) fail_msg("raytally %s: gnuplot ran, or did not", arguments);
}

static void name_plots(const Place *place, const char *plots) {
    write_changed(place, "small.yaml", small_experiment, "limit: 100\n", plots);
}

PLACE_TEST(a_script_in_a_result_directory_is_run_if_it_is_trusted) {
    const char *says = "out/plots/x.gp: raytally does not ship this gnuplot script";
    write_in(place, "x.gp", "system('harm')\n");
    name_plots(place, "limit: 100\nplots: [style.gp, x.gp]\n");
    assert_draws(place, "run small.yaml --out out", 0, "", true);
    assert_draws(place, "plot out", 2, says, false);
    assert_draws(place, "plot out", 2, "--trust", false);
    assert_draws(place, "plot out --trust", 0, "", true);
    assert_draws(place, "report out", 0, "", false);
    assert_draws(place, "reproduce out", 0, "", false);
}

PLACE_TEST(shipped_scripts_are_found_where_they_are_installed_and_not_copied) {
    name_plots(place, "limit: 100\nplots: [style.gp, ../lecture/growth.gp]\n");
    make_gnuplot(place, "#!/bin/sh\nprintf '%s\\n' \"$@\" >../arguments\n");
    assert_ends_with_path(place, path_in(place, "bin").text, "run small.yaml --out out", 0, "");
    assert_in_file(place, "arguments", "share/raytally/experiments/style.gp",
                   "share/raytally/experiments/lecture/growth.gp", "experiment = \"small\"");
    assert_false(rt_file_exists(path_in(place, "out/plots/growth.gp").text));
}

/* A copy of a shipped script, perhaps changed by somebody else, is not run for its name. */
PLACE_TEST(a_changed_copy_of_a_shipped_script_is_run_only_if_it_is_trusted) {
    name_plots(place, "limit: 100\nplots: [growth.gp]\n");
    assert_draws(place, "run small.yaml --out out", 0, "", true);
    write_in(place, "out/plots/growth.gp", "system('harm')\n");
    make_gnuplot(place, "#!/bin/sh\nprintf '%s\\n' \"$@\" >../arguments\n");
    assert_ends_with_path(place, path_in(place, "bin").text, "plot out", 0, "");
    assert_in_file(place, "arguments", "share/raytally/experiments/lecture/growth.gp");
    assert_ends_with_path(place, path_in(place, "bin").text, "plot out --trust", 0, "");
    assert_in_file(place, "arguments", "\nplots/growth.gp");
}

PLACE_TEST(nothing_is_drawn_through_a_link_out_of_the_directory) {
    name_plots(place, "limit: 100\nplots: [growth.gp]\n");
    assert_draws(place, "run small.yaml --out out", 0, "", true);
    remove(path_in(place, "out/plots/gnuplot.log").text);
    write_in(place, "mine", "mine");
    assert_int_equal(symlink("../../mine", path_in(place, "out/plots/gnuplot.log").text), 0);
    assert_draws(place, "plot out", 2, "out/plots/gnuplot.log is a symbolic link", false);
    assert_draws(place, "run small.yaml --out out --resume", 2, "is a symbolic link", false);
    assert_in_file(place, "mine", "mine");
}

PLACE_TEST(a_run_draws_by_the_scripts_beside_its_experiment_and_by_changed_copies_if_they_are_trusted) {
    write_in(place, "x.gp", "print 1\n");
    name_plots(place, "limit: 100\nplots: [x.gp]\n");
    assert_draws(place, "run small.yaml --out out", 0, "", true);
    assert_draws(place, "run small.yaml --out out --resume", 0, "", true);
    assert_draws(place, "run out/manifest.json --out other", 2, "x.gp: raytally does not ship", false);
    assert_false(rt_file_exists(path_in(place, "other").text));
    assert_draws(place, "run out/manifest.json --out other --trust", 0, "", true);
    write_in(place, "out/plots/x.gp", "print 2\n");
    assert_draws(place, "run small.yaml --out out --resume", 2, "nor is it the one beside", false);
    assert_draws(place, "run small.yaml --out out --resume --trust", 0, "", true);
    assert_in_file(place, "out/plots/x.gp", "print 2");
    assert_draws(place, "run small.yaml --out out --force", 0, "", true);
    assert_in_file(place, "out/plots/x.gp", "print 1");
}

PLACE_TEST(a_merge_draws_by_scripts_that_raytally_does_not_ship_only_if_they_are_trusted) {
    const char *const runs[] = {"run small.yaml --shard 1/2 --out s1", "run small.yaml --shard 2/2 --out s2",
                                "run t1/small.yaml --shard 1/2 --out t1",
                                "run t1/small.yaml --shard 2/2 --out t2"};
    write_in(place, "x.gp", "print 1\n");
    name_plots(place, "limit: 100\nplots: [x.gp]\n");
    assert_int_equal(mkdir(path_in(place, "t1").text, 0777), 0);
    write_in(place, "t1/x.gp", "print 1\n");
    OWNED_MEMORY char *yaml = read_in(place, "small.yaml");
    write_in(place, "t1/small.yaml", yaml);
    for (int i = 0; i < 4; i++) assert_draws(place, runs[i], 0, "", false);
    assert_draws(place, "merge s1 s2 -o all", 2, "x.gp: raytally does not ship", false);
    assert_draws(place, "merge s1 s2 -o all --trust", 0, "", true);
    write_in(place, "all/plots/x.gp", "print 2\n");
    assert_draws(place, "merge s1 s2 -o all --force --trust", 0, "", true);
    assert_in_file(place, "all/plots/x.gp", "print 1");
    assert_draws(place, "merge t1 t2 -o both", 2, "t1/x.gp: raytally does not ship", false);
    assert_draws(place, "merge t1 t2 -o both --trust", 0, "", true);
}

/* ---- scenes ---- */

PLACE_TEST(a_scene_is_opened_once_in_a_run_and_not_at_all_when_nothing_is_left) {
    scenes_opened = 0;
    assert_ok(run(place, "out", RT_START_FRESH, error));
    assert_int_equal(scenes_opened, 2); /* the first and the last workload are on the same */
    assert_true(rt_file_exists(path_in(place, "out/images/again.png").text));
    scenes_opened = 0;
    assert_ok(run(place, "out", RT_START_RESUME, error));
    assert_int_equal(scenes_opened, 0);
    assert_int_equal(remove(path_in(place, "out/images/again.png").text), 0);
    assert_ok(run(place, "out", RT_START_RESUME, error));
    assert_int_equal(scenes_opened, 1);
    assert_true(rt_file_exists(path_in(place, "out/images/again.png").text));
}

RT_TESTS(result_directory, NULL, NULL)
