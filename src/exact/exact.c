#include "exact/exact.h"

/* ---- the slate ---- */

mpq_ptr rt_slate_number(RtSlate *slate) {
    if (slate->used == slate->block_count * RT_SLATE_BLOCK) {
        void *(*alloc)(size_t);
        void *(*grow)(void *, size_t, size_t);
        mp_get_memory_functions(&alloc, &grow, NULL);
        size_t old = slate->block_count * sizeof(void *), one = sizeof(void *);
        slate->blocks = old == 0 ? alloc(one) : grow(slate->blocks, old, old + one);
        mpq_t *block = alloc(RT_SLATE_BLOCK * sizeof(mpq_t));
        for (size_t i = 0; i < RT_SLATE_BLOCK; i++) mpq_init(block[i]);
        slate->blocks[slate->block_count++] = block;
    }
    mpq_t *block = slate->blocks[slate->used / RT_SLATE_BLOCK];
    return block[slate->used++ % RT_SLATE_BLOCK];
}

void rt_slate_clear(RtSlate *slate) {
    void (*release)(void *, size_t);
    mp_get_memory_functions(NULL, NULL, &release);
    for (size_t i = 0; i < slate->block_count; i++) {
        for (size_t k = 0; k < RT_SLATE_BLOCK; k++) mpq_clear(slate->blocks[i][k]);
        release(slate->blocks[i], RT_SLATE_BLOCK * sizeof(mpq_t));
    }
    if (slate->block_count > 0) release(slate->blocks, slate->block_count * sizeof(void *));
    *slate = (RtSlate){0};
}

/* ---- rationals ---- */

RtRational rt_exact_of(RtSlate *slate, double x) {
    mpq_ptr out = rt_slate_number(slate);
    mpq_set_d(out, x);
    return out;
}

RtRational rt_exact_add(RtSlate *slate, RtRational a, RtRational b) {
    mpq_ptr out = rt_slate_number(slate);
    mpq_add(out, a, b);
    return out;
}

RtRational rt_exact_sub(RtSlate *slate, RtRational a, RtRational b) {
    mpq_ptr out = rt_slate_number(slate);
    mpq_sub(out, a, b);
    return out;
}

RtRational rt_exact_mul(RtSlate *slate, RtRational a, RtRational b) {
    mpq_ptr out = rt_slate_number(slate);
    mpq_mul(out, a, b);
    return out;
}

RtRational rt_exact_div(RtSlate *slate, RtRational a, RtRational b) {
    mpq_ptr out = rt_slate_number(slate);
    mpq_div(out, a, b);
    return out;
}

RtRational rt_exact_neg(RtSlate *slate, RtRational a) {
    mpq_ptr out = rt_slate_number(slate);
    mpq_neg(out, a);
    return out;
}

/* Shifts the quotient of numerator and denominator until it has 64 bits or 65, and rounds it down: an error
 * of at most 2^-63, and that of one rounding to long double. */
long double rt_exact_value(RtRational a) {
    if (mpq_sgn(a) == 0) return 0;
    mpz_t top, bottom;
    mpz_init(top);
    mpz_init_set(bottom, mpq_denref(a));
    mpz_abs(top, mpq_numref(a));
    long up = 64 + (long)mpz_sizeinbase(bottom, 2) - (long)mpz_sizeinbase(top, 2);
    if (up >= 0) {
        mpz_mul_2exp(top, top, (mp_bitcnt_t)up);
    } else {
        mpz_mul_2exp(bottom, bottom, (mp_bitcnt_t)-up);
    }
    mpz_tdiv_q(top, top, bottom);
    long double value = 0;
    for (size_t limb = mpz_size(top); limb-- > 0;) {
        value = ldexpl(value, GMP_NUMB_BITS) + (long double)mpz_getlimbn(top, (mp_size_t)limb);
    }
    mpz_clear(top);
    mpz_clear(bottom);
    value = ldexpl(value, (int)-up);
    return mpq_sgn(a) < 0 ? -value : value;
}

RtExactVec rt_exact_vec(RtSlate *slate, RtVec3d v) {
    return (RtExactVec){{rt_exact_of(slate, v.x), rt_exact_of(slate, v.y), rt_exact_of(slate, v.z)}};
}

RtExactVec rt_exact_vec_sub(RtSlate *slate, RtExactVec a, RtExactVec b) {
    RtExactVec out;
    for (int i = 0; i < 3; i++) out.at[i] = rt_exact_sub(slate, a.at[i], b.at[i]);
    return out;
}

RtExactVec rt_exact_vec_add_scaled(RtSlate *slate, RtExactVec a, RtExactVec b, RtRational scale) {
    RtExactVec out;
    for (int i = 0; i < 3; i++) {
        out.at[i] = rt_exact_add(slate, a.at[i], rt_exact_mul(slate, b.at[i], scale));
    }
    return out;
}

RtRational rt_exact_dot(RtSlate *slate, RtExactVec a, RtExactVec b) {
    RtRational sum = rt_exact_mul(slate, a.at[0], b.at[0]);
    for (int i = 1; i < 3; i++) sum = rt_exact_add(slate, sum, rt_exact_mul(slate, a.at[i], b.at[i]));
    return sum;
}

RtExactVec rt_exact_cross(RtSlate *slate, RtExactVec a, RtExactVec b) {
    RtExactVec out;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out.at[i] =
            rt_exact_sub(slate, rt_exact_mul(slate, a.at[j], b.at[k]), rt_exact_mul(slate, a.at[k], b.at[j]));
    }
    return out;
}

/* ---- surds ---- */

RtSurd rt_surd_of(RtSlate *slate, RtRational p) {
    RtRational zero = rt_exact_of(slate, 0);
    return (RtSurd){p, zero, zero};
}

RtSurd rt_surd_line(RtSlate *slate, RtRational a, RtRational b, const RtSurd *x) {
    return (RtSurd){rt_exact_add(slate, a, rt_exact_mul(slate, b, x->p)), rt_exact_mul(slate, b, x->q), x->d};
}

static RtRational square(RtSlate *slate, RtRational a) {
    return rt_exact_mul(slate, a, a);
}

/* Of p + q sqrt(d). */
static int sign_of(RtSlate *slate, RtRational p, RtRational q, RtRational d) {
    int first = mpq_sgn(p), second = mpq_sgn(q) * mpq_sgn(d);
    if (first * second >= 0) return first != 0 ? first : second;
    return first * mpq_cmp(square(slate, p), rt_exact_mul(slate, square(slate, q), d));
}

int rt_surd_sign(RtSlate *slate, const RtSurd *a) {
    size_t mark = rt_slate_mark(slate);
    int sign = sign_of(slate, a->p, a->q, a->d);
    rt_slate_wipe(slate, mark);
    return (sign > 0) - (sign < 0);
}

/* (a.p - b.p + a.q sqrt(a.d)) and -b.q sqrt(b.d) are the parts whose squares are compared. */
int rt_surd_compare(RtSlate *slate, const RtSurd *a, const RtSurd *b) {
    size_t mark = rt_slate_mark(slate);
    RtRational p = rt_exact_sub(slate, a->p, b->p);
    int first = sign_of(slate, p, a->q, a->d), second = -mpq_sgn(b->q) * mpq_sgn(b->d), sign;
    first = (first > 0) - (first < 0);
    if (first * second >= 0) {
        sign = first != 0 ? first : second;
    } else {
        RtRational aa = rt_exact_mul(slate, square(slate, a->q), a->d);
        RtRational bb = rt_exact_mul(slate, square(slate, b->q), b->d);
        RtRational plain = rt_exact_sub(slate, rt_exact_add(slate, square(slate, p), aa), bb);
        RtRational pq = rt_exact_mul(slate, p, a->q);
        sign = first * sign_of(slate, plain, rt_exact_add(slate, pq, pq), a->d);
    }
    rt_slate_wipe(slate, mark);
    return (sign > 0) - (sign < 0);
}

/* sqrt(d) rounded down to a multiple of 2^-bits. */
static RtRational root_below(RtSlate *slate, RtRational d, mp_bitcnt_t bits) {
    mpq_ptr root = rt_slate_number(slate);
    mpz_mul_2exp(mpq_numref(root), mpq_numref(d), 2 * bits);
    mpz_tdiv_q(mpq_numref(root), mpq_numref(root), mpq_denref(d));
    mpz_sqrt(mpq_numref(root), mpq_numref(root));
    mpz_set_ui(mpq_denref(root), 1);
    mpq_div_2exp(root, root, bits);
    return root;
}

/* With twice as many bits each time, until q times what the root may be off is below 2^-66 of the number. */
long double rt_surd_value(RtSlate *slate, const RtSurd *a) {
    if (mpq_sgn(a->q) == 0 || mpq_sgn(a->d) == 0) return rt_exact_value(a->p);
    if (rt_surd_sign(slate, a) == 0) return 0;
    size_t mark = rt_slate_mark(slate);
    for (mp_bitcnt_t bits = 128;; bits *= 2) {
        RtRational root = root_below(slate, a->d, bits);
        RtRational near = rt_exact_add(slate, a->p, rt_exact_mul(slate, a->q, root));
        mpq_ptr off = rt_slate_number(slate), size = rt_slate_number(slate);
        mpq_abs(off, a->q);
        mpq_abs(size, near);
        mpq_div_2exp(off, off, bits - 66);
        bool sure = mpq_cmp(off, size) < 0;
        long double value = sure ? rt_exact_value(near) : 0;
        rt_slate_wipe(slate, mark);
        if (sure) return value;
    }
}

int rt_exact_roots(RtSlate *slate, RtRational a, RtRational half_b, RtRational c, RtSurd roots[2]) {
    RtRational zero = rt_exact_of(slate, 0);
    if (mpq_sgn(a) == 0) {
        if (mpq_sgn(half_b) == 0) return 0;
        roots[0] =
            (RtSurd){rt_exact_div(slate, c, rt_exact_mul(slate, rt_exact_of(slate, -2), half_b)), zero, zero};
        return 1;
    }
    RtRational d = rt_exact_sub(slate, square(slate, half_b), rt_exact_mul(slate, a, c));
    if (mpq_sgn(d) < 0) return 0;
    RtRational middle = rt_exact_neg(slate, rt_exact_div(slate, half_b, a));
    if (mpq_sgn(d) == 0) {
        roots[0] = (RtSurd){middle, zero, zero};
        return 1;
    }
    RtRational up = rt_exact_div(slate, rt_exact_of(slate, mpq_sgn(a)), a);
    roots[0] = (RtSurd){middle, rt_exact_neg(slate, up), d};
    roots[1] = (RtSurd){middle, up, d};
    return 2;
}
