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

/* Multiplies by the least common multiple of the denominators over the greatest common divisor of the
 * numerators. */
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

/* Long division of integer polynomials by q, which is not 0: p times a positive number is quotient times q
 * plus the remainder. Returns the remainder, and the quotient if wanted. All intermediate numbers are
 * integers. */
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

/* The greatest common divisor of two polynomials, not both 0. */
static RtPolynomial common_divisor(RtExactArena *arena, const RtPolynomial *p, const RtPolynomial *q) {
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

/* x * 2^by */
static RtRational scaled(RtExactArena *arena, RtRational x, long by) {
    mpq_ptr out = rt_exact_arena_number(arena);
    if (by >= 0)
        mpq_mul_2exp(out, x, (mp_bitcnt_t)by);
    else
        mpq_div_2exp(out, x, (mp_bitcnt_t)-by);
    return out;
}

/* Narrows the interval to lo..hi, which shares at least one end with it. If an end is the root itself, the
 * new interval has the same width with the root in its middle. False if the root is elsewhere. */
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

/* Divides the interval into 2^bits equal parts and tries the one in which the secant is 0. */
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

/* Narrows the interval to at most `width`. Each success of the secant doubles the number of bits. */
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

/* Sturm's chain; the last polynomial is the greatest common divisor of p and p'. */
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

/* A power of two above |t| for all roots t: Fujiwara's bound 2 max |a[n - i] / a[n]|^(1 / i), from numbers
 * of bits. */
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

/* A point between lo and hi that is no root; nor are lo and hi. */
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

/* A root of (t - p)^2 - q^2 d on the side of p given by q's sign, nearer to p than |q| (d + 1). */
static RtAlgebraic algebraic_of_surd(RtExactArena *arena, const RtSurd *surd) {
    RtRational one = rt_exact_of(arena, 1);
    if (rt_exact_sign(surd->q) == 0 || rt_exact_sign(surd->d) == 0)
        return (RtAlgebraic){{1, {rt_exact_neg(arena, surd->p), one}},
                             rt_exact_sub(arena, surd->p, one),
                             rt_exact_add(arena, surd->p, one)};
    RtRational q = surd->q, p = surd->p;
    RtRational square = rt_exact_mul(arena, rt_exact_mul(arena, q, q), surd->d);
    RtRational far = rt_exact_add(arena, p, rt_exact_mul(arena, q, rt_exact_add(arena, surd->d, one)));
    RtPolynomial of = {2,
                       {rt_exact_sub(arena, rt_exact_mul(arena, p, p), square),
                        rt_exact_mul(arena, rt_exact_of(arena, -2), p), one}};
    bool up = rt_exact_sign(q) > 0;
    return (RtAlgebraic){of, up ? p : far, up ? far : p};
}

/* Are the roots equal, given that the intervals overlap? A common root in both intervals is each one's
 * only root. */
static bool same(RtExactArena *arena, const RtAlgebraic *a, const RtAlgebraic *b) {
    RtPolynomial common = common_divisor(arena, &a->of, &b->of);
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

/* Adds 32 bits at a time until the interval is narrower than 2^-66 of its distance from `from`. */
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

/* ---- where a line meets a surface ---- */

RtRoot rt_root_of_surd(const RtSurd *surd) {
    return (RtRoot){.surd = *surd};
}

RtRoot rt_root_of(RtExactArena *arena, RtRational t) {
    return (RtRoot){.surd = rt_surd_of(arena, t)};
}

RtRoot rt_root_of_algebraic(const RtAlgebraic *algebraic) {
    return (RtRoot){.algebraic = *algebraic};
}

static bool is_surd(const RtRoot *root) {
    return root->algebraic.of.degree == 0;
}

/* The surd is nearly always outside the interval, which is cheap to see. */
static int compare_mixed(RtExactArena *arena, const RtAlgebraic *algebraic, const RtSurd *surd) {
    size_t mark = rt_exact_arena_mark(arena);
    RtSurd lo = rt_surd_of(arena, algebraic->lo), hi = rt_surd_of(arena, algebraic->hi);
    int order;
    if (rt_surd_compare(arena, surd, &lo) <= 0) {
        order = 1;
    } else if (rt_surd_compare(arena, surd, &hi) >= 0) {
        order = -1;
    } else {
        RtAlgebraic other = algebraic_of_surd(arena, surd);
        order = rt_algebraic_compare(arena, algebraic, &other);
    }
    rt_exact_arena_rewind(arena, mark);
    return order;
}

int rt_root_compare(RtExactArena *arena, const RtRoot *a, const RtRoot *b) {
    if (is_surd(a) && is_surd(b)) return rt_surd_compare(arena, &a->surd, &b->surd);
    if (is_surd(b)) return compare_mixed(arena, &a->algebraic, &b->surd);
    if (is_surd(a)) return -compare_mixed(arena, &b->algebraic, &a->surd);
    return rt_algebraic_compare(arena, &a->algebraic, &b->algebraic);
}

long double rt_root_value(RtExactArena *arena, const RtRoot *root, RtRational from) {
    if (!is_surd(root)) return rt_algebraic_value(arena, &root->algebraic, from);
    size_t mark = rt_exact_arena_mark(arena);
    RtSurd apart = root->surd;
    apart.p = rt_exact_sub(arena, apart.p, from);
    long double value = rt_surd_value(arena, &apart);
    rt_exact_arena_rewind(arena, mark);
    return value;
}
