#include "exact/algebraic.h"

/* ---- polynomials ---- */

static RtRational value_at(RtSlate *slate, const RtPolynomial *p, RtRational t) {
    RtRational sum = p->at[p->degree];
    for (int i = p->degree - 1; i >= 0; i--) sum = rt_exact_add(slate, rt_exact_mul(slate, sum, t), p->at[i]);
    return sum;
}

int rt_polynomial_sign(RtSlate *slate, const RtPolynomial *p, RtRational t) {
    size_t mark = rt_slate_mark(slate);
    int sign = rt_exact_sign(value_at(slate, p, t));
    rt_slate_wipe(slate, mark);
    return sign;
}

/* Times the least common multiple of the denominators, by the greatest common divisor of the numerators. */
static RtPolynomial shortened(RtSlate *slate, RtPolynomial p) {
    if (p.degree < 0) return p;
    mpq_ptr factor = rt_slate_number(slate);
    mpz_set_ui(mpq_numref(factor), 1);
    mpz_set_ui(mpq_denref(factor), 0);
    for (int i = 0; i <= p.degree; i++) {
        mpz_lcm(mpq_numref(factor), mpq_numref(factor), mpq_denref(p.at[i]));
        mpz_gcd(mpq_denref(factor), mpq_denref(factor), mpq_numref(p.at[i]));
    }
    mpq_canonicalize(factor);
    for (int i = 0; i <= p.degree; i++) p.at[i] = rt_exact_mul(slate, p.at[i], factor);
    return p;
}

static RtPolynomial derivative(RtSlate *slate, const RtPolynomial *p) {
    RtPolynomial out = {.degree = p->degree > 0 ? p->degree - 1 : -1};
    for (int i = 1; i <= p->degree; i++) out.at[i - 1] = rt_exact_mul(slate, rt_exact_of(slate, i), p->at[i]);
    return out;
}

/* Long division by q, which is not 0, of numbers that are integers: p, times a number above 0, is quotient
 * times q and the remainder, which is given; the quotient too, if wanted. No step leaves the integers. */
static RtPolynomial divided(RtSlate *slate, RtPolynomial p, const RtPolynomial *q, RtPolynomial *quotient) {
    RtPolynomial parts = {.degree = p.degree - q->degree};
    RtRational lead = q->at[q->degree];
    if (rt_exact_sign(lead) < 0) lead = rt_exact_neg(slate, lead);
    for (int k = parts.degree; k >= 0; k--) {
        RtRational part = p.at[k + q->degree];
        if (lead != q->at[q->degree]) part = rt_exact_neg(slate, part);
        for (int i = 0; i < k + q->degree; i++) {
            p.at[i] = rt_exact_mul(slate, p.at[i], lead);
            if (i >= k) p.at[i] = rt_exact_sub(slate, p.at[i], rt_exact_mul(slate, part, q->at[i - k]));
        }
        for (int i = k + 1; i <= parts.degree; i++) parts.at[i] = rt_exact_mul(slate, parts.at[i], lead);
        parts.at[k] = part;
    }
    if (p.degree >= q->degree) p.degree = q->degree - 1;
    while (p.degree >= 0 && rt_exact_sign(p.at[p.degree]) == 0) p.degree--;
    if (quotient) *quotient = shortened(slate, parts);
    return shortened(slate, p);
}

RtPolynomial rt_polynomial_common(RtSlate *slate, const RtPolynomial *p, const RtPolynomial *q) {
    RtPolynomial a = shortened(slate, *p), b = shortened(slate, *q);
    while (b.degree >= 0) {
        RtPolynomial rest = divided(slate, a, &b, NULL);
        a = b;
        b = rest;
    }
    return a;
}

/* ---- narrowing ---- */

static RtRational width_of(RtSlate *slate, const RtAlgebraic *a) {
    return rt_exact_sub(slate, a->hi, a->lo);
}

/* x 2^by */
static RtRational scaled(RtSlate *slate, RtRational x, long by) {
    mpq_ptr out = rt_slate_number(slate);
    if (by >= 0) {
        mpq_mul_2exp(out, x, (mp_bitcnt_t)by);
    } else {
        mpq_div_2exp(out, x, (mp_bitcnt_t)-by);
    }
    return out;
}

/* Cuts the interval down to lo..hi, of which one end at most is one of the old interval's; where the other is
 * the root itself, to as much with the root in its middle. False where the root is elsewhere. */
static bool cut_down(RtSlate *slate, RtAlgebraic *a, RtRational lo, RtRational hi) {
    int below = rt_polynomial_sign(slate, &a->of, lo), above = rt_polynomial_sign(slate, &a->of, hi);
    if (below * above > 0) return false;
    if (below * above == 0) {
        RtRational root = below == 0 ? lo : hi;
        RtRational half = scaled(slate, rt_exact_sub(slate, hi, lo), -1);
        lo = rt_exact_sub(slate, root, half);
        hi = rt_exact_add(slate, root, half);
    }
    a->lo = lo;
    a->hi = hi;
    return true;
}

/* Of 2^bits equal parts of the interval tries the one in which the secant is 0. */
static bool try_secant(RtSlate *slate, RtAlgebraic *a, unsigned bits) {
    RtRational at_lo = value_at(slate, &a->of, a->lo), at_hi = value_at(slate, &a->of, a->hi);
    RtRational span = rt_exact_sub(slate, at_lo, at_hi);
    mpq_ptr number = rt_slate_number(slate); /* of the part, 0..2^bits - 1 */
    mpz_mul(mpq_numref(number), mpq_numref(at_lo), mpq_denref(span));
    mpz_mul_2exp(mpq_numref(number), mpq_numref(number), bits);
    mpz_mul(mpq_denref(number), mpq_numref(span), mpq_denref(at_lo));
    mpz_fdiv_q(mpq_numref(number), mpq_numref(number), mpq_denref(number));
    mpz_set_ui(mpq_denref(number), 1);
    RtRational part = scaled(slate, width_of(slate, a), -(long)bits);
    RtRational lo = rt_exact_add(slate, a->lo, rt_exact_mul(slate, number, part));
    return cut_down(slate, a, lo, rt_exact_add(slate, lo, part));
}

/* Until the interval is no wider than `width`. A secant that is right is trusted with twice as many bits. */
static void narrow(RtSlate *slate, RtAlgebraic *a, RtRational width) {
    unsigned bits = 1;
    while (mpq_cmp(width_of(slate, a), width) > 0) {
        if (try_secant(slate, a, bits)) {
            bits *= 2;
            continue;
        }
        RtRational middle = scaled(slate, rt_exact_add(slate, a->lo, a->hi), -1);
        if (!cut_down(slate, a, a->lo, middle)) a->lo = middle;
        if (bits > 1) bits /= 2;
    }
}

/* ---- roots ---- */

/* Sturm's; the last is the greatest common divisor of p and p'. */
typedef struct Chain {
    int count;
    RtPolynomial at[RT_MAX_DEGREE + 1];
} Chain;

static Chain chain_of(RtSlate *slate, const RtPolynomial *p) {
    Chain chain = {.count = 1, .at = {*p}};
    RtPolynomial next = derivative(slate, p);
    while (next.degree >= 0) {
        chain.at[chain.count++] = next;
        next = divided(slate, chain.at[chain.count - 2], &next, NULL);
        for (int i = 0; i <= next.degree; i++) next.at[i] = rt_exact_neg(slate, next.at[i]);
    }
    return chain;
}

static int sign_changes(RtSlate *slate, const Chain *chain, RtRational t) {
    int changes = 0, last = 0;
    for (int i = 0; i < chain->count; i++) {
        int sign = rt_polynomial_sign(slate, &chain->at[i], t);
        changes += sign * last < 0;
        if (sign != 0) last = sign;
    }
    return changes;
}

/* A power of two above |t| of all roots t: Fujiwara's 2 max |a[n - i] / a[n]|^(1 / i), by numbers of bits. */
static RtRational bound_of(RtSlate *slate, const RtPolynomial *p) {
    const long top = (long)mpz_sizeinbase(mpq_numref(p->at[p->degree]), 2);
    long most = -(1L << 40);
    for (int i = 1; i <= p->degree; i++) {
        RtRational a = p->at[p->degree - i];
        long bits = (long)mpz_sizeinbase(mpq_numref(a), 2) - top + 1;
        long each = bits >= 0 ? (bits + i - 1) / i : -(-bits / i);
        if (rt_exact_sign(a) != 0 && each > most) most = each;
    }
    return most == -(1L << 40) ? rt_exact_of(slate, 1) : scaled(slate, rt_exact_of(slate, 1), most + 2);
}

/* Between lo and hi, and no root; they are none either. */
static RtRational point_between(RtSlate *slate, const RtPolynomial *p, RtRational lo, RtRational hi) {
    do lo = scaled(slate, rt_exact_add(slate, lo, hi), -1);
    while (rt_polynomial_sign(slate, p, lo) == 0);
    return lo;
}

int rt_polynomial_roots(RtSlate *slate, const RtPolynomial *p, RtAlgebraic roots[RT_MAX_DEGREE]) {
    RtPolynomial of = shortened(slate, *p);
    Chain chain = chain_of(slate, &of);
    const RtPolynomial twice = chain.at[chain.count - 1];
    if (twice.degree > 0) {
        divided(slate, of, &twice, &of);
        chain = chain_of(slate, &of);
    }
    RtRational end = bound_of(slate, &of), lo = rt_exact_neg(slate, end);
    int before = sign_changes(slate, &chain, lo), count = before - sign_changes(slate, &chain, end);
    for (int k = 0; k < count; k++) {
        RtRational hi = end;
        /* k roots are below lo, more than k below hi */
        for (int below = count; below > k + 1;) {
            RtRational middle = point_between(slate, &of, lo, hi);
            int found = before - sign_changes(slate, &chain, middle);
            if (found > k) {
                hi = middle;
                below = found;
            } else {
                lo = middle;
            }
        }
        roots[k] = (RtAlgebraic){of, lo, hi};
        narrow(slate, &roots[k], scaled(slate, end, -64));
        lo = hi;
    }
    return count;
}

/* ---- numbers ---- */

/* A root of (t - p)^2 - q^2 d, on the side of p that q is on, and nearer to it than |q| (d + 1). */
RtAlgebraic rt_algebraic_of_surd(RtSlate *slate, const RtSurd *surd) {
    RtRational one = rt_exact_of(slate, 1);
    if (rt_exact_sign(surd->q) == 0 || rt_exact_sign(surd->d) == 0) {
        return (RtAlgebraic){{1, {rt_exact_neg(slate, surd->p), one}},
                             rt_exact_sub(slate, surd->p, one),
                             rt_exact_add(slate, surd->p, one)};
    }
    RtRational q = surd->q, p = surd->p;
    RtRational square = rt_exact_mul(slate, rt_exact_mul(slate, q, q), surd->d);
    RtRational far = rt_exact_add(slate, p, rt_exact_mul(slate, q, rt_exact_add(slate, surd->d, one)));
    RtPolynomial of = {2,
                       {rt_exact_sub(slate, rt_exact_mul(slate, p, p), square),
                        rt_exact_mul(slate, rt_exact_of(slate, -2), p), one}};
    bool up = rt_exact_sign(q) > 0;
    return (RtAlgebraic){of, up ? p : far, up ? far : p};
}

/* Is it the same root, given that the intervals overlap? A common root in both is the one of each. */
static bool same(RtSlate *slate, const RtAlgebraic *a, const RtAlgebraic *b) {
    RtPolynomial common = rt_polynomial_common(slate, &a->of, &b->of);
    RtRational lo = mpq_cmp(a->lo, b->lo) > 0 ? a->lo : b->lo;
    RtRational hi = mpq_cmp(a->hi, b->hi) < 0 ? a->hi : b->hi;
    return common.degree > 0 &&
           rt_polynomial_sign(slate, &common, lo) != rt_polynomial_sign(slate, &common, hi);
}

int rt_algebraic_compare(RtSlate *slate, const RtAlgebraic *a, const RtAlgebraic *b) {
    size_t mark = rt_slate_mark(slate);
    RtAlgebraic x = *a, y = *b;
    bool differ = false;
    int order = 0;
    for (;;) {
        if (mpq_cmp(x.hi, y.lo) <= 0) order = -1;
        if (mpq_cmp(y.hi, x.lo) <= 0) order = 1;
        if (order != 0 || (!differ && same(slate, &x, &y))) break;
        differ = true;
        narrow(slate, &x, scaled(slate, width_of(slate, &x), -16));
        narrow(slate, &y, scaled(slate, width_of(slate, &y), -16));
    }
    rt_slate_wipe(slate, mark);
    return order;
}

/* With 32 bits more each time, until the interval is narrower than 2^-66 of how far it is from `from`. */
long double rt_algebraic_value(RtSlate *slate, const RtAlgebraic *a, RtRational from) {
    size_t mark = rt_slate_mark(slate);
    RtAlgebraic x = *a;
    long double value = 0;
    bool inside = mpq_cmp(x.lo, from) < 0 && mpq_cmp(from, x.hi) < 0;
    bool zero = inside && rt_polynomial_sign(slate, &x.of, from) == 0;
    while (!zero) {
        RtRational lo = rt_exact_sub(slate, x.lo, from), hi = rt_exact_sub(slate, x.hi, from);
        mpq_ptr least = rt_slate_number(slate);
        mpq_abs(least, rt_exact_sign(lo) > 0 ? lo : hi);
        RtRational width = width_of(slate, &x);
        if (rt_exact_sign(lo) * rt_exact_sign(hi) > 0 && mpq_cmp(width, scaled(slate, least, -66)) <= 0) {
            value = rt_exact_value(lo);
            break;
        }
        narrow(slate, &x, scaled(slate, width, -32));
    }
    rt_slate_wipe(slate, mark);
    return value;
}
