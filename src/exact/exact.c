/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/exact.h"

#include <pthread.h>

/* ---- the arena ---- */

/* Each thread keeps an arena while it runs, because creating numbers takes as long as computing with them.
 * Blocks beyond MOST_BLOCKS are freed once no number is in use. */
enum { BLOCK = 64, MOST_BLOCKS = 256 };

typedef struct Arena {
    mpq_t **blocks; /* [block_count] of BLOCK numbers each, all initialised */
    size_t block_count, used;
} Arena;

static _Thread_local Arena arena;
static pthread_key_t threads_end;
static pthread_once_t begun = PTHREAD_ONCE_INIT;

static void clear(void *of) {
    Arena *a = of;
    void (*release)(void *, size_t);
    mp_get_memory_functions(NULL, NULL, &release);
    for (size_t i = 0; i < a->block_count; i++) {
        for (size_t k = 0; k < BLOCK; k++) mpq_clear(a->blocks[i][k]);
        release(a->blocks[i], BLOCK * sizeof(mpq_t));
    }
    if (a->block_count > 0) release(a->blocks, a->block_count * sizeof(void *));
    *a = (Arena){0};
}

static void begin(void) {
    pthread_key_create(&threads_end, clear);
}

static void add_block(void) {
    void *(*alloc)(size_t);
    void *(*grow)(void *, size_t, size_t);
    mp_get_memory_functions(&alloc, &grow, NULL);
    pthread_once(&begun, begin);
    pthread_setspecific(threads_end, &arena);
    size_t old = arena.block_count * sizeof(void *), one = sizeof(void *);
    arena.blocks = old == 0 ? alloc(one) : grow(arena.blocks, old, old + one);
    mpq_t *block = alloc(BLOCK * sizeof(mpq_t));
    for (size_t i = 0; i < BLOCK; i++) mpq_init(block[i]);
    arena.blocks[arena.block_count++] = block;
}

/* A new number, to be written once. */
static mpq_ptr new_number(void) {
    if (arena.used == arena.block_count * BLOCK) add_block();
    mpq_t *block = arena.blocks[arena.used / BLOCK];
    return block[arena.used++ % BLOCK];
}

size_t rt_exact_mark(void) {
    return arena.used;
}

void rt_exact_rewind(size_t mark) {
    arena.used = mark;
    if (mark == 0 && arena.block_count > MOST_BLOCKS) clear(&arena);
}

/* ---- rationals ---- */

RtRational rt_exact_of(double x) {
    mpq_ptr out = new_number();
    mpq_set_d(out, x);
    return out;
}

#define DEFINE(operation)                                                                                    \
    RtRational rt_exact_##operation(RtRational a, RtRational b) {                                            \
        mpq_ptr out = new_number();                                                                          \
        mpq_##operation(out, a, b);                                                                          \
        return out;                                                                                          \
    }
DEFINE(add)
DEFINE(sub)
DEFINE(mul)
DEFINE(div)
#undef DEFINE

RtRational rt_exact_neg(RtRational a) {
    return rt_exact_sub(rt_exact_of(0), a);
}

/* Shifts the quotient of numerator and denominator to 64 or 65 bits and rounds it down: an error of at
 * most 2^-63, plus one rounding to long double. */
long double rt_exact_value(RtRational a) {
    if (mpq_sgn(a) == 0) return 0;
    mpz_t top, bottom;
    mpz_init(top);
    mpz_init_set(bottom, mpq_denref(a));
    mpz_abs(top, mpq_numref(a));
    long up = 64 + (long)mpz_sizeinbase(bottom, 2) - (long)mpz_sizeinbase(top, 2);
    if (up >= 0)
        mpz_mul_2exp(top, top, (mp_bitcnt_t)up);
    else
        mpz_mul_2exp(bottom, bottom, (mp_bitcnt_t)-up);
    mpz_tdiv_q(top, top, bottom);
    long double value = 0;
    for (size_t limb = mpz_size(top); limb-- > 0;)
        value = ldexpl(value, GMP_NUMB_BITS) + (long double)mpz_getlimbn(top, (mp_size_t)limb);
    mpz_clear(top);
    mpz_clear(bottom);
    value = ldexpl(value, (int)-up);
    return mpq_sgn(a) < 0 ? -value : value;
}

RtExactVec rt_exact_vec(RtVec3d v) {
    return (RtExactVec){{rt_exact_of(v.x), rt_exact_of(v.y), rt_exact_of(v.z)}};
}

RtExactVec rt_exact_vec_sub(RtExactVec a, RtExactVec b) {
    RtExactVec out;
    for (int i = 0; i < 3; i++) out.at[i] = rt_exact_sub(a.at[i], b.at[i]);
    return out;
}

RtExactVec rt_exact_vec_add_scaled(RtExactVec a, RtExactVec b, RtRational scale) {
    RtExactVec out;
    for (int i = 0; i < 3; i++) out.at[i] = rt_exact_add(a.at[i], rt_exact_mul(b.at[i], scale));
    return out;
}

RtRational rt_exact_dot(RtExactVec a, RtExactVec b) {
    RtRational sum = rt_exact_mul(a.at[0], b.at[0]);
    for (int i = 1; i < 3; i++) sum = rt_exact_add(sum, rt_exact_mul(a.at[i], b.at[i]));
    return sum;
}

RtExactVec rt_exact_cross(RtExactVec a, RtExactVec b) {
    RtExactVec out;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out.at[i] = rt_exact_sub(rt_exact_mul(a.at[j], b.at[k]), rt_exact_mul(a.at[k], b.at[j]));
    }
    return out;
}

/* ---- polynomials ---- */

RtPolynomial rt_polynomial(int degree, const RtRational *at) {
    RtPolynomial p = {.degree = degree};
    for (int i = 0; i <= degree; i++) p.at[i] = at[i];
    while (p.degree >= 0 && rt_exact_sign(p.at[p.degree]) == 0) p.degree--;
    return p;
}

static RtRational value_at(const RtPolynomial *p, RtRational t) {
    RtRational sum = p->at[p->degree];
    for (int i = p->degree - 1; i >= 0; i--) sum = rt_exact_add(rt_exact_mul(sum, t), p->at[i]);
    return sum;
}

static int sign_at(const RtPolynomial *p, RtRational t) {
    size_t mark = rt_exact_mark();
    int sign = rt_exact_sign(value_at(p, t));
    rt_exact_rewind(mark);
    return sign;
}

/* Multiplies by the least common multiple of the denominators over the greatest common divisor of the
 * numerators. */
static RtPolynomial shortened(RtPolynomial p) {
    if (p.degree < 0) return p;
    mpq_ptr factor = new_number();
    mpz_set_ui(mpq_numref(factor), 1);
    mpz_set_ui(mpq_denref(factor), 0);
    for (int i = 0; i <= p.degree; i++) {
        mpz_lcm(mpq_numref(factor), mpq_numref(factor), mpq_denref(p.at[i]));
        mpz_gcd(mpq_denref(factor), mpq_denref(factor), mpq_numref(p.at[i]));
    }
    mpq_canonicalize(factor);
    for (int i = 0; i <= p.degree; i++) p.at[i] = rt_exact_mul(p.at[i], factor);
    return p;
}

static RtPolynomial derivative(const RtPolynomial *p) {
    RtPolynomial out = {.degree = p->degree > 0 ? p->degree - 1 : -1};
    for (int i = 1; i <= p->degree; i++) out.at[i - 1] = rt_exact_mul(rt_exact_of(i), p->at[i]);
    return out;
}

/* Long division of integer polynomials by q, which is not 0: p times a positive number is quotient times q
 * plus the remainder. Returns the remainder, and the quotient if wanted. All intermediate numbers are
 * integers. */
static RtPolynomial divided(RtPolynomial p, const RtPolynomial *q, RtPolynomial *quotient) {
    RtPolynomial parts = {.degree = p.degree - q->degree};
    RtRational lead = q->at[q->degree];
    if (rt_exact_sign(lead) < 0) lead = rt_exact_neg(lead);
    for (int k = parts.degree; k >= 0; k--) {
        RtRational part = p.at[k + q->degree];
        if (lead != q->at[q->degree]) part = rt_exact_neg(part);
        for (int i = 0; i < k + q->degree; i++) {
            p.at[i] = rt_exact_mul(p.at[i], lead);
            if (i >= k) p.at[i] = rt_exact_sub(p.at[i], rt_exact_mul(part, q->at[i - k]));
        }
        for (int i = k + 1; i <= parts.degree; i++) parts.at[i] = rt_exact_mul(parts.at[i], lead);
        parts.at[k] = part;
    }
    if (p.degree >= q->degree) p.degree = q->degree - 1;
    if (quotient) *quotient = shortened(parts);
    return shortened(rt_polynomial(p.degree, p.at));
}

/* The greatest common divisor of two polynomials, not both 0. */
static RtPolynomial common_divisor(const RtPolynomial *p, const RtPolynomial *q) {
    RtPolynomial a = shortened(*p), b = shortened(*q);
    while (b.degree >= 0) {
        RtPolynomial rest = divided(a, &b, NULL);
        a = b;
        b = rest;
    }
    return a;
}

/* ---- narrowing ---- */

static RtRational width_of(const RtRoot *a) {
    return rt_exact_sub(a->hi, a->lo);
}

/* x * 2^by */
static RtRational scaled(RtRational x, long by) {
    mpq_ptr out = new_number();
    if (by >= 0)
        mpq_mul_2exp(out, x, (mp_bitcnt_t)by);
    else
        mpq_div_2exp(out, x, (mp_bitcnt_t)-by);
    return out;
}

/* Narrows the interval to lo..hi, which shares at least one end with it. If an end is the root itself, the
 * root is that number. False if the root is elsewhere. */
static bool cut_down(RtRoot *a, RtRational lo, RtRational hi) {
    int below = sign_at(&a->of, lo), above = sign_at(&a->of, hi);
    if (below * above > 0) return false;
    a->lo = above == 0 ? hi : lo;
    a->hi = below == 0 ? lo : hi;
    return true;
}

/* Divides the interval into 2^bits equal parts and tries the one in which the secant is 0. */
static bool try_secant(RtRoot *a, unsigned bits) {
    RtRational at_lo = value_at(&a->of, a->lo), at_hi = value_at(&a->of, a->hi);
    RtRational span = rt_exact_sub(at_lo, at_hi);
    mpq_ptr number = new_number(); /* of the part, 0..2^bits - 1 */
    mpz_mul(mpq_numref(number), mpq_numref(at_lo), mpq_denref(span));
    mpz_mul_2exp(mpq_numref(number), mpq_numref(number), bits);
    mpz_mul(mpq_denref(number), mpq_numref(span), mpq_denref(at_lo));
    mpz_fdiv_q(mpq_numref(number), mpq_numref(number), mpq_denref(number));
    mpz_set_ui(mpq_denref(number), 1);
    RtRational part = scaled(width_of(a), -(long)bits);
    RtRational lo = rt_exact_add(a->lo, rt_exact_mul(number, part));
    return cut_down(a, lo, rt_exact_add(lo, part));
}

/* Narrows the interval to at most `width`. Each success of the secant doubles the number of bits. */
static void narrow(RtRoot *a, RtRational width) {
    unsigned bits = 1;
    while (mpq_cmp(width_of(a), width) > 0) {
        if (try_secant(a, bits)) {
            bits *= 2;
            continue;
        }
        RtRational middle = scaled(rt_exact_add(a->lo, a->hi), -1);
        if (!cut_down(a, a->lo, middle)) a->lo = middle;
        if (bits > 1) bits /= 2;
    }
}

/* ---- roots ---- */

/* Sturm's chain; the last polynomial is the greatest common divisor of p and p'. */
typedef struct Chain {
    int count;
    RtPolynomial at[RT_MAX_DEGREE + 1];
} Chain;

static Chain chain_of(const RtPolynomial *p) {
    Chain chain = {.count = 1, .at = {*p}};
    RtPolynomial next = derivative(p);
    while (next.degree >= 0) {
        chain.at[chain.count++] = next;
        next = divided(chain.at[chain.count - 2], &next, NULL);
        for (int i = 0; i <= next.degree; i++) next.at[i] = rt_exact_neg(next.at[i]);
    }
    return chain;
}

static int sign_changes(const Chain *chain, RtRational t) {
    int changes = 0, last = 0;
    for (int i = 0; i < chain->count; i++) {
        int sign = sign_at(&chain->at[i], t);
        changes += sign * last < 0;
        if (sign != 0) last = sign;
    }
    return changes;
}

/* A power of two above |t| for all roots t: Fujiwara's bound 2 max |a[n - i] / a[n]|^(1 / i), from numbers
 * of bits. */
static RtRational bound_of(const RtPolynomial *p) {
    const long top = (long)mpz_sizeinbase(mpq_numref(p->at[p->degree]), 2);
    long most = -(1L << 40);
    for (int i = 1; i <= p->degree; i++) {
        RtRational a = p->at[p->degree - i];
        long bits = (long)mpz_sizeinbase(mpq_numref(a), 2) - top + 1;
        long each = bits >= 0 ? (bits + i - 1) / i : -(-bits / i);
        if (rt_exact_sign(a) != 0 && each > most) most = each;
    }
    return most == -(1L << 40) ? rt_exact_of(1) : scaled(rt_exact_of(1), most + 2);
}

/* A point between lo and hi that is no root; nor are lo and hi. */
static RtRational point_between(const RtPolynomial *p, RtRational lo, RtRational hi) {
    do lo = scaled(rt_exact_add(lo, hi), -1);
    while (sign_at(p, lo) == 0);
    return lo;
}

/* sqrt(d) rounded down to a multiple of 2^-bits. */
static RtRational root_below(RtRational d, mp_bitcnt_t bits) {
    mpq_ptr root = new_number();
    mpz_mul_2exp(mpq_numref(root), mpq_numref(d), 2 * bits);
    mpz_tdiv_q(mpq_numref(root), mpq_numref(root), mpq_denref(d));
    mpz_sqrt(mpq_numref(root), mpq_numref(root));
    mpz_set_ui(mpq_denref(root), 1);
    mpq_div_2exp(root, root, bits);
    return root;
}

/* Of degree 2: the middle of both minus and plus a square root, which lies between low and high. */
static int quadratic_roots(const RtPolynomial *p, RtRoot roots[2]) {
    RtRational middle = rt_exact_neg(rt_exact_div(p->at[1], scaled(p->at[2], 1)));
    RtRational square = rt_exact_sub(rt_exact_mul(middle, middle), rt_exact_div(p->at[0], p->at[2]));
    roots[0] = rt_root_of(middle);
    roots[0].crossed = false;
    if (rt_exact_sign(square) <= 0) return rt_exact_sign(square) + 1;
    long size = (long)mpz_sizeinbase(mpq_numref(square), 2) - (long)mpz_sizeinbase(mpq_denref(square), 2);
    long bits = size / 2 < 66 ? 66 - size / 2 : 1;
    RtRational low = root_below(square, (mp_bitcnt_t)bits), high = low;
    if (mpq_cmp(rt_exact_mul(low, low), square) < 0) high = rt_exact_add(low, scaled(rt_exact_of(1), -bits));
    for (int k = 0; k < 2; k++) {
        RtRational lo = k == 0 ? rt_exact_sub(middle, high) : rt_exact_add(middle, low), hi = lo;
        if (low != high) hi = k == 0 ? rt_exact_sub(middle, low) : rt_exact_add(middle, high);
        roots[k] = (RtRoot){*p, lo, hi, true};
    }
    return 2;
}

/* Of any degree above 0. */
static int isolated_roots(const RtPolynomial *p, RtRoot roots[RT_MAX_DEGREE]) {
    RtPolynomial of = shortened(*p);
    Chain chain = chain_of(&of);
    const RtPolynomial twice = chain.at[chain.count - 1];
    if (twice.degree > 0) {
        divided(of, &twice, &of);
        chain = chain_of(&of);
    }
    RtRational end = bound_of(&of), lo = rt_exact_neg(end);
    int before = sign_changes(&chain, lo), count = before - sign_changes(&chain, end);
    for (int k = 0; k < count; k++) {
        RtRational hi = end;
        /* k roots are below lo, more than k below hi */
        for (int below = count; below > k + 1;) {
            RtRational middle = point_between(&of, lo, hi);
            int found = before - sign_changes(&chain, middle);
            if (found > k) {
                hi = middle;
                below = found;
            } else {
                lo = middle;
            }
        }
        roots[k] = (RtRoot){of, lo, hi, sign_at(p, lo) != sign_at(p, hi)};
        narrow(&roots[k], scaled(end, -64));
        lo = hi;
    }
    return count;
}

int rt_polynomial_roots(const RtPolynomial *p, RtRoot roots[RT_MAX_DEGREE]) {
    if (p->degree < 1) return 0;
    if (p->degree == 2) return quadratic_roots(p, roots);
    if (p->degree > 2) return isolated_roots(p, roots);
    roots[0] = rt_root_of(rt_exact_neg(rt_exact_div(p->at[0], p->at[1])));
    return 1;
}

/* ---- roots as numbers ---- */

RtRoot rt_root_of(RtRational t) {
    return (RtRoot){.lo = t, .hi = t, .crossed = true};
}

static bool is_rational(const RtRoot *a) {
    return a->lo == a->hi;
}

int rt_root_compare_rational(const RtRoot *a, RtRational t) {
    int below = mpq_cmp(a->lo, t), above = mpq_cmp(a->hi, t);
    if (is_rational(a) || below >= 0 || above <= 0) return (below + above > 0) - (below + above < 0);
    int here = sign_at(&a->of, t);
    return here == 0 ? 0 : here == sign_at(&a->of, a->lo) ? 1 : -1;
}

/* Are the roots equal, given that the intervals overlap? A common root in both intervals is each one's
 * only root. */
static bool same(const RtRoot *a, const RtRoot *b) {
    RtPolynomial common = common_divisor(&a->of, &b->of);
    RtRational lo = mpq_cmp(a->lo, b->lo) > 0 ? a->lo : b->lo;
    RtRational hi = mpq_cmp(a->hi, b->hi) < 0 ? a->hi : b->hi;
    return common.degree > 0 && sign_at(&common, lo) != sign_at(&common, hi);
}

int rt_root_compare(const RtRoot *a, const RtRoot *b) {
    if (is_rational(b)) return rt_root_compare_rational(a, b->lo);
    if (is_rational(a)) return -rt_root_compare_rational(b, a->lo);
    size_t mark = rt_exact_mark();
    RtRoot x = *a, y = *b;
    bool differ = false;
    int order = 0;
    for (;;) {
        if (mpq_cmp(x.hi, y.lo) <= 0) order = -1;
        if (mpq_cmp(y.hi, x.lo) <= 0) order = 1;
        if (order != 0 || (!differ && same(&x, &y))) break;
        differ = true;
        narrow(&x, scaled(width_of(&x), -16));
        narrow(&y, scaled(width_of(&y), -16));
    }
    rt_exact_rewind(mark);
    return order;
}

/* Adds 32 bits at a time until the interval is narrower than 2^-66 of its distance from `from`. */
long double rt_root_value(const RtRoot *a, RtRational from) {
    size_t mark = rt_exact_mark();
    RtRoot x = *a;
    long double value = 0;
    bool zero = rt_root_compare_rational(a, from) == 0;
    while (!zero) {
        RtRational lo = rt_exact_sub(x.lo, from), hi = rt_exact_sub(x.hi, from);
        mpq_ptr least = new_number();
        mpq_abs(least, rt_exact_sign(lo) > 0 ? lo : hi);
        RtRational width = width_of(&x);
        if (rt_exact_sign(lo) * rt_exact_sign(hi) > 0 && mpq_cmp(width, scaled(least, -66)) <= 0) {
            value = rt_exact_value(lo);
            break;
        }
        narrow(&x, scaled(width, -32));
    }
    rt_exact_rewind(mark);
    return value;
}

/* ---- lines ---- */

RtWideRay rt_wide_ray(const RtRay *ray) {
    return (RtWideRay){rt_widen(ray->org), rt_widen(ray->dir), (double)ray->tmin, (double)ray->tmax};
}

bool rt_line_may_meet(const RtWideRay *line, const RtBox *box, double *soonest) {
    double near = line->tmin, far = fmin(line->tmax, (double)FLT_MAX);
    for (int a = 0; a < 3; a++) {
        double org = line->org.at[a], dir = line->dir.at[a];
        double most = fmax(fabs((double)box->lo.at[a]), fabs((double)box->hi.at[a]));
        double slack = RT_LINE_SLACK * (fabs(org) + most);
        double lo = (double)box->lo.at[a] - org - slack, hi = (double)box->hi.at[a] - org + slack;
        if (dir == 0) {
            if (lo > 0 || hi < 0) return false;
            continue;
        }
        double first = (dir > 0 ? lo : hi) / dir, second = (dir > 0 ? hi : lo) / dir;
        near = fmax(near, first - RT_LINE_SLACK * fabs(first));
        far = fmin(far, second + RT_LINE_SLACK * fabs(second));
    }
    *soonest = near;
    return near <= far;
}

RtExactLine rt_exact_line(const RtWideRay *line) {
    return (RtExactLine){.wide = *line,
                         .org = rt_exact_vec(line->org),
                         .dir = rt_exact_vec(line->dir),
                         .zero = rt_exact_of(0),
                         .tmin = rt_exact_of(line->tmin),
                         .tmax = rt_exact_of(fmin(line->tmax, (double)FLT_MAX))};
}

bool rt_exact_counts(const RtExactLine *line, const RtRoot *t) {
    return rt_root_compare_rational(t, line->tmin) >= 0 && rt_root_compare_rational(t, line->tmax) <= 0;
}
