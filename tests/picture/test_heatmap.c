/* SPDX-License-Identifier: Apache-2.0 */
/* Heatmaps: colours of costs, one scale for all panels, legends. */
#define PICTURE_FILE RT_BINARY_DIR "/test_heatmap_picture.png"

#include "picture/picture_testing.h"
#include "picture/pictures.h"

RT_TEST(a_heatmap_is_dark_where_nothing_was_spent_and_yellow_at_the_most) {
    enum { W = 240, H = 20 };
    static RtTally cost[W * H];
    RtFrame frame = {.cost = cost};
    const RtHeatmapPanel panel = {&frame, NULL};
    const RtHeatmapOptions options = {.counter = offsetof(RtTally, object_tests) / sizeof(uint64_t)};
    assert_ok(rt_sampling_init(&frame.sampling, W, H, 1, false, error));
    for (int i = 0; i < W * H; i++) cost[i].object_tests = i == 0 ? 0 : i == 1 ? 100 : 50;
    assert_ok(rt_heatmap_draw(PICTURE_FILE, &panel, 1, &options, error));
    OWNED_IMAGE image = read_picture();
    RtColor none = rt_color_scale(0), half = rt_color_scale(0.5), most = rt_color_scale(1);
    assert_memory_equal(image.rgb, none.rgb, 3);
    assert_memory_equal(image.rgb + 3, most.rgb, 3);
    assert_memory_equal(image.rgb + 6, half.rgb, 3); /* linear */
    assert_true(image.height > H);
    rt_image_clear(&image);
    /* One pixel far above all others: a logarithmic scale still tells 0 from 50. */
    cost[1].object_tests = 1000000;
    assert_ok(rt_heatmap_draw(PICTURE_FILE, &panel, 1, &options, error));
    image = read_picture();
    RtColor some = rt_color_scale(log1p(50) / log1p(1e6));
    assert_memory_equal(image.rgb + 6, some.rgb, 3);
}

RT_TEST(a_heatmap_of_nothing_or_of_one_pixel_has_its_legend) {
    RtTally cost = {0};
    RtFrame frame = {.cost = &cost};
    const RtHeatmapPanel panel = {&frame, NULL};
    const RtHeatmapOptions options = {.counter = offsetof(RtTally, steps) / sizeof(uint64_t)};
    assert_ok(rt_sampling_init(&frame.sampling, 1, 1, 1, false, error));
    for (uint64_t steps = 0; steps < 3; steps++) {
        cost.steps = steps == 2 ? UINT64_MAX : steps;
        assert_ok(rt_heatmap_draw(PICTURE_FILE, &panel, 1, &options, error));
        OWNED_IMAGE image = read_picture();
        assert_true(image.width > 100);
    }
}

/* Two pictures of one row of pixels, beside one another. */
enum { WIDE = 300 };
static RtTally costs[2][WIDE];

static RtImage two_heatmaps(RtHeatmapOptions options) {
    RtFrame frames[2] = {{.cost = costs[0]}, {.cost = costs[1]}};
    RtHeatmapPanel panels[2] = {{&frames[0], "one"}, {&frames[1], "two"}};
    for (int i = 0; i < 2; i++) assert_ok(rt_sampling_init(&frames[i].sampling, WIDE, 1, 1, false, error));
    options.counter = offsetof(RtTally, steps) / sizeof(uint64_t);
    assert_ok(rt_heatmap_draw(PICTURE_FILE, panels, 2, &options, error));
    return read_picture();
}

/* Has the first row of panel `panel` this colour at x? Panels are 4 pixels apart. */
static bool has_color(const RtImage *image, int panel, int x, RtColor color) {
    const int top = 20; /* below the label */
    return memcmp(pixel(image, panel * (WIDE + 4) + x, top), color.rgb, 3) == 0;
}

RT_TEST(heatmaps_of_two_accelerators_have_one_scale) {
    for (int i = 0; i < WIDE; i++) costs[0][i].steps = 50, costs[1][i].steps = i == 0 ? 100 : 25;
    OWNED_IMAGE image = two_heatmaps((RtHeatmapOptions){0});
    assert_true(has_color(&image, 0, 0, rt_color_scale(0.5)));
    assert_true(has_color(&image, 1, 0, rt_color_scale(1)));
    assert_true(has_color(&image, 1, 1, rt_color_scale(0.25)));
    rt_image_clear(&image);
    image = two_heatmaps((RtHeatmapOptions){.most = 50});
    assert_true(has_color(&image, 0, 0, rt_color_scale(1)));
    assert_true(has_color(&image, 1, 0, rt_color_scale(1)));
    assert_true(has_color(&image, 1, 1, rt_color_scale(0.5)));
    rt_image_clear(&image);
    image = two_heatmaps((RtHeatmapOptions){.scale = RT_HEATMAP_LOG});
    assert_true(has_color(&image, 0, 0, rt_color_scale(log1p(50) / log1p(100))));
    rt_image_clear(&image);
    costs[0][5].steps = 200; /* the most is the first's */
    image = two_heatmaps((RtHeatmapOptions){0});
    assert_true(has_color(&image, 0, 5, rt_color_scale(1)));
    assert_true(has_color(&image, 1, 0, rt_color_scale(0.5)));
}

RT_TEST(a_difference_is_red_where_the_first_costs_more_and_blue_where_the_second_does) {
    for (int i = 0; i < WIDE; i++)
        costs[0][i].steps = 50, costs[1][i].steps = i == 0 ? 100 : i == 1 ? 50 : 25;
    OWNED_IMAGE image = two_heatmaps((RtHeatmapOptions){.difference = true});
    assert_true(has_color(&image, 2, 0, rt_color_difference(-1)));
    assert_true(has_color(&image, 2, 1, rt_color_difference(0)));
    assert_true(has_color(&image, 2, 2, rt_color_difference(0.5)));
    RtColor blue = rt_color_difference(-1), red = rt_color_difference(1);
    assert_true(blue.rgb[2] > blue.rgb[0] && red.rgb[0] > red.rgb[2]);
}

RT_TEST(the_scale_grows_in_lightness) {
    double before = -1;
    for (int i = 0; i <= 100; i++) {
        RtColor c = rt_color_scale(i / 100.0);
        double lightness = 0.2126 * c.rgb[0] + 0.7152 * c.rgb[1] + 0.0722 * c.rgb[2];
        assert_true(lightness >= before);
        before = lightness;
    }
}

RT_TESTS(heatmap, NULL, NULL)
