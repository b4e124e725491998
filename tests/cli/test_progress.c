/* SPDX-License-Identifier: Apache-2.0 */
/* What a long command says while it runs, on a terminal and where there is none. */
#include "experiment_testing.h"

#include "cli/cli.h"

#include <fcntl.h>
#include <stdatomic.h>
#include <time.h>

/* The clock of everything that is linked into this program stands still but for said(). */
static _Atomic int milliseconds;
int __wrap_clock_gettime(clockid_t clock, struct timespec *now);

int __wrap_clock_gettime(clockid_t clock, struct timespec *now) {
    (void)clock;
    *now = (struct timespec){milliseconds / 1000, milliseconds % 1000 * 1000000L};
    return 0;
}

static int make_places(void **state) {
    if (make_place(state) != 0) return -1;
    write_in(*state, "small.yaml",
             "name: small\nquestion: a\nprediction: b\nscenes: [{scene: \"balls:size=1\"}]\n"
             "accelerators: [{accel: bvh}, {accel: grid}]\nrays: [primary]\n");
    return 0;
}

/* Tells progress in each of some milliseconds that something was finished; what it says, for rt_free. */
static char *said(const Place *place, RtEventKind what, bool terminal, double every, int duration) {
    OWNED_RESULTS results;
    RtWorkloadOptions options = {.threads = 1, .timing = 1};
    const char *path = path_in(place, "said").text;
    int file = open(path, O_RDWR | O_CREAT | O_TRUNC, 0666), stderr_was = dup(STDERR_FILENO);
    assert_ok(load_small(place, false, error));
    assert_ok(rt_results_init(&results, place->experiment, error));
    RtProgress progress;
    rt_progress_begin(&progress, &options);
    progress.terminal = terminal;
    progress.every = every;
    const RtRunObserver observer = options.observer;
    assert_true(file >= 0 && stderr_was >= 0);
    dup2(file, STDERR_FILENO);
    for (int end = milliseconds + duration; milliseconds < end; milliseconds++) {
        RtEvent event = {.what = what, .candidate = 1};
        assert_int_equal(observer.event(observer.context, &results, &event, NULL), RT_OK);
    }
    rt_progress_end(&progress);
    dup2(stderr_was, STDERR_FILENO);
    close(stderr_was);
    close(file);
    return read_in(place, "said");
}

PLACE_TEST(without_a_terminal_a_line_comes_as_often_as_it_may_and_no_more) {
    char *text = said(place, RT_EVENT_BUILD, false, 0.2, 900);
    int lines = count_of(text, "\n");
    assert_int_equal(lines, 4);
    assert_int_equal(count_of(text, "raytally: 0 of 2 cells, balls:size=1 grid: built\n"), lines);
    assert_int_equal(count_of(text, "\r"), 0);
    rt_free(text);
    text = said(place, RT_EVENT_BUILD, false, 60, 30000);
    assert_string_equal(text, "");
    rt_free(text);
}

PLACE_TEST(whatever_was_finished_has_a_word) {
    for (int what = RT_EVENT_WORKLOAD; what <= RT_EVENT_NO_CELL; what++) {
        OWNED_MEMORY char *text = said(place, (RtEventKind)what, false, 0.2, 300);
        assert_non_null(strstr(text, ": "));
        assert_null(strstr(text, "(null)"));
    }
}

PLACE_TEST(on_a_terminal_one_line_is_drawn_in_place_and_taken_away) {
    OWNED_MEMORY char *text = said(place, RT_EVENT_BUILD, true, 1, 100);
    const char *const away = "\r\033[K";
    size_t length = strlen(text);
    assert_int_equal(count_of(text, "\n"), 0);
    assert_int_equal(count_of(text, "\r\033[K[0/2] balls:size=1 grid: built"), 100);
    assert_true(length > strlen(away));
    assert_string_equal(text + length - strlen(away), away);
}

RT_TESTS(progress, NULL, NULL)
