/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/place.h"

RtPlace rt_place_of_surd(const RtSurd *surd) {
    return (RtPlace){.surd = *surd};
}

RtPlace rt_place_of(RtExactArena *arena, RtRational t) {
    return (RtPlace){.surd = rt_surd_of(arena, t)};
}

RtPlace rt_place_of_root(const RtAlgebraic *root) {
    return (RtPlace){.root = *root};
}

static bool is_surd(const RtPlace *place) {
    return place->root.of.degree == 0;
}

/* A surd is nearly always outside of the interval, which takes no root to see. */
static int compare_root(RtExactArena *arena, const RtAlgebraic *root, const RtSurd *surd) {
    size_t mark = rt_exact_arena_mark(arena);
    RtSurd lo = rt_surd_of(arena, root->lo), hi = rt_surd_of(arena, root->hi);
    int order;
    if (rt_surd_compare(arena, surd, &lo) <= 0) {
        order = 1;
    } else if (rt_surd_compare(arena, surd, &hi) >= 0) {
        order = -1;
    } else {
        RtAlgebraic other = rt_algebraic_of_surd(arena, surd);
        order = rt_algebraic_compare(arena, root, &other);
    }
    rt_exact_arena_rewind(arena, mark);
    return order;
}

int rt_place_compare(RtExactArena *arena, const RtPlace *a, const RtPlace *b) {
    if (is_surd(a) && is_surd(b)) return rt_surd_compare(arena, &a->surd, &b->surd);
    if (is_surd(b)) return compare_root(arena, &a->root, &b->surd);
    if (is_surd(a)) return -compare_root(arena, &b->root, &a->surd);
    return rt_algebraic_compare(arena, &a->root, &b->root);
}

long double rt_place_value(RtExactArena *arena, const RtPlace *place, RtRational from) {
    if (!is_surd(place)) return rt_algebraic_value(arena, &place->root, from);
    size_t mark = rt_exact_arena_mark(arena);
    RtSurd apart = place->surd;
    apart.p = rt_exact_sub(arena, apart.p, from);
    long double value = rt_surd_value(arena, &apart);
    rt_exact_arena_rewind(arena, mark);
    return value;
}
