/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/algebraic.h"

/* ---- polynomials ---- */

static RtRational value_at(RtExactArena *arena, const RtPolynomial *p, RtRational t) {
    RtRational sum = p->at[p->degree];
    for (int i = p->degree - 1; i >= 0; i--) sum = rt_exact_add(arena, rt_exact_mul(arena, sum, t), p->at[i]);
    return sum;
}

int rt_polynomial_sign(RtExactArena *arena, const RtPolynomial *p, RtRational t) {
    size_t mark = rt_exact_arena_mark(arena);
    int sign = rt_exact_sign(value_at(arena, p, t));
    rt_exact_arena_rewind(arena, mark);
    return sign;
}

/* Times the least common multiple of the denominators, by the greatest common divisor of the numerators. */
static RtPolynomial shortened(RtExactArena *arena, RtPolynomial p) {
    if (p.degree < 0) return p;
    mpq_ptr factor = rt_exact_arena_number(arena);
    mpz_set_ui(mpq_numref(factor), 1);
    mpz_set_ui(mpq_denref(factor), 0);
    for (int i = 0; i <= p.degree; i++) {
        mpz_lcm(mpq_numref(factor), mpq_numref(factor), mpq_denref(p.at[i]));
        mpz_gcd(mpq_denref(factor), mpq_denref(factor), mpq_numref(p.at[i]));
    }
    mpq_canonicalize(factor);
    for (int i = 0; i <= p.degree; i++) p.at[i] = rt_exact_mul(arena, p.at[i], factor);
    return p;
}

static RtPolynomial derivative(RtExactArena *arena, const RtPolynomial *p) {
    RtPolynomial out = {.degree = p->degree > 0 ? p->degree - 1 : -1};
    for (int i = 1; i <= p->degree; i++) out.at[i - 1] = rt_exact_mul(arena, rt_exact_of(arena, i), p->at[i]);
    return out;
}

/* Long division by q, which is not 0, of numbers that are integers: p, times a number above 0, is quotient
 * times q and the remainder, which is given; the quotient too, if wanted. No step leaves the integers. */
static RtPolynomial divided(RtExactArena *arena, RtPolynomial p, const RtPolynomial *q,
                            RtPolynomial *quotient) {
    RtPolynomial parts = {.degree = p.degree - q->degree};
    RtRational lead = q->at[q->degree];
    if (rt_exact_sign(lead) < 0) lead = rt_exact_neg(arena, lead);
    for (int k = parts.degree; k >= 0; k--) {
        RtRational part = p.at[k + q->degree];
        if (lead != q->at[q->degree]) part = rt_exact_neg(arena, part);
        for (int i = 0; i < k + q->degree; i++) {
            p.at[i] = rt_exact_mul(arena, p.at[i], lead);
            if (i >= k) p.at[i] = rt_exact_sub(arena, p.at[i], rt_exact_mul(arena, part, q->at[i - k]));
        }
        for (int i = k + 1; i <= parts.degree; i++) parts.at[i] = rt_exact_mul(arena, parts.at[i], lead);
        parts.at[k] = part;
    }
    if (p.degree >= q->degree) p.degree = q->degree - 1;
    while (p.degree >= 0 && rt_exact_sign(p.at[p.degree]) == 0) p.degree--;
    if (quotient) *quotient = shortened(arena, parts);
    return shortened(arena, p);
}

RtPolynomial rt_polynomial_common(RtExactArena *arena, const RtPolynomial *p, const RtPolynomial *q) {
    RtPolynomial a = shortened(arena, *p), b = shortened(arena, *q);
    while (b.degree >= 0) {
        RtPolynomial rest = divided(arena, a, &b, NULL);
        a = b;
        b = rest;
    }
    return a;
}

/* ---- narrowing ---- */

static RtRational width_of(RtExactArena *arena, const RtAlgebraic *a) {
    return rt_exact_sub(arena, a->hi, a->lo);
}

/* x 2^by */
static RtRational scaled(RtExactArena *arena, RtRational x, long by) {
    mpq_ptr out = rt_exact_arena_number(arena);
    if (by >= 0) {
        mpq_mul_2exp(out, x, (mp_bitcnt_t)by);
    } else {
        mpq_div_2exp(out, x, (mp_bitcnt_t)-by);
    }
    return out;
}

/* Cuts the interval down to lo..hi, of which one end at most is one of the old interval's; where the other is
 * the root itself, to as much with the root in its middle. False where the root is elsewhere. */
static bool cut_down(RtExactArena *arena, RtAlgebraic *a, RtRational lo, RtRational hi) {
    int below = rt_polynomial_sign(arena, &a->of, lo), above = rt_polynomial_sign(arena, &a->of, hi);
    if (below * above > 0) return false;
    if (below * above == 0) {
        RtRational root = below == 0 ? lo : hi;
        RtRational half = scaled(arena, rt_exact_sub(arena, hi, lo), -1);
        lo = rt_exact_sub(arena, root, half);
        hi = rt_exact_add(arena, root, half);
    }
    a->lo = lo;
    a->hi = hi;
    return true;
}

/* Of 2^bits equal parts of the interval tries the one in which the secant is 0. */
static bool try_secant(RtExactArena *arena, RtAlgebraic *a, unsigned bits) {
    RtRational at_lo = value_at(arena, &a->of, a->lo), at_hi = value_at(arena, &a->of, a->hi);
    RtRational span = rt_exact_sub(arena, at_lo, at_hi);
    mpq_ptr number = rt_exact_arena_number(arena); /* of the part, 0..2^bits - 1 */
    mpz_mul(mpq_numref(number), mpq_numref(at_lo), mpq_denref(span));
    mpz_mul_2exp(mpq_numref(number), mpq_numref(number), bits);
    mpz_mul(mpq_denref(number), mpq_numref(span), mpq_denref(at_lo));
    mpz_fdiv_q(mpq_numref(number), mpq_numref(number), mpq_denref(number));
    mpz_set_ui(mpq_denref(number), 1);
    RtRational part = scaled(arena, width_of(arena, a), -(long)bits);
    RtRational lo = rt_exact_add(arena, a->lo, rt_exact_mul(arena, number, part));
    return cut_down(arena, a, lo, rt_exact_add(arena, lo, part));
}

/* Until the interval is no wider than `width`. A secant that is right is trusted with twice as many bits. */
static void narrow(RtExactArena *arena, RtAlgebraic *a, RtRational width) {
    unsigned bits = 1;
    while (mpq_cmp(width_of(arena, a), width) > 0) {
        if (try_secant(arena, a, bits)) {
            bits *= 2;
            continue;
        }
        RtRational middle = scaled(arena, rt_exact_add(arena, a->lo, a->hi), -1);
        if (!cut_down(arena, a, a->lo, middle)) a->lo = middle;
        if (bits > 1) bits /= 2;
    }
}

/* ---- roots ---- */

/* Sturm's; the last is the greatest common divisor of p and p'. */
typedef struct Chain {
    int count;
    RtPolynomial at[RT_MAX_DEGREE + 1];
} Chain;

static Chain chain_of(RtExactArena *arena, const RtPolynomial *p) {
    Chain chain = {.count = 1, .at = {*p}};
    RtPolynomial next = derivative(arena, p);
    while (next.degree >= 0) {
        chain.at[chain.count++] = next;
        next = divided(arena, chain.at[chain.count - 2], &next, NULL);
        for (int i = 0; i <= next.degree; i++) next.at[i] = rt_exact_neg(arena, next.at[i]);
    }
    return chain;
}

static int sign_changes(RtExactArena *arena, const Chain *chain, RtRational t) {
    int changes = 0, last = 0;
    for (int i = 0; i < chain->count; i++) {
        int sign = rt_polynomial_sign(arena, &chain->at[i], t);
        changes += sign * last < 0;
        if (sign != 0) last = sign;
    }
    return changes;
}

/* A power of two above |t| of all roots t: Fujiwara's 2 max |a[n - i] / a[n]|^(1 / i), by numbers of bits. */
static RtRational bound_of(RtExactArena *arena, const RtPolynomial *p) {
    const long top = (long)mpz_sizeinbase(mpq_numref(p->at[p->degree]), 2);
    long most = -(1L << 40);
    for (int i = 1; i <= p->degree; i++) {
        RtRational a = p->at[p->degree - i];
        long bits = (long)mpz_sizeinbase(mpq_numref(a), 2) - top + 1;
        long each = bits >= 0 ? (bits + i - 1) / i : -(-bits / i);
        if (rt_exact_sign(a) != 0 && each > most) most = each;
    }
    return most == -(1L << 40) ? rt_exact_of(arena, 1) : scaled(arena, rt_exact_of(arena, 1), most + 2);
}

/* Between lo and hi, and no root; they are none either. */
static RtRational point_between(RtExactArena *arena, const RtPolynomial *p, RtRational lo, RtRational hi) {
    do lo = scaled(arena, rt_exact_add(arena, lo, hi), -1);
    while (rt_polynomial_sign(arena, p, lo) == 0);
    return lo;
}

int rt_polynomial_roots(RtExactArena *arena, const RtPolynomial *p, RtAlgebraic roots[RT_MAX_DEGREE]) {
    RtPolynomial of = shortened(arena, *p);
    Chain chain = chain_of(arena, &of);
    const RtPolynomial twice = chain.at[chain.count - 1];
    if (twice.degree > 0) {
        divided(arena, of, &twice, &of);
        chain = chain_of(arena, &of);
    }
    RtRational end = bound_of(arena, &of), lo = rt_exact_neg(arena, end);
    int before = sign_changes(arena, &chain, lo), count = before - sign_changes(arena, &chain, end);
    for (int k = 0; k < count; k++) {
        RtRational hi = end;
        /* k roots are below lo, more than k below hi */
        for (int below = count; below > k + 1;) {
            RtRational middle = point_between(arena, &of, lo, hi);
            int found = before - sign_changes(arena, &chain, middle);
            if (found > k) {
                hi = middle;
                below = found;
            } else {
                lo = middle;
            }
        }
        roots[k] = (RtAlgebraic){of, lo, hi};
        narrow(arena, &roots[k], scaled(arena, end, -64));
        lo = hi;
    }
    return count;
}

/* ---- numbers ---- */

/* A root of (t - p)^2 - q^2 d, on the side of p that q is on, and nearer to it than |q| (d + 1). */
RtAlgebraic rt_algebraic_of_surd(RtExactArena *arena, const RtSurd *surd) {
    RtRational one = rt_exact_of(arena, 1);
    if (rt_exact_sign(surd->q) == 0 || rt_exact_sign(surd->d) == 0) {
        return (RtAlgebraic){{1, {rt_exact_neg(arena, surd->p), one}},
                             rt_exact_sub(arena, surd->p, one),
                             rt_exact_add(arena, surd->p, one)};
    }
    RtRational q = surd->q, p = surd->p;
    RtRational square = rt_exact_mul(arena, rt_exact_mul(arena, q, q), surd->d);
    RtRational far = rt_exact_add(arena, p, rt_exact_mul(arena, q, rt_exact_add(arena, surd->d, one)));
    RtPolynomial of = {2,
                       {rt_exact_sub(arena, rt_exact_mul(arena, p, p), square),
                        rt_exact_mul(arena, rt_exact_of(arena, -2), p), one}};
    bool up = rt_exact_sign(q) > 0;
    return (RtAlgebraic){of, up ? p : far, up ? far : p};
}

/* Is it the same root, given that the intervals overlap? A common root in both is the one of each. */
static bool same(RtExactArena *arena, const RtAlgebraic *a, const RtAlgebraic *b) {
    RtPolynomial common = rt_polynomial_common(arena, &a->of, &b->of);
    RtRational lo = mpq_cmp(a->lo, b->lo) > 0 ? a->lo : b->lo;
    RtRational hi = mpq_cmp(a->hi, b->hi) < 0 ? a->hi : b->hi;
    return common.degree > 0 &&
           rt_polynomial_sign(arena, &common, lo) != rt_polynomial_sign(arena, &common, hi);
}

int rt_algebraic_compare(RtExactArena *arena, const RtAlgebraic *a, const RtAlgebraic *b) {
    size_t mark = rt_exact_arena_mark(arena);
    RtAlgebraic x = *a, y = *b;
    bool differ = false;
    int order = 0;
    for (;;) {
        if (mpq_cmp(x.hi, y.lo) <= 0) order = -1;
        if (mpq_cmp(y.hi, x.lo) <= 0) order = 1;
        if (order != 0 || (!differ && same(arena, &x, &y))) break;
        differ = true;
        narrow(arena, &x, scaled(arena, width_of(arena, &x), -16));
        narrow(arena, &y, scaled(arena, width_of(arena, &y), -16));
    }
    rt_exact_arena_rewind(arena, mark);
    return order;
}

/* With 32 bits more each time, until the interval is narrower than 2^-66 of how far it is from `from`. */
long double rt_algebraic_value(RtExactArena *arena, const RtAlgebraic *a, RtRational from) {
    size_t mark = rt_exact_arena_mark(arena);
    RtAlgebraic x = *a;
    long double value = 0;
    bool inside = mpq_cmp(x.lo, from) < 0 && mpq_cmp(from, x.hi) < 0;
    bool zero = inside && rt_polynomial_sign(arena, &x.of, from) == 0;
    while (!zero) {
        RtRational lo = rt_exact_sub(arena, x.lo, from), hi = rt_exact_sub(arena, x.hi, from);
        mpq_ptr least = rt_exact_arena_number(arena);
        mpq_abs(least, rt_exact_sign(lo) > 0 ? lo : hi);
        RtRational width = width_of(arena, &x);
        if (rt_exact_sign(lo) * rt_exact_sign(hi) > 0 && mpq_cmp(width, scaled(arena, least, -66)) <= 0) {
            value = rt_exact_value(lo);
            break;
        }
        narrow(arena, &x, scaled(arena, width, -32));
    }
    rt_exact_arena_rewind(arena, mark);
    return value;
}
