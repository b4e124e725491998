/* SPDX-License-Identifier: Apache-2.0 */
/* render/frame.h: every sample of a frame once, in blocks of neighbours. */
#include "testing.h"

#include "render/frame.h"

static const RtSampling samplings[] = {
    {.columns = 1, .rows = 1},    {.columns = 16, .rows = 16}, {.columns = 50, .rows = 37},
    {.columns = 300, .rows = 17}, {.columns = 5, .rows = 700}, {.columns = 104, .rows = 72},
};

/* Asserts that tile after tile has each sample of the frame once, and gives how many samples come before the
 * first block of 64 that is not one of 8 x 8. */
static uint32_t walk(const RtSampling *s) {
    size_t tiles = rt_tile_count(s), samples = (size_t)s->columns * s->rows;
    OWNED_MEMORY RtSample *tile = rt_alloc(tiles, sizeof(RtSample));
    OWNED_MEMORY bool *seen = rt_alloc(samples, sizeof(bool));
    uint32_t count = 0, whole = UINT32_MAX;
    RtSample first = {0, 0};
    assert_true(tile && seen);
    rt_tiles_in_order(s, tile);
    const size_t each = (size_t)RT_TILE * RT_TILE;
    for (size_t i = 0; i < tiles * each; i++) {
        RtSample at = rt_tile_sample(tile[i / each], (uint32_t)(i % each));
        if (at.column >= s->columns || at.row >= s->rows) continue;
        size_t k = (size_t)at.row * s->columns + at.column;
        assert_false(seen[k]);
        seen[k] = true;
        if (count % RT_TILE_BLOCK == 0) first = at;
        bool inside = first.column % 8 == 0 && first.row % 8 == 0 && at.column - first.column < 8 &&
                      at.row - first.row < 8;
        if (!inside && whole == UINT32_MAX) whole = count - count % RT_TILE_BLOCK;
        count++;
    }
    assert_int_equal(count, samples);
    return whole < count ? whole : count - count % RT_TILE_BLOCK;
}

RT_TEST(every_sample_comes_once_and_whole_blocks_come_first) {
    const uint32_t whole[] = {0, 256, 3 * 2 * 256, 18 * 256, 0, 104 * 72};
    for (size_t i = 0; i < sizeof samplings / sizeof samplings[0]; i++)
        assert_int_equal(walk(&samplings[i]), whole[i]);
}

/* Morton codes: column and row take turns, from the lowest bit on. */
RT_TEST(samples_of_a_tile_follow_the_z_order_curve) {
    const RtSample expected[] = {{32, 48}, {33, 48}, {32, 49}, {33, 49},
                                 {34, 48}, {35, 48}, {34, 49}, {35, 49}};
    for (uint32_t i = 0; i < 8; i++) {
        RtSample at = rt_tile_sample((RtSample){32, 48}, i);
        assert_int_equal(at.column, expected[i].column);
        assert_int_equal(at.row, expected[i].row);
    }
    RtSample last = rt_tile_sample((RtSample){0, 0}, RT_TILE * RT_TILE - 1);
    assert_true(last.column == RT_TILE - 1 && last.row == RT_TILE - 1);
}

RT_TESTS(tiles, NULL, NULL)
