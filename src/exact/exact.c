/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/exact.h"

#include <pthread.h>

/* ---- the arena ---- */

mpq_ptr rt_exact_arena_number(RtExactArena *arena) {
    if (arena->used == arena->block_count * RT_EXACT_ARENA_BLOCK) {
        void *(*alloc)(size_t);
        void *(*grow)(void *, size_t, size_t);
        mp_get_memory_functions(&alloc, &grow, NULL);
        size_t old = arena->block_count * sizeof(void *), one = sizeof(void *);
        arena->blocks = old == 0 ? alloc(one) : grow(arena->blocks, old, old + one);
        mpq_t *block = alloc(RT_EXACT_ARENA_BLOCK * sizeof(mpq_t));
        for (size_t i = 0; i < RT_EXACT_ARENA_BLOCK; i++) mpq_init(block[i]);
        arena->blocks[arena->block_count++] = block;
    }
    mpq_t *block = arena->blocks[arena->used / RT_EXACT_ARENA_BLOCK];
    return block[arena->used++ % RT_EXACT_ARENA_BLOCK];
}

void rt_exact_arena_clear(RtExactArena *arena) {
    void (*release)(void *, size_t);
    mp_get_memory_functions(NULL, NULL, &release);
    for (size_t i = 0; i < arena->block_count; i++) {
        for (size_t k = 0; k < RT_EXACT_ARENA_BLOCK; k++) mpq_clear(arena->blocks[i][k]);
        release(arena->blocks[i], RT_EXACT_ARENA_BLOCK * sizeof(mpq_t));
    }
    if (arena->block_count > 0) release(arena->blocks, arena->block_count * sizeof(void *));
    *arena = (RtExactArena){0};
}

/* ---- the thread's arena ---- */

/* Each thread keeps an arena while it runs, because creating numbers takes as long as computing with them.
 * Blocks beyond MOST_BLOCKS are freed after a search. */
enum { MOST_BLOCKS = 256 };
static _Thread_local RtExactArena kept;
static pthread_key_t threads_end;
static pthread_once_t begun = PTHREAD_ONCE_INIT;

static void forget(void *arena) {
    rt_exact_arena_clear(arena);
}

static void begin(void) {
    pthread_key_create(&threads_end, forget);
}

RtExactArena *rt_exact_arena_borrow(void) {
    pthread_once(&begun, begin);
    if (kept.block_count == 0) pthread_setspecific(threads_end, &kept);
    return &kept;
}

void rt_exact_arena_return(RtExactArena *arena, size_t mark) {
    rt_exact_arena_rewind(arena, mark);
    if (mark == 0 && arena->block_count > MOST_BLOCKS) rt_exact_arena_clear(arena);
}

/* ---- rationals ---- */

RtRational rt_exact_of(RtExactArena *arena, double x) {
    mpq_ptr out = rt_exact_arena_number(arena);
    mpq_set_d(out, x);
    return out;
}

#define DEFINE(operation)                                                                                    \
    RtRational rt_exact_##operation(RtExactArena *arena, RtRational a, RtRational b) {                       \
        mpq_ptr out = rt_exact_arena_number(arena);                                                          \
        mpq_##operation(out, a, b);                                                                          \
        return out;                                                                                          \
    }
DEFINE(add)
DEFINE(sub)
DEFINE(mul)
DEFINE(div)
#undef DEFINE

RtRational rt_exact_neg(RtExactArena *arena, RtRational a) {
    mpq_ptr out = rt_exact_arena_number(arena);
    mpq_neg(out, a);
    return out;
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

RtExactVec rt_exact_vec(RtExactArena *arena, RtVec3d v) {
    return (RtExactVec){{rt_exact_of(arena, v.x), rt_exact_of(arena, v.y), rt_exact_of(arena, v.z)}};
}

RtExactVec rt_exact_vec_sub(RtExactArena *arena, RtExactVec a, RtExactVec b) {
    RtExactVec out;
    for (int i = 0; i < 3; i++) out.at[i] = rt_exact_sub(arena, a.at[i], b.at[i]);
    return out;
}

RtExactVec rt_exact_vec_add_scaled(RtExactArena *arena, RtExactVec a, RtExactVec b, RtRational scale) {
    RtExactVec out;
    for (int i = 0; i < 3; i++) out.at[i] = rt_exact_add(arena, a.at[i], rt_exact_mul(arena, b.at[i], scale));
    return out;
}

RtRational rt_exact_dot(RtExactArena *arena, RtExactVec a, RtExactVec b) {
    RtRational sum = rt_exact_mul(arena, a.at[0], b.at[0]);
    for (int i = 1; i < 3; i++) sum = rt_exact_add(arena, sum, rt_exact_mul(arena, a.at[i], b.at[i]));
    return sum;
}

RtExactVec rt_exact_cross(RtExactArena *arena, RtExactVec a, RtExactVec b) {
    RtExactVec out;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out.at[i] =
            rt_exact_sub(arena, rt_exact_mul(arena, a.at[j], b.at[k]), rt_exact_mul(arena, a.at[k], b.at[j]));
    }
    return out;
}

/* ---- surds ---- */

RtSurd rt_surd_of(RtExactArena *arena, RtRational p) {
    RtRational zero = rt_exact_of(arena, 0);
    return (RtSurd){p, zero, zero};
}

RtSurd rt_surd_line(RtExactArena *arena, RtRational a, RtRational b, const RtSurd *x) {
    return (RtSurd){rt_exact_add(arena, a, rt_exact_mul(arena, b, x->p)), rt_exact_mul(arena, b, x->q), x->d};
}

static RtRational square(RtExactArena *arena, RtRational a) {
    return rt_exact_mul(arena, a, a);
}

/* The sign of p + q sqrt(d). */
static int sign_of(RtExactArena *arena, RtRational p, RtRational q, RtRational d) {
    int first = mpq_sgn(p), second = mpq_sgn(q) * mpq_sgn(d);
    if (first * second >= 0) return first != 0 ? first : second;
    return first * mpq_cmp(square(arena, p), rt_exact_mul(arena, square(arena, q), d));
}

int rt_surd_sign(RtExactArena *arena, const RtSurd *a) {
    size_t mark = rt_exact_arena_mark(arena);
    int sign = sign_of(arena, a->p, a->q, a->d);
    rt_exact_arena_rewind(arena, mark);
    return (sign > 0) - (sign < 0);
}

/* Compares the squares of (a.p - b.p + a.q sqrt(a.d)) and -b.q sqrt(b.d). */
int rt_surd_compare(RtExactArena *arena, const RtSurd *a, const RtSurd *b) {
    size_t mark = rt_exact_arena_mark(arena);
    RtRational p = rt_exact_sub(arena, a->p, b->p);
    int first = sign_of(arena, p, a->q, a->d), second = -mpq_sgn(b->q) * mpq_sgn(b->d), sign;
    first = (first > 0) - (first < 0);
    if (first * second >= 0) {
        sign = first != 0 ? first : second;
    } else {
        RtRational aa = rt_exact_mul(arena, square(arena, a->q), a->d);
        RtRational bb = rt_exact_mul(arena, square(arena, b->q), b->d);
        RtRational plain = rt_exact_sub(arena, rt_exact_add(arena, square(arena, p), aa), bb);
        RtRational pq = rt_exact_mul(arena, p, a->q);
        sign = first * sign_of(arena, plain, rt_exact_add(arena, pq, pq), a->d);
    }
    rt_exact_arena_rewind(arena, mark);
    return (sign > 0) - (sign < 0);
}

/* sqrt(d) rounded down to a multiple of 2^-bits. */
static RtRational root_below(RtExactArena *arena, RtRational d, mp_bitcnt_t bits) {
    mpq_ptr root = rt_exact_arena_number(arena);
    mpz_mul_2exp(mpq_numref(root), mpq_numref(d), 2 * bits);
    mpz_tdiv_q(mpq_numref(root), mpq_numref(root), mpq_denref(d));
    mpz_sqrt(mpq_numref(root), mpq_numref(root));
    mpz_set_ui(mpq_denref(root), 1);
    mpq_div_2exp(root, root, bits);
    return root;
}

/* Doubles the bits until q times the error of the root is below 2^-66 of the number. */
long double rt_surd_value(RtExactArena *arena, const RtSurd *a) {
    if (mpq_sgn(a->q) == 0 || mpq_sgn(a->d) == 0) return rt_exact_value(a->p);
    if (rt_surd_sign(arena, a) == 0) return 0;
    size_t mark = rt_exact_arena_mark(arena);
    for (mp_bitcnt_t bits = 128;; bits *= 2) {
        RtRational root = root_below(arena, a->d, bits);
        RtRational near = rt_exact_add(arena, a->p, rt_exact_mul(arena, a->q, root));
        mpq_ptr off = rt_exact_arena_number(arena), size = rt_exact_arena_number(arena);
        mpq_abs(off, a->q);
        mpq_abs(size, near);
        mpq_div_2exp(off, off, bits - 66);
        bool sure = mpq_cmp(off, size) < 0;
        long double value = sure ? rt_exact_value(near) : 0;
        rt_exact_arena_rewind(arena, mark);
        if (sure) return value;
    }
}

int rt_exact_roots(RtExactArena *arena, RtRational a, RtRational half_b, RtRational c, RtSurd roots[2]) {
    RtRational zero = rt_exact_of(arena, 0);
    if (mpq_sgn(a) == 0) {
        if (mpq_sgn(half_b) == 0) return 0;
        roots[0] =
            (RtSurd){rt_exact_div(arena, c, rt_exact_mul(arena, rt_exact_of(arena, -2), half_b)), zero, zero};
        return 1;
    }
    RtRational d = rt_exact_sub(arena, square(arena, half_b), rt_exact_mul(arena, a, c));
    if (mpq_sgn(d) < 0) return 0;
    RtRational middle = rt_exact_neg(arena, rt_exact_div(arena, half_b, a));
    if (mpq_sgn(d) == 0) {
        roots[0] = (RtSurd){middle, zero, zero};
        return 1;
    }
    RtRational up = rt_exact_div(arena, rt_exact_of(arena, mpq_sgn(a)), a);
    roots[0] = (RtSurd){middle, rt_exact_neg(arena, up), d};
    roots[1] = (RtSurd){middle, up, d};
    return 2;
}
