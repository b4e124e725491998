#include "exact/place.h"

RtPlace rt_place_of_surd(const RtSurd *surd) {
    return (RtPlace){.surd = *surd};
}

RtPlace rt_place_of(RtSlate *slate, RtRational t) {
    return (RtPlace){.surd = rt_surd_of(slate, t)};
}

RtPlace rt_place_of_root(const RtAlgebraic *root) {
    return (RtPlace){.root = *root};
}

static bool is_surd(const RtPlace *place) {
    return place->root.of.degree == 0;
}

/* A surd is nearly always outside of the interval, which takes no root to see. */
static int compare_root(RtSlate *slate, const RtAlgebraic *root, const RtSurd *surd) {
    size_t mark = rt_slate_mark(slate);
    RtSurd lo = rt_surd_of(slate, root->lo), hi = rt_surd_of(slate, root->hi);
    int order;
    if (rt_surd_compare(slate, surd, &lo) <= 0) {
        order = 1;
    } else if (rt_surd_compare(slate, surd, &hi) >= 0) {
        order = -1;
    } else {
        RtAlgebraic other = rt_algebraic_of_surd(slate, surd);
        order = rt_algebraic_compare(slate, root, &other);
    }
    rt_slate_wipe(slate, mark);
    return order;
}

int rt_place_compare(RtSlate *slate, const RtPlace *a, const RtPlace *b) {
    if (is_surd(a) && is_surd(b)) return rt_surd_compare(slate, &a->surd, &b->surd);
    if (is_surd(b)) return compare_root(slate, &a->root, &b->surd);
    if (is_surd(a)) return -compare_root(slate, &b->root, &a->surd);
    return rt_algebraic_compare(slate, &a->root, &b->root);
}

long double rt_place_value(RtSlate *slate, const RtPlace *place, RtRational from) {
    if (!is_surd(place)) return rt_algebraic_value(slate, &place->root, from);
    size_t mark = rt_slate_mark(slate);
    RtSurd apart = place->surd;
    apart.p = rt_exact_sub(slate, apart.p, from);
    long double value = rt_surd_value(slate, &apart);
    rt_slate_wipe(slate, mark);
    return value;
}
