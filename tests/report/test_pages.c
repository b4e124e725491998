/* SPDX-License-Identifier: Apache-2.0 */
/* What people look at: the order of the report, who is marked as best, looks, captions, tables for papers,
 * the index. In a browser: tests/check_pages.sh. */
#include "experiment_testing.h"

#include "report/plot.h"
#include "results/result_tables.h"

#include <unistd.h>

static const char experiment_yaml[] =
    "name: small\n"
    "question: Which is <cheaper>?\n"
    "prediction: The hierarchy.\n"
    "scenes: [{scene: \"random:n=60\", label: cloud, size: 12x12}]\n"
    "accelerators: [{accel: bvh}, {accel: grid}, {accel: brute}, {accel: ideal}]\n"
    "rays: [primary, random]\n"
    "limit: 50\n"
    "rounds: 2\n"
    "milliseconds: 0\n"
    "expect: [bytes of bvh < 1e9]\n";

PLACES_WITH(experiment_yaml)

/* small.yaml with `members` in the place of its claim. */
static void write_small(const Place *place, const char *members) {
    write_changed(place, "small.yaml", experiment_yaml, "expect: [bytes of bvh < 1e9]", members);
}

/* ---- the report ---- */

/* The page has these parts in this order; the text from the last one on. */
static const char *assert_in_order(const char *page, const char *const *parts, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const char *found = strstr(page, parts[i]);
        if (!found) fail_msg("the report lacks '%s' after what stands before it", parts[i]);
        if (found) page = found;
    }
    return page;
}

PLACE_TEST(the_report_has_verdict_finding_and_prediction_first_then_plots_then_tables) {
    const char *const parts[] = {"Which is &lt;cheaper&gt;?",
                                 "id=\"verdict\"",
                                 "<h2>Finding</h2>",
                                 "<h2>Prediction",
                                 "href=\"times.csv\"",
                                 "id=\"plots\"",
                                 "id=\"tables\"",
                                 "\"text\":\"bytes of bvh \\u003c 1e9\",\"verdict\":\"holds\"",
                                 "<script>"};
    assert_runs(place, "run small.yaml --out out --threads 1");
    OWNED_MEMORY char *page = read_in(place, "out/report.html");
    assert_in_order(page, parts, sizeof parts / sizeof parts[0]);
}

PLACE_TEST(a_report_of_frames_opens_with_the_fastest_and_its_plot) {
    static const char with_frame[] = "name: small\n"
                                     "question: Which is fastest?\n"
                                     "prediction: The grid.\n"
                                     "scenes: [{scene: \"random:n=60\", label: cloud, size: 12x12}]\n"
                                     "accelerators: [{accel: brute, group: none}, {accel: grid, group: "
                                     "ours}, {accel: bvh, group: other}]\n"
                                     "rays: [primary, shadow, reflection, transmission]\n"
                                     "frame: {without: brute, among: ours, note: A note.}\n"
                                     "plots: [frame.gp]\n"
                                     "rounds: 2\n"
                                     "milliseconds: 0\n";
    static const char *const parts[] = {"<h2>Whole frames</h2>",
                                        "\u2605: the fastest of ours.",
                                        "A note.",
                                        "A frame.</figcaption>",
                                        "id=\"verdict\"",
                                        "id=\"plots\"",
                                        "of 12x12: 144 primary"};
    write_in(place, "small.yaml", with_frame);
    write_in(place, "frame.gp",
             "#: frame: A frame.\nset terminal svg\nset output \"plots/frame.svg.tmp\"\nplot x\n");
    assert_runs(place, "run small.yaml --out out --threads 1");
    assert_in_file(place, "output", "> grid");
    assert_in_file(place, "out/frame.csv", "cloud,grid,ours,");
    char *page = read_in(place, "out/report.html");
    const char *last = assert_in_order(page, parts, sizeof parts / sizeof parts[0]);
    assert_null(strstr(last, "A frame.</figcaption>")); /* once */
    rt_free(page);
}

PLACE_TEST(a_plot_has_the_caption_that_its_script_says) {
    if (access("/usr/bin/gnuplot", X_OK) != 0) RT_SKIP("gnuplot-nox");
    write_in(place, "my.gp",
             "#: other: Not this.\n#: mine: Time & tests. All\n#:   kinds together.\n# Not this.\n"
             "set terminal svg size 300,200\nset output \"plots/mine.svg.tmp\"\nplot x\nunset output\n");
    write_small(place, "plots: [my.gp]");
    assert_runs(place, "run small.yaml --out out --threads 1");
    assert_in_file(place, "out/report.html",
                   "<figcaption>Time &amp; tests. All kinds together.</figcaption>");
    assert_in_file(place, "out/report.html", "alt=\"Plot mine. Its figures");
}

PLACE_TEST(a_plot_of_several_panels_is_laid_out_for_the_page_or_for_a_column) {
    if (access("/usr/bin/gnuplot", X_OK) != 0) RT_SKIP("gnuplot-nox");
    write_in(place, "my.gp", "eval canvas(\"mine\", wide, 240)\nplot x\nunset output\n");
    write_small(place, "plots: [style.gp, my.gp]");
    assert_runs(place, "run small.yaml --out out --threads 1");
    assert_in_file(place, "out/plots/mine.svg", "viewBox=\"0 0 960 240\"");
    assert_in_file(place, "out/report.html", "<a href=\"plots/mine.pdf\">PDF</a>");
    assert_runs(place, "plot out --trust --paper column");
    assert_in_file(place, "out/plots/mine.svg", "viewBox=\"0 0 480 240\"");
    assert_in_file(place, "out/plots/mine.pdf", "%PDF-");
    assert_runs(place, "plot out --trust --paper page");
    assert_in_file(place, "out/plots/mine.svg", "viewBox=\"0 0 960 240\"");
    assert_ends(place, "plot out --trust --paper a4", 2, "expected column or page");
}

/* As a limit of time leaves it: grid has no mean of tests, extent tests, steps and time, which are of other
 * rays. */
PLACE_TEST(a_kind_of_rays_that_an_accelerator_lacks_leaves_its_means_out_of_totals) {
    char command[1024];
    write_small(place, "expect: [ratio of object_tests of grid to bvh < 1000]");
    assert_runs(place, "run small.yaml --out out --threads 1");
    assert_in_file(place, "output", "48 rays, and fewer than 1000 decide nothing");
    snprintf(
        command, sizeof command,
        "cd '%s/out' && sed -i '/\"accel\":\"grid\",\"kind\":\"random\"/d' cells.jsonl && echo "
        "'{\"scene\":\"cloud\",\"accel\":\"grid\",\"kind\":\"random\",\"too_long\":\"it would take 9 s\"}' "
        ">>cells.jsonl",
        place->folder);
    assert_int_equal(system(command), 0);
    assert_ends(place, "run small.yaml --out out --threads 1 --resume", 0, "nothing was left to measure");
    assert_in_file(place, "output", "undecided        ratio of object_tests");
    assert_in_file(place, "output", "values are unknown");
    assert_in_file(place, "output",
                   "\n  undecided: the interval includes the bound, a value is missing, fewer than 1000 rays "
                   "were measured, "
                   "or no crossover is certain\n");
    assert_in_file(place, "out/report.html", "are unknown if a kind is missing");
    snprintf(command, sizeof command, "grep -Eqx 'grid +[0-9]+ +- +- +- +- +- .*' '%s/output'",
             place->folder);
    assert_int_equal(system(command), 0);
}

/* `gnuplot` before the real one in PATH, which fails where PDF is asked for. */
PLACE_TEST(where_gnuplot_cannot_draw_pdf_plots_are_svg_alone) {
    if (access("/usr/bin/gnuplot", X_OK) != 0) RT_SKIP("gnuplot-nox");
    write_in(place, "gnuplot",
             "#!/bin/sh\ncase $2 in *\\\"pdf\\\"*) exit 1 ;; esac\nexec /usr/bin/gnuplot \"$@\"\n");
    write_in(place, "my.gp", "set terminal svg\nset output sprintf(\"plots/mine.%s.tmp\", format)\nplot x\n");
    char command[1024], *path = getenv("PATH");
    snprintf(command, sizeof command, "chmod +x '%s'", path_in(place, "gnuplot").text);
    assert_int_equal(system(command), 0);
    char *before = strdup(path);
    snprintf(command, sizeof command, "%s:%s", place->folder, path);
    setenv("PATH", command, 1);
    write_small(place, "plots: [my.gp]");
    int code = raytally(place, "run small.yaml --out out --threads 1");
    setenv("PATH", before, 1);
    free(before);
    assert_int_equal(code, 0);
    assert_in_file(place, "out/plots/mine.svg", "<svg");
    assert_int_not_equal(access(path_in(place, "out/plots/mine.pdf").text, F_OK), 0);
    assert_int_not_equal(access(path_in(place, "out/plots/mine.pdf.tmp").text, F_OK), 0);
}

/* The accelerators of small.yaml on other scenes. */
static void run_scenes(const Place *place, const char *scenes, const char *count_only) {
    char yaml[1024];
    snprintf(yaml, sizeof yaml,
             "name: small\nquestion: Which?\nprediction: The hierarchy.\nscenes: [%s]\n"
             "accelerators: [{accel: bvh}, {accel: grid}, {accel: brute}, {accel: ideal}]\n"
             "rays: [primary, random]\nlimit: 50\nrounds: 2\nmilliseconds: 0\ncount_only: %s\n",
             scenes, count_only);
    write_in(place, "small.yaml", yaml);
    assert_runs(place, "run small.yaml --out out --threads 1 --force");
}

/* A row per accelerator and a column per scene with the best in bold, paired ratios of each kind of rays; a
 * sweep of a scene is a table whose columns are the values. */
PLACE_TEST(tables_for_papers_have_these_titles_rows_and_columns) {
    static const struct {
        const char *scenes, *count_only, *markdown[5], *tex[3];
    } cases[] = {
        {"{scene: \"random:n=60\", label: cloud, size: 12x12}, {scene: balls, size: 8x8}",
         "yes",
         {"\nObject tests per ray, all kinds of rays, of 416 rays, 180 measured.\n\n"
          "| accelerator | cloud | balls |\n"
          "| --- | ---: | ---: |\n| bvh | **",
          "| brute | 60.0 | ", "\nObject tests per ray, primary rays.\n"},
         {"\\begin{table}\n\\footnotesize", "accelerator & cloud & balls \\\\\n", "\nbvh & \\textbf{"}},
        {"{scene: \"random:n=60\", label: cloud, size: 12x12}",
         "no",
         {"\nThroughput relative to bvh, paired by round, primary rays.\n\n| accelerator | cloud |\n"
          "| --- | ---: |\n| bvh | ",
          "\nThroughput relative to bvh, paired by round, random rays.\n"},
         {"\\caption{Throughput relative to bvh, paired by round, primary rays.}"}},
        {"{scene: \"random:n=20..80*2\", size: 8x8}, {scene: balls, size: 8x8}",
         "no",
         {"\nTime per ray in ns, all kinds of rays, of 384 rays, 246 measured, random.\n\n"
          "| accelerator | n=20 | n=40 | n=80 |\n",
          "\nTime per ray in ns, all kinds of rays, of 128 rays, 82 measured.\n\n| accelerator | balls |\n",
          "\nTime to build in ms, random.\n", "\nTime per ray in ns, primary rays, random.\n"},
         {NULL}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        run_scenes(place, cases[i].scenes, cases[i].count_only);
        for (const char *const *text = cases[i].markdown; *text; text++)
            assert_in_file(place, "out/tables.md", *text);
        for (size_t k = 0; k < 3 && cases[i].tex[k]; k++)
            assert_in_file(place, "out/tables.tex", cases[i].tex[k]);
        if (i > 0) continue;
        assert_not_in_file(place, "out/tables.md", "Time");
        assert_not_in_file(place, "out/tables.md", "| ideal | **"); /* not compared */
        assert_in_file(place, "out/report.html", "\"standing\":\"best\",\"fields\":[\"bvh\",");
    }
}

PLACE_TEST(a_table_wider_than_a_column_takes_both_and_one_wider_than_the_page_is_divided) {
    run_scenes(place, "{scene: \"random:n=101..122+1\", size: 4x4, depth: 1}", "yes");
    assert_in_file(place, "out/tables.tex", "\\begin{table*}\n");
    assert_in_file(place, "out/tables.tex", "\\end{table*}\n");
    assert_in_file(place, "out/tables.tex", "accelerator & n=101 & ");
    OWNED_MEMORY char *text = read_in(place, "out/tables.tex");
    const char *row = strstr(text, "accelerator & n=101");
    assert_null(memmem(row, strcspn(row, "\n"), "n=122", 5));
    assert_non_null(strstr(text, " & n=122 \\\\\n"));
}

/* ---- who is best ---- */

static void set_time(const RtResults *results, uint32_t candidate, double low, double median, double high) {
    RtCell *cell = rt_cell_at(results, 0, candidate, RT_RAY_PRIMARY);
    cell->timed = true;
    cell->rounds = 6;
    cell->seconds = (RtEstimate){.median = median, .low = low, .high = high};
}

PLACE_TEST(the_best_has_the_least_median_and_level_is_whose_interval_overlaps_but_the_yardstick_is_none) {
    RtResults results;
    assert_ok(load_small(place, false, error));
    assert_ok(rt_results_init(&results, place->experiment, error));
    results.workloads[0].known = true;
    results.workloads[0].rays[RT_RAY_PRIMARY] = 10;
    set_time(&results, 0, 8, 10, 12);
    set_time(&results, 1, 11.9, 13, 14);
    set_time(&results, 2, 12.1, 13, 14);
    set_time(&results, 3, 1, 1, 1); /* ideal */
    const RtStanding expected[] = {RT_STANDING_BEST, RT_STANDING_LEVEL, RT_STANDING_BEHIND,
                                   RT_STANDING_BEHIND, RT_STANDING_BEHIND};
    for (uint32_t c = 0; c <= 4; c++) {
        assert_int_equal(rt_standing(&results, 0, c, RT_RAY_PRIMARY), expected[c]);
        assert_int_equal(rt_standing(&results, 0, c, RT_RAY_KIND_COUNT), expected[c]);
        assert_int_equal(rt_standing(&results, 0, c, RT_RAY_RANDOM), RT_STANDING_BEHIND); /* not measured */
    }
    rt_results_clear(&results);
}

/* ---- looks ---- */

static void take_accelerators(RtExperiment *experiment, const char *const *specs, uint32_t count) {
    experiment->candidate_count = count;
    for (uint32_t c = 0; c < count; c++)
        snprintf(experiment->candidates[c].spec, RT_MAX_SPEC_CHARS, "%s", specs[c]);
}

typedef struct Color {
    char text[RT_COLOR_CHARS];
} Color;

static Color color_of(const RtExperiment *experiment, uint32_t candidate) {
    Color color;
    rt_candidate_color(experiment, candidate, color.text);
    return color;
}

PLACE_TEST(an_accelerator_has_its_colour_in_every_experiment) {
    const char *const one[] = {"brute", "bvh", "grid:density=4"}, *const other[] = {"grid", "wide",
                                                                                    "bvh:bins=8+brute"};
    RtExperiment *experiment = place->experiment;
    take_accelerators(experiment, one, 3);
    const Color bvh = color_of(experiment, 1), grid = color_of(experiment, 2);
    take_accelerators(experiment, other, 3);
    assert_string_equal(color_of(experiment, 0).text, grid.text);
    assert_string_equal(color_of(experiment, 2).text, bvh.text);
    assert_string_not_equal(grid.text, bvh.text);
}

/* Rec. 709, of 0..255. */
static double lightness_of(const RtExperiment *experiment, uint32_t candidate) {
    const Color color = color_of(experiment, candidate);
    unsigned long rgb = strtoul(color.text + 1, NULL, 16);
    return 0.2126 * (double)(rgb >> 16) + 0.7152 * (double)(rgb >> 8 & 255) + 0.0722 * (double)(rgb & 255);
}

PLACE_TEST(five_settings_of_an_accelerator_are_told_apart_by_their_lightness) {
    static const char *const tops[] = {"light", "ideal", "octree", "extents"};
    for (int t = 0; t < 4; t++) {
        const char *specs[5] = {tops[t], tops[t], tops[t], tops[t], tops[t]};
        take_accelerators(place->experiment, specs, 5);
        for (uint32_t a = 0; a < 5; a++) {
            for (uint32_t b = 0; b < a; b++)
                assert_true(fabs(lightness_of(place->experiment, a) - lightness_of(place->experiment, b)) >
                            15);
        }
    }
}

/* ---- the index ---- */

PLACE_TEST(the_index_has_each_experiment_with_verdict_finding_and_link_and_names_what_cannot_be_read) {
    assert_runs(place, "run small.yaml --out all/one --threads 1");
    write_small(place, "finding: It <was>.");
    assert_runs(place, "run small.yaml --out 'all/deeper/two & a half' --threads 1");
    assert_int_equal(raytally(place, "run small.yaml --out 'all/a <\"damaged\">' --threads 1"), 0);
    write_in(place, "all/a <\"damaged\">/manifest.json", "{");
    assert_runs(place, "report --index all/");
    assert_in_file(place, "output", "all//index.html and index.md, of 3 experiments");
    assert_in_file(place, "all/index.html", "<a href=\"one/report.html\">one</a>");
    assert_in_file(place, "all/index.html", "<a href=\"deeper/two%20%26%20a%20half/report.html\">");
    assert_in_file(place, "all/index.html", "\"verdicts\":{\"deeper/two & a half\":{\"claims\":[],");
    assert_in_file(place, "all/index.html", "It &lt;was&gt;.");
    assert_in_file(place, "all/index.html", "id=\"a &lt;&quot;damaged&quot;&gt;\">");
    assert_in_file(place, "all/index.html", "Cannot be read:");
    assert_int_equal(raytally(place, "report --index nowhere"), 2);
    assert_int_equal(raytally(place, "report --index all small"), 2);
    assert_int_equal(system("test ! -e nowhere"), 0);
}

/* Runs small.yaml under another name, with `members` in the place of its claim. */
static void run_named(const Place *place, const char *name, const char *members) {
    char from[48], arguments[80], *text;
    write_small(place, members);
    text = read_in(place, "small.yaml");
    snprintf(from, sizeof from, "name: %s\n", name);
    write_changed(place, "small.yaml", text, "name: small\n", from);
    rt_free(text);
    snprintf(arguments, sizeof arguments, "run small.yaml --out all/%s --threads 1", name);
    assert_int_equal(raytally(place, arguments), 0);
}

PLACE_TEST(the_index_groups_experiments_by_section_with_plot_first_sentence_and_quotations) {
    run_named(place, "plain", "");
    run_named(place, "own", "section: zebras");
    run_named(
        place, "quoting",
        "section: papers\npaper: {citation: \"A | B 1988\", page: 19, quote: It <is>., verdict: in part}\n"
        "expect: [bytes of bvh < 1e9]\nfinding: So et al. 1990 said. The `rest` is folded.");
    run_named(place, "taught", "section: lecture");
    write_in(place, "all/quoting/plots/0.svg", "<svg/>");
    assert_runs(place, "verify tetra:size=1 --accel bvh --rays 10 --out all/judged");
    char *manifest = read_in(place, "all/plain/manifest.json");
    write_changed(place, "all/plain/manifest.json", manifest, "\"date\"",
                  "\"recounted\": {\"version\": \"9.9\", \"commit\": \"abc\"}, \"date\"");
    rt_free(manifest);
    assert_runs(place, "report --index all");
    const char *const page[] = {
        "<p class=\"meta\">Measured by raytally ",
        "Scenes that changed later were counted again by raytally 9.9 (abc).",
        "<h2>Lecture</h2>",
        "taught/report.html",
        "<h2>Papers</h2>",
        "<section class=\"card entry\" id=\"quoting\">",
        "<img loading=\"lazy\" alt=\"Plot of quoting\" src=\"quoting/plots/0.svg\">",
        "<p>Which is &lt;cheaper&gt;?</p>\n<p><strong>So et al. 1990 said.</strong></p>",
        "<h2>Verification</h2>",
        "10 comparisons in 1 row: 0 answers to nearest are wrong",
        "<h2>Zebras</h2>",
        "<h2>Others</h2>",
        "plain/report.html",
        "<noscript>",
        "\"citation\":\"A | B 1988\",\"page\":\"19\",\"seen\":true,\"quote\":\"It \\u003cis>.\""};
    char *text = read_in(place, "all/index.html");
    assert_in_order(text, page, sizeof page / sizeof page[0]);
    rt_free(text);
    const char *const markdown[] = {"## Papers\n\n| experiment | question | answer |\n",
                                    "| [quoting](quoting) | Which is \\<cheaper>? | So et al. 1990 said. |\n",
                                    "| [judged](judged) |  | 10 comparisons"};
    text = read_in(place, "all/index.md");
    assert_in_order(text, markdown, sizeof markdown / sizeof markdown[0]);
    rt_free(text);
}

PLACE_TEST(what_names_and_texts_hold_stays_text_in_the_index) {
    run_named(place, "'a|b*[c](d)'", "finding: \"`a|b*` & a|b* and ` and ** to the end.\"");
    assert_int_equal(raytally(place, "run small.yaml --out 'all/<i>\"x\"' --threads 1"), 0);
    write_in(place, "all/<i>\"x\"/manifest.json", "{");
    assert_runs(place, "report --index all");
    assert_in_file(place, "all/index.html", "id=\"&lt;i&gt;&quot;x&quot;\">");
    assert_in_file(place, "all/index.html", "`a|b*` &amp; a|b* and ` and ** to the end.</strong>");
    assert_in_file(place, "all/index.md", "| [a\\|b\\*\\[c\\](d)](");
    assert_in_file(place, "all/index.md", "`a\\|b*` & a\\|b\\* and ` and \\*\\* to the end.");
}

PLACE_TEST(the_index_says_what_another_build_or_machine_measured) {
    run_named(place, "one", "");
    run_named(place, "two", "");
    run_named(place, "three", "");
    assert_runs(place, "report --index all");
    assert_not_in_file(place, "all/index.md", ": one");
    OWNED_MEMORY char *manifest = read_in(place, "all/two/manifest.json");
    const char *cpu = strstr(manifest, "\"cpu\": ");
    assert_non_null(cpu);
    *strchr(cpu, ':') = '\0';
    char *rest = strchr(cpu + strlen(cpu) + 1, ',');
    char *changed = NULL;
    assert_true(asprintf(&changed, "%s: \"Z80\"%s", manifest, rest) > 0);
    write_in(place, "all/two/manifest.json", changed);
    free(changed);
    assert_runs(place, "report --index all");
    assert_in_file(place, "all/index.md", "; Z80: two.\n");
    assert_in_file(place, "all/index.html", "; Z80: two.</p>");
}

RT_TESTS(pages, NULL, NULL)
