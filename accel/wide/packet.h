/* SPDX-License-Identifier: Apache-2.0 */
/* Sixteen rays that go the same way are taken through the hierarchy together.
 *
 * At a node one test of the packet does for all its rays: between the least and the most of their origins and
 * reciprocals lies, along each axis, where any of them enters a box and leaves it (interval arithmetic, as in
 * Boulos, Wald & Shirley 2006, "Geometric and Arithmetic Culling Methods for Entire Ray Packets"). It is
 * conservative to the bit, for the operations are those of rt_box_hit, and rounding is monotone. At a leaf
 * each ray tests the leaf's box for itself, and those that meet it test its triangles, four at once; what
 * passes the sieve is tested in full, sixteen rays and triangles at once.
 *
 * Rays of a packet have the same signs of direction, the same major axis, and no component of 0. */
#ifndef RT_ACCEL_WIDE_PACKET_H
#define RT_ACCEL_WIDE_PACKET_H

#include "accel/wide/flight.h"

enum { PACKET = 16, EVERY = (1 << PACKET) - 1 };

/* All there can be at a leaf, and a whole batch behind the last. */
enum { MOST_PAIRS = PACKET * RT_WIDE_MAX_LEAF + PACKET };

/* A ray and a triangle each. */
typedef struct Pairs {
    _Alignas(RT_CACHE_LINE) uint32_t ray[MOST_PAIRS];
    const float *triangle[MOST_PAIRS]; /* its first coordinate; the others as in a block */
    uint32_t count;
} Pairs;

typedef struct Packet {
    _Alignas(RT_CACHE_LINE) float org[3][PACKET];
    float dir[3][PACKET], inv[3][PACKET], org_near[3][PACKET], org_far[3][PACKET];
    float tmin[PACKET], tmax[PACKET], limit[PACKET], shear_x[PACKET], shear_y[PACKET];
    Pairs pairs;
    bool negative[3];
    uint32_t kx, ky, kz;
    uint32_t near[3], far[3]; /* as of a flight */
    /* The least and most of all rays: of each axis the origin of the first to enter, and of the last to
     * leave. */
    float first[3], last[3], inv_least[3], inv_most[3], tmin_least, limit_most;
    RtHit best[PACKET];
    uint32_t prepared; /* bit i: ray[i] is */
    RtPreparedRay ray[PACKET];
    uint32_t visits; /* of nodes and leaves, in visits of a ray alone */
    float enter[RT_WIDE_STACK];
    RtWideRef waiting[RT_WIDE_STACK], parent[RT_WIDE_STACK]; /* a child, and its parent plus its lane */
} Packet;

/* What a packet's visits cost, in visits of a ray alone: counted in quarters. */
enum { NODE_QUARTERS = 6, LEAF_QUARTERS = 5, RAY_QUARTERS = 4 };

/* ---- a packet ---- */

RT_KERNEL bool is_uniform(uint32_t mask) {
    return mask == 0 || mask == EVERY;
}

RT_KERNEL bool same_signs(const RtRay *a, const RtRay *b) {
    bool same = true;
    for (int i = 0; i < 3; i++) same &= signbit(a->dir.at[i]) == signbit(b->dir.at[i]);
    return same;
}

/* Four fields that follow each other in rays[0..16), field by field. */
RT_KERNEL void put_fields(const RtRay *rays, size_t offset, float *a, float *b, float *c, float *d) {
    for (int i = 0; i < PACKET; i += 4) {
        RtFour row[4];
        for (int k = 0; k < 4; k++) row[k] = rt_four((const char *)&rays[i + k] + offset);
        rt_four_transpose(row);
        memcpy(a + i, &row[0], sizeof row[0]);
        memcpy(b + i, &row[1], sizeof row[1]);
        memcpy(c + i, &row[2], sizeof row[2]);
        memcpy(d + i, &row[3], sizeof row[3]);
    }
}

/* The major axis where it is the same of all rays. */
RT_KERNEL bool major_axis(Packet *p) {
    RtV16 x = rt_v16_abs(rt_v16_load(p->dir[0])), y = rt_v16_abs(rt_v16_load(p->dir[1]));
    RtV16 z = rt_v16_abs(rt_v16_load(p->dir[2]));
    uint32_t not_z = rt_v16_at_most(z, x) | rt_v16_at_most(z, y),
             not_y = rt_v16_at_most(y, x) | (~not_z & EVERY);
    p->kz = not_z == 0 ? 2 : not_y == 0 ? 1 : 0;
    p->kx = (uint32_t)rt_next_axis((int)p->kz);
    p->ky = (uint32_t)rt_next_axis((int)p->kx);
    return is_uniform(not_z) && is_uniform(not_y);
}

/* The rays thickened, as rt_ray_prepare_in does or, where objects are divided, rt_surface_thicken; and what
 * lies between the least and the most of them. */
RT_KERNEL void bound(Packet *p, const RtGeometry *g, bool divided) {
    RtV16 farthest = rt_v16_all(0);
    for (int a = 0; a < 3; a++) {
        RtV16 org = rt_v16_load(p->org[a]);
        farthest = rt_v16_max(rt_v16_abs(rt_v16_sub(rt_v16_all(g->box.lo.at[a]), org)), farthest);
        farthest = rt_v16_max(rt_v16_abs(rt_v16_sub(rt_v16_all(g->box.hi.at[a]), org)), farthest);
    }
    RtV16 thickness = rt_v16_mul(farthest, rt_v16_all(0x1p-20f));
    if (divided) thickness = rt_v16_add(rt_v16_mul(rt_v16_all(2), thickness), rt_v16_all(0x1p-80f));
    for (int a = 0; a < 3; a++) {
        RtV16 org = rt_v16_load(p->org[a]), inv = rt_v16_load(p->inv[a]);
        RtV16 shift = rt_v16_add(thickness, rt_v16_mul(rt_v16_abs(org), rt_v16_all(0x1p-23f)));
        RtV16 above = rt_v16_add(org, shift), below = rt_v16_sub(org, shift);
        RtV16 near = p->negative[a] ? below : above, far = p->negative[a] ? above : below;
        uint32_t lo = 2 * (uint32_t)a * PLANE, hi = lo + PLANE;
        rt_v16_store(p->org_near[a], near);
        rt_v16_store(p->org_far[a], far);
        p->near[a] = p->negative[a] ? hi : lo;
        p->far[a] = p->negative[a] ? lo : hi;
        p->first[a] = p->negative[a] ? rt_v16_least(near) : rt_v16_most(near);
        p->last[a] = p->negative[a] ? rt_v16_most(far) : rt_v16_least(far);
        p->inv_least[a] = rt_v16_least(inv);
        p->inv_most[a] = rt_v16_most(inv);
    }
    p->tmin_least = rt_v16_least(rt_v16_load(p->tmin));
    p->limit_most = rt_v16_most(rt_v16_load(p->limit));
}

/* Makes a packet of sixteen rays; false where they do not go the same way. */
RT_KERNEL bool take_off_together(Packet *p, const RtWideTree *tree, const RtGeometry *g, const RtRay *rays) {
    if (!same_signs(&rays[0], &rays[PACKET - 1]) || !same_signs(&rays[0], &rays[PACKET / 2])) return false;
    put_fields(rays, offsetof(RtRay, org), p->org[0], p->org[1], p->org[2], p->tmin);
    put_fields(rays, offsetof(RtRay, dir), p->dir[0], p->dir[1], p->dir[2], p->tmax);
    uint32_t usual = EVERY;
    for (int a = 0; a < 3; a++) {
        RtV16 dir = rt_v16_load(p->dir[a]), inv = rt_v16_div(rt_v16_all(1), dir);
        uint32_t signs = rt_v16_signs(dir);
        rt_v16_store(p->inv[a], inv);
        usual &= rt_v16_at_most(rt_v16_abs(inv), rt_v16_all(FLT_MAX));
        p->negative[a] = signs != 0;
        if (!is_uniform(signs)) return false;
    }
    if (usual != EVERY || !major_axis(p)) return false;
    RtV16 major = rt_v16_abs(rt_v16_load(p->dir[p->kz])), inv = rt_v16_load(p->inv[p->kz]);
    uint32_t near = rt_v16_at_most(rt_v16_all(0x1p-64f), major) & rt_v16_at_most(major, rt_v16_all(0x1p64f));
    if (tree->divided && near != EVERY) return false; /* rt_surface_is_near */
    RtV16 limit = rt_v16_min(rt_v16_load(p->tmax), rt_v16_all(FLT_MAX));
    rt_v16_store(p->tmax, limit);
    rt_v16_store(p->limit, limit);
    rt_v16_store(p->shear_x, rt_v16_mul(rt_v16_load(p->dir[p->kx]), inv));
    rt_v16_store(p->shear_y, rt_v16_mul(rt_v16_load(p->dir[p->ky]), inv));
    bound(p, g, tree->divided);
    p->prepared = 0;
    for (int i = 0; i < PACKET; i++) p->best[i] = RT_MISS;
    return true;
}

/* ---- boxes ---- */

/* The children that some ray may meet, and where the first may enter each. */
RT_KERNEL uint32_t meet_together(const RtWideNode *node, const Packet *p, __m256 *enter) {
    __m256 near = _mm256_set1_ps(p->tmin_least), far = _mm256_set1_ps(p->limit_most);
    for (uint32_t a = 0; a < 3; a++) {
        __m256 least = _mm256_set1_ps(p->inv_least[a]), most = _mm256_set1_ps(p->inv_most[a]);
        __m256 first = _mm256_sub_ps(planes(node, p->near[a]), _mm256_set1_ps(p->first[a]));
        __m256 last = _mm256_sub_ps(planes(node, p->far[a]), _mm256_set1_ps(p->last[a]));
        near = _mm256_max_ps(_mm256_min_ps(_mm256_mul_ps(first, least), _mm256_mul_ps(first, most)), near);
        far = _mm256_min_ps(_mm256_max_ps(_mm256_mul_ps(last, least), _mm256_mul_ps(last, most)), far);
    }
    *enter = near;
    return rt_v8_at_most(near, far);
}

/* The rays that meet the box of one child. */
RT_KERNEL uint32_t meet_child(const RtWideTree *tree, RtWideRef parent, const Packet *p) {
    const char *lane = tree->arena + rt_wide_place(parent) + parent % RT_WIDE * sizeof(float);
    RtV16 near = rt_v16_load(p->tmin), far = rt_v16_load(p->limit);
    for (int a = 0; a < 3; a++) {
        RtV16 inv = rt_v16_load(p->inv[a]);
        RtV16 enter = rt_v16_all(*(const float *)(const void *)(lane + p->near[a]));
        RtV16 leave = rt_v16_all(*(const float *)(const void *)(lane + p->far[a]));
        near = rt_v16_max(rt_v16_mul(rt_v16_sub(enter, rt_v16_load(p->org_near[a])), inv), near);
        far = rt_v16_min(rt_v16_mul(rt_v16_sub(leave, rt_v16_load(p->org_far[a])), inv), far);
    }
    return rt_v16_at_most(near, far);
}

/* ---- leaves ---- */

RT_KERNEL const RtPreparedRay *prepared(Packet *p, uint32_t i, const RtGeometry *g, const RtRay *rays,
                                        RtCrossing *room) {
    if (!(p->prepared >> i & 1)) rt_hit_ray(&p->ray[i], g, &rays[i], room);
    p->prepared |= 1u << i;
    return &p->ray[i];
}

/* Ray i has no use for what it meets beyond `t`. */
RT_KERNEL void narrow_ray(Packet *p, uint32_t i, bool any) {
    bool over = any && p->best[i].object != RT_NO_OBJECT;
    p->limit[i] = over ? -INFINITY : rt_minf(p->best[i].t, p->limit[i]);
}

/* Pairs each ray of the mask with those triangles of a leaf that its sieve lets pass. */
RT_KERNEL void pair(Packet *p, const RtWideTriangles *blocks, uint32_t block_count, uint32_t mask) {
    Pairs *to = &p->pairs;
    uint32_t count = 0;
    for (; mask; mask &= mask - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(mask);
        Axes axes = {p->kx * COORDINATE, p->ky * COORDINATE, p->kz * COORDINATE, p->org[p->kx][i],
                     p->org[p->ky][i],   p->org[p->kz][i],   p->shear_x[i],      p->shear_y[i]};
        for (uint32_t b = 0; b < block_count; b++) {
            uint32_t passed = sieve_block(&blocks[b], &axes);
            for (uint32_t lane = 0; lane < RT_WIDE_BLOCK; lane++) {
                to->ray[count] = i;
                to->triangle[count] = &blocks[b].v[0][0][lane];
                count += passed >> lane & 1;
            }
        }
    }
    to->count = count;
}

/* Where a block has what belongs to a coordinate of a triangle, in floats from the first. */
RT_KERNEL size_t place_of(int vertex, uint32_t axis) {
    return ((size_t)vertex * 3 + axis) * RT_WIDE_BLOCK;
}

/* rt_triangle_hit of sixteen pairs, operation by operation: those that hit, and where. */
RT_KERNEL uint32_t hit_pairs(const Packet *p, const uint32_t *ray, const float *const *triangle, float *t) {
    _Alignas(RT_CACHE_LINE) float v[3][3][PACKET], x[3][PACKET], y[3][PACKET], z[3][PACKET];
    for (int k = 0; k < PACKET; k++) {
        for (int i = 0; i < 3; i++) {
            for (uint32_t a = 0; a < 3; a++) v[i][a][k] = triangle[k][place_of(i, a)];
        }
    }
    RtV16 org_x = rt_v16_lookup(p->org[p->kx], ray), shear_x = rt_v16_lookup(p->shear_x, ray);
    RtV16 org_y = rt_v16_lookup(p->org[p->ky], ray), shear_y = rt_v16_lookup(p->shear_y, ray);
    RtV16 org_z = rt_v16_lookup(p->org[p->kz], ray);
    for (int i = 0; i < 3; i++) {
        RtV16 depth = rt_v16_sub(rt_v16_load(v[i][p->kz]), org_z);
        RtV16 across = rt_v16_sub(rt_v16_load(v[i][p->kx]), org_x),
              up = rt_v16_sub(rt_v16_load(v[i][p->ky]), org_y);
        rt_v16_store(z[i], depth);
        rt_v16_store(x[i], rt_v16_sub(across, rt_v16_mul(shear_x, depth)));
        rt_v16_store(y[i], rt_v16_sub(up, rt_v16_mul(shear_y, depth)));
    }
    _Alignas(RT_CACHE_LINE) float major[PACKET];
    rt_v16_store(major, rt_v16_lookup(p->dir[p->kz], ray));
    uint32_t hit = 0;
    for (int k = 0; k < PACKET; k += 4) {
        const __m256d zero = _mm256_setzero_pd();
        __m256d a[3], b[3], c[3];
        for (int i = 0; i < 3; i++) {
            a[i] = _mm256_cvtps_pd(_mm_load_ps(&x[i][k]));
            b[i] = _mm256_cvtps_pd(_mm_load_ps(&y[i][k]));
            c[i] = _mm256_cvtps_pd(_mm_load_ps(&z[i][k]));
        }
        __m256d e0 = _mm256_sub_pd(_mm256_mul_pd(a[2], b[1]), _mm256_mul_pd(b[2], a[1]));
        __m256d e1 = _mm256_sub_pd(_mm256_mul_pd(a[0], b[2]), _mm256_mul_pd(b[0], a[2]));
        __m256d e2 = _mm256_sub_pd(_mm256_mul_pd(a[1], b[0]), _mm256_mul_pd(b[1], a[0]));
        __m256d least = _mm256_min_pd(_mm256_min_pd(e0, e1), e2),
                most = _mm256_max_pd(_mm256_max_pd(e0, e1), e2);
        __m256d determinant = _mm256_add_pd(_mm256_add_pd(e0, e1), e2);
        __m256d inside =
            _mm256_or_pd(_mm256_cmp_pd(least, zero, _CMP_GE_OQ), _mm256_cmp_pd(most, zero, _CMP_LE_OQ));
        inside = _mm256_and_pd(inside, _mm256_cmp_pd(determinant, zero, _CMP_NEQ_OQ));
        __m256d depth = _mm256_add_pd(_mm256_mul_pd(e0, c[0]), _mm256_mul_pd(e1, c[1]));
        depth = _mm256_div_pd(_mm256_add_pd(depth, _mm256_mul_pd(e2, c[2])), determinant);
        _mm_store_ps(&t[k], _mm256_cvtpd_ps(_mm256_div_pd(depth, _mm256_cvtps_pd(_mm_load_ps(&major[k])))));
        hit |= (uint32_t)_mm256_movemask_pd(inside) << k;
    }
    /* rt_box_admit */
    RtV16 lo[3], hi[3], org[3], farthest = rt_v16_all(0);
    for (int a = 0; a < 3; a++) {
        RtV16 v0 = rt_v16_load(v[0][a]), v1 = rt_v16_load(v[1][a]), v2 = rt_v16_load(v[2][a]);
        lo[a] = rt_v16_min(rt_v16_min(v0, v1), v2);
        hi[a] = rt_v16_max(rt_v16_max(v0, v1), v2);
        org[a] = rt_v16_lookup(p->org[a], ray);
        farthest = rt_v16_max(rt_v16_abs(rt_v16_sub(lo[a], org[a])), farthest);
        farthest = rt_v16_max(rt_v16_abs(rt_v16_sub(hi[a], org[a])), farthest);
    }
    RtV16 thickness = rt_v16_mul(farthest, rt_v16_all(0x1p-20f));
    RtV16 near = rt_v16_all(-INFINITY), far = rt_v16_all(INFINITY), at = rt_v16_load(t);
    for (int a = 0; a < 3; a++) {
        RtV16 shift = rt_v16_add(thickness, rt_v16_mul(rt_v16_abs(org[a]), rt_v16_all(0x1p-23f)));
        RtV16 above = rt_v16_add(org[a], shift), below = rt_v16_sub(org[a], shift),
              inv = rt_v16_lookup(p->inv[a], ray);
        RtV16 first = rt_v16_sub(p->negative[a] ? hi[a] : lo[a], p->negative[a] ? below : above);
        RtV16 second = rt_v16_sub(p->negative[a] ? lo[a] : hi[a], p->negative[a] ? above : below);
        near = rt_v16_max(rt_v16_mul(first, inv), near);
        far = rt_v16_min(rt_v16_mul(second, inv), far);
    }
    RtV16 clamped = rt_v16_min(far, rt_v16_max(near, at)); /* what is no number stays so, and is no hit */
    hit &= rt_v16_at_most(near, far) & rt_v16_at_most(rt_v16_lookup(p->tmin, ray), clamped);
    hit &= rt_v16_at_most(clamped, rt_v16_lookup(p->tmax, ray));
    rt_v16_store(t, clamped);
    return hit;
}

/* A batch costs as much as so many triangles tested alone. */
enum { WORTH_A_BATCH = 4 };

RT_KERNEL void test_pairs(Packet *p, const RtGeometry *g, const RtRay *rays, bool any, RtCrossing *room) {
    Pairs *pairs = &p->pairs;
    for (uint32_t k = 0; k < pairs->count; k += PACKET) {
        _Alignas(RT_CACHE_LINE) float t[PACKET];
        uint32_t left = pairs->count - k, some = left < PACKET ? (1u << left) - 1 : EVERY;
        if (left >= WORTH_A_BATCH) {
            for (uint32_t i = left; i < PACKET; i++) {
                pairs->ray[k + i] = pairs->ray[k];
                pairs->triangle[k + i] = pairs->triangle[k];
            }
            some &= hit_pairs(p, &pairs->ray[k], &pairs->triangle[k], t);
        }
        for (; some; some &= some - 1) {
            uint32_t i = k + (uint32_t)__builtin_ctz(some), ray = pairs->ray[i], id;
            const float *triangle = pairs->triangle[i];
            memcpy(&id, triangle + place_of(3, 0), sizeof id);
            if (left < WORTH_A_BATCH && !rt_triangle_hit_strided(triangle, VERTEX, RT_WIDE_BLOCK,
                                                                 prepared(p, ray, g, rays, room), &t[i - k]))
                continue;
            if (rt_hit_before(t[i - k], id, p->best[ray])) p->best[ray] = (RtHit){t[i - k], id};
            narrow_ray(p, ray, any);
        }
    }
}

/* Tests a leaf for the rays of the mask. */
RT_KERNEL void test_leaf(Packet *p, const RtWideTree *tree, const RtGeometry *g, const RtRay *rays,
                         RtWideRef ref, uint32_t mask, bool any, RtCrossing *room) {
    if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) {
        pair(p, rt_wide_leaf_at(tree, ref), rt_wide_count(ref) > RT_WIDE_BLOCK ? 2 : 1, mask);
        test_pairs(p, g, rays, any, room);
        return;
    }
    for (; mask; mask &= mask - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(mask);
        test_objects(tree, g, ref, prepared(p, i, g, rays, room), any, &p->best[i], NULL);
        narrow_ray(p, i, any);
    }
}

/* ---- the way through ---- */

RT_KERNEL void fly_together(const RtWide *self, const RtWideTree *tree, Packet *p, const RtRay *rays,
                            bool any, RtCrossing *room) {
    const RtGeometry *g = &self->base.scene->geometry;
    const bool ordered = !any && self->order;
    const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    uint32_t top = 0, quarters = 0;
    RtWideRef ref = 0, parent = 0;
    for (;;) {
        if (rt_wide_kind(ref) == RT_WIDE_NODE) {
            const RtWideNode *node = rt_wide_node(tree, ref);
            __m256 enter;
            uint32_t mask = meet_together(node, p, &enter);
            quarters += NODE_QUARTERS;
            if (mask) {
                uint32_t lane = choose(mask, enter, ordered), others = mask & ~(1u << lane);
                RtV8Order order = rt_v8_order(others);
                rt_v8_put(&p->enter[top], rt_v8_take(order, _mm256_castps_si256(enter)));
                rt_v8_put(&p->waiting[top], rt_v8_take(order, rt_v8_get(node->child)));
                rt_v8_put(&p->parent[top],
                          rt_v8_take(order, _mm256_add_epi32(_mm256_set1_epi32((int)ref), lanes)));
                top += (uint32_t)__builtin_popcount(others);
                if (others && self->prefetch) prefetch(tree, p->waiting[top - 1]);
                parent = ref + lane;
                ref = node->child[lane];
                continue;
            }
        } else {
            uint32_t mask = meet_child(tree, parent, p);
            quarters += LEAF_QUARTERS + RAY_QUARTERS * (uint32_t)__builtin_popcount(mask);
            if (mask) {
                test_leaf(p, tree, g, rays, ref, mask, any, room);
                p->limit_most = rt_v16_most(rt_v16_load(p->limit));
                if (p->limit_most < 0) break;
            }
        }
        do {
            if (top == 0) goto landed;
            top--;
        } while (p->enter[top] > p->limit_most);
        ref = p->waiting[top];
        parent = p->parent[top];
    }
landed:
    p->visits += quarters / 4;
}

#endif
