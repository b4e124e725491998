/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/verdict.h"

#include "accel/accel.h"

const char *rt_verdict_name(RtVerdict verdict) {
    static const char *const names[RT_VERDICT_COUNT] = {"equal", "tie", "marginal", "wrong"};
    return names[verdict];
}

const char *rt_fault_name(RtFault fault) {
    static const char *const names[RT_FAULT_COUNT] = {
#define RT_FAULT_NAME(CONSTANT, name, meaning) #name,
        RT_FAULTS(RT_FAULT_NAME)
#undef RT_FAULT_NAME
    };
    return names[fault];
}

/* ---- all objects ---- */

/* The margins of all objects on a ray. */
typedef struct Margins {
    uint32_t except;        /* is left out */
    bool possible;          /* any object is */
    uint32_t first_certain; /* the certain object with the least `latest`, or RT_NO_OBJECT */
    double latest;
    /* The least and the next `earliest` of possible objects, HUGE_VAL without one. */
    uint32_t first_possible;
    double earliest, next_earliest;
} Margins;

static void add(void *context, uint32_t id, const RtMargin *m) {
    Margins *all = context;
    if (id == all->except) return;
    all->possible = true;
    if (m->certain && m->latest < all->latest) {
        all->first_certain = id;
        all->latest = m->latest;
    }
    if (m->earliest < all->earliest) {
        all->next_earliest = all->earliest;
        all->earliest = m->earliest;
        all->first_possible = id;
    } else if (m->earliest < all->next_earliest) {
        all->next_earliest = m->earliest;
    }
}

/* The margins of all objects but `except`. */
static RtStatus margins(const RtJudge *judge, uint32_t except, Margins *all, RtError *error) {
    *all = (Margins){.except = except,
                     .first_certain = RT_NO_OBJECT,
                     .latest = HUGE_VAL,
                     .first_possible = RT_NO_OBJECT,
                     .earliest = HUGE_VAL,
                     .next_earliest = HUGE_VAL};
    return rt_margin_of_all(&judge->margin, judge->geometry, NAN, add, all, error);
}

RtStatus rt_verdict_certain(RtJudge judge, bool *certain, bool *must_hit, RtError *error) {
    Margins all;
    RT_TRY(margins(&judge, RT_NO_OBJECT, &all, error));
    *must_hit = all.first_certain != RT_NO_OBJECT;
    double others = all.first_certain == all.first_possible ? all.next_earliest : all.earliest;
    *certain = !all.possible || (*must_hit && all.latest < others);
    return RT_OK;
}

/* ---- verdicts ---- */

/* delta / |dir| of the object that an answer names; 0 if it names none. */
static double tolerance_of(const RtJudge *judge, RtHit hit) {
    if (hit.object >= rt_geometry_id_count(judge->geometry)) return 0;
    return rt_margin_delta(&judge->margin, judge->geometry, hit.object) / judge->margin.line.length;
}

static RtStatus lack_memory(RtError *error) {
    return rt_fail_memory(error, "exact arithmetic on a CSG tree", 0);
}

/* Does the ray exactly meet both objects, at almost the same t? */
static RtStatus is_tie(RtJudge judge, RtHit expected, RtHit answer, bool *tie, RtError *error) {
    int order;
    long double apart;
    double tolerance = fmin(tolerance_of(&judge, expected), tolerance_of(&judge, answer));
    *tie = false;
    if (!(fabs((double)answer.t - (double)expected.t) <= 2 * tolerance)) return RT_OK;
    RtExactResult result =
        rt_referee_order(judge.geometry, expected.object, answer.object, judge.ray, &order, &apart);
    if (result == RT_UNDECIDED) return lack_memory(error);
    *tie = result == RT_HIT && apart <= (long double)tolerance;
    return RT_OK;
}

RtStatus rt_verdict_side(RtJudge judge, RtHit expected, RtHit answer, RtSide *side, RtError *error) {
    double tolerance = fmax(tolerance_of(&judge, expected), tolerance_of(&judge, answer));
    *side = rt_referee_judge(judge.geometry, judge.ray, expected, answer, tolerance).side;
    return *side == RT_SIDE_UNDECIDED ? lack_memory(error) : RT_OK;
}

/* Keeps the first object that may be hit there. */
static void name_first(void *context, uint32_t id, const RtMargin *m) {
    uint32_t *name = context;
    if (m->holds && *name == RT_UNNAMED_OBJECT) *name = id;
}

RtStatus rt_verdict_name_object(RtJudge judge, RtHit expected, RtHit *answer, RtError *error) {
    const bool known = expected.object < rt_geometry_id_count(judge.geometry);
    const double asked = (double)answer->t * judge.margin.line.length;
    RtMargin own = {.holds = false};
    if (answer->object != RT_UNNAMED_OBJECT) return RT_OK;
    if (known) RT_TRY(rt_margin_of(&judge.margin, judge.geometry, expected.object, asked, &own, error));
    if (!own.holds)
        RT_TRY(rt_margin_of_all(&judge.margin, judge.geometry, asked, name_first, &answer->object, error));
    if (known && answer->object == RT_UNNAMED_OBJECT) answer->object = expected.object;
    return RT_OK;
}

RtStatus rt_verdict_nearest(RtJudge judge, RtHit expected, RtHit answer, RtVerdict *verdict, RtError *error) {
    const bool miss = answer.object == RT_NO_OBJECT;
    const double asked = (double)answer.t * judge.margin.line.length;
    RtMargin own;
    Margins others;
    *verdict = RT_EQUAL;
    if (miss && expected.object == RT_NO_OBJECT) return RT_OK;
    *verdict = RT_WRONG;
    if (!miss) {
        if (answer.object >= rt_geometry_id_count(judge.geometry)) return RT_OK;
        RT_TRY(rt_margin_of(&judge.margin, judge.geometry, answer.object, asked, &own, error));
        if (!own.holds) return RT_OK;
    }
    const bool same = answer.object == expected.object, both = !miss && expected.object != RT_NO_OBJECT;
    const double at = (double)expected.t * judge.margin.line.length;
    bool tie = false;
    if (both && !same) RT_TRY(is_tie(judge, expected, answer, &tie, error));
    *verdict = tie ? RT_TIE : both && same && at >= own.lo && at <= own.hi ? RT_EQUAL : RT_MARGINAL;
    /* Nothing fits between t's that are a few ulps apart; otherwise something may be hit before. */
    if (*verdict != RT_MARGINAL && fabs(asked - at) <= 0x1p-21 * fabs(at)) return RT_OK;
    RT_TRY(margins(&judge, answer.object, &others, error));
    if (others.first_certain != RT_NO_OBJECT && (miss || asked > others.latest)) *verdict = RT_WRONG;
    return RT_OK;
}

RtStatus rt_verdict_fault(RtJudge judge, RtHit answer, RtFault *fault, RtError *error) {
    RtMargin own = {0};
    *fault = RT_FAULT_LOST;
    if (answer.object == RT_NO_OBJECT) return RT_OK;
    if (answer.object < rt_geometry_id_count(judge.geometry))
        RT_TRY(rt_margin_of(&judge.margin, judge.geometry, answer.object,
                            (double)answer.t * judge.margin.line.length, &own, error));
    *fault = own.holds      ? RT_FAULT_BEHIND
             : own.edge_on  ? RT_FAULT_EDGE_ON
             : own.possible ? RT_FAULT_DISPLACED
                            : RT_FAULT_BESIDE;
    return RT_OK;
}

RtStatus rt_verdict_occluded(RtJudge judge, bool expected, bool answer, RtVerdict *verdict, RtError *error) {
    Margins all;
    *verdict = RT_EQUAL;
    if (answer == expected) return RT_OK;
    RT_TRY(margins(&judge, RT_NO_OBJECT, &all, error));
    bool right = answer ? all.possible : all.first_certain == RT_NO_OBJECT;
    *verdict = right ? RT_MARGINAL : RT_WRONG;
    return RT_OK;
}
