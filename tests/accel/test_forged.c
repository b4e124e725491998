/* SPDX-License-Identifier: Apache-2.0 */
/* A plugin may overwrite what its process sends, after that process has checked it: nothing impossible is
 * taken from shared memory. tests/fuzz/processes.c tries arbitrary bytes. */
#include "accel_testing.h"
#include "forged_testing.h"

typedef struct Answers {
    uint8_t bytes[1024];
    size_t size;
} Answers;

/* The next answer: the bytes at `offset` (of the channel, from its status on) become `data`. */
static void add_answer(Answers *answers, size_t offset, const void *data, size_t length) {
    const ForgedAnswer head = {(uint16_t)offset, (uint16_t)length};
    assert_true(answers->size + sizeof head + length <= sizeof answers->bytes);
    memcpy(answers->bytes + answers->size, &head, sizeof head);
    memcpy(answers->bytes + answers->size + sizeof head, data, length);
    answers->size += sizeof head + length;
}

static const RtRay ray = {.org = {{-9, 0, 0}}, .dir = {{1, 0, 0}}, .tmax = INFINITY};

/* Built and queried by answers that change nothing; then the one to the counted ray overwrites its message.
 */
static void trace_overwritten(size_t offset, const void *data, size_t length, RtHit *hit, RtTally *tally,
                              const char *phrase) {
    OWNED_SCENE scene = make_row(1, 1);
    Answers answers = {.size = 0};
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    RtAccel *accel;
    for (int i = 0; i < 2; i++) add_answer(&answers, 0, "", 0);
    add_answer(&answers, FORGED_MESSAGE + offset, data, length);
    add_answer(&answers, 0, "", 0);
    assert_ok(open_forged(&scene, answers.bytes, answers.size, &accel, error));
    RtQuery query = open_query(accel);
    rt_nearest(&query, &ray, 1, hit, tallies);
    *tally = tallies[RT_RAY_PRIMARY];
    if (phrase)
        assert_fails_with(rt_accel_check(accel, error), RT_BROKEN, phrase);
    else
        assert_ok(rt_accel_check(accel, error));
    rt_query_clear(&query);
    close_forged(accel);
}

RT_TEST(counts_as_large_as_a_ray_may_cost_are_taken_and_larger_ones_are_not) {
    const size_t offset = offsetof(Stream, tallies) + offsetof(RtTally, steps);
    const uint64_t most = RT_MAX_LAYERS * (UINT64_C(1) << 32), more = most + 1, below_zero = UINT64_MAX;
    RtHit hit;
    RtTally tally;
    trace_overwritten(offset, &most, sizeof most, &hit, &tally, NULL);
    assert_true(tally.steps == most);
    trace_overwritten(offset, &more, sizeof more, &hit, &tally, "forged: it overwrote its counts");
    assert_int_equal(tally.steps, 0);
    trace_overwritten(offset, &below_zero, sizeof below_zero, &hit, &tally, "it overwrote its counts");
}

RT_TEST(a_hit_is_taken_if_it_is_possible) {
    const RtHit possible = {8, 0};
    const RtHit impossible[] = {{8, 1},           {-1, 0}, {INFINITY, 0}, {NAN, 0}, {NAN, RT_NO_OBJECT},
                                {0, RT_NO_OBJECT}};
    RtHit hit;
    RtTally tally;
    trace_overwritten(offsetof(Stream, hits), &possible, sizeof possible, &hit, &tally, NULL);
    assert_true(hit.t == 8 && hit.object == 0);
    for (size_t i = 0; i < sizeof impossible / sizeof impossible[0]; i++) {
        trace_overwritten(offsetof(Stream, hits), &impossible[i], sizeof impossible[i], &hit, &tally,
                          "it overwrote its answers");
        assert_true(hit.object == RT_NO_OBJECT && isinf(hit.t));
    }
}

RT_TEST(a_description_with_a_number_that_no_structure_has_is_refused) {
    const size_t places[] = {offsetof(Built, description.interior), offsetof(Built, description.depth),
                             offsetof(Built, description.bytes),
                             offsetof(Built, description.build.object_tests)};
    const uint64_t below_zero = (uint64_t)-1;
    const double never = NAN;
    OWNED_SCENE scene = make_row(1, 1);
    RtAccel *accel;
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        Answers answers = {.size = 0};
        add_answer(&answers, FORGED_MESSAGE + places[i], &below_zero, sizeof below_zero);
        assert_fails_with(open_forged(&scene, answers.bytes, answers.size, &accel, error), RT_BROKEN,
                          "forged: it overwrote its description while it was built over 1 object");
    }
    Answers answers = {.size = 0};
    add_answer(&answers, FORGED_MESSAGE + offsetof(Built, seconds), &never, sizeof never);
    assert_fails_with(open_forged(&scene, answers.bytes, answers.size, &accel, error), RT_BROKEN,
                      "description");
}

RT_TEST(a_failure_without_a_reason_still_names_the_accelerator) {
    const RtStatus statuses[] = {RT_BAD_INPUT, RT_BROKEN, (RtStatus)100};
    OWNED_SCENE scene = make_row(1, 1);
    RtAccel *accel;
    for (size_t i = 0; i < sizeof statuses / sizeof statuses[0]; i++) {
        Answers answers = {.size = 0};
        add_answer(&answers, 0, &statuses[i], sizeof statuses[i]);
        assert_fails_at(open_forged(&scene, answers.bytes, answers.size, &accel, error),
                        i ? RT_BROKEN : RT_BAD_INPUT, "forged: ", "it failed and sent no reason");
    }
}

RT_TESTS(forged, NULL, assert_nothing_is_kept)
