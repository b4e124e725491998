/* SPDX-License-Identifier: Apache-2.0 */
#include "render/illumination.h"

#include "core/base/elementary.h"

static double max_norm(RtVec3d a) {
    return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z)));
}

/* `way`: the distance that the ray travelled, in the max norm. */
static double offset_of(const RtGeometry *g, uint32_t object, RtVec3d point, double way) {
    double reach = fmax(max_norm(point), way);
    double own = (double)rt_thickness(rt_narrow(point), &g->boxes[object]);
    double scene = (double)rt_thickness(rt_narrow(point), &g->box);
    return 0x1p-21 * reach + 2 * own + fmin(scene, 0x1p-18 * reach);
}

/* The colour that the texture of material `m` has at a point of the object. */
static RtVec3 textured_color(const RtScene *scene, const RtMaterial *m, uint32_t object, RtVec3d point,
                             RtVec3d normal) {
    const RtGeometry *g = &scene->geometry;
    const RtShape shape = rt_ref_shape(g->objects[object]);
    const uint32_t index = rt_ref_index(g->objects[object]);
    const RtTriangleTexture *corners =
        shape == RT_SHAPE_TRIANGLE ? rt_scene_triangle_texture(scene, index) : NULL;
    double u = 0, v = 0;
    if (shape == RT_SHAPE_SPHERE) {
        const RtVec3d p = rt_subd(point, rt_widen(g->spheres[index].center));
        u = rt_angle(p.y, p.x) / 360 + 0.5;
        v = fmin(rt_angle(p.z, sqrt(p.x * p.x + p.y * p.y)) / 180 + 0.5, 1 - 0x1p-53); /* 1 would repeat 0 */
    } else if (corners) {
        const RtVec3d weights = rt_triangle_weights(&g->triangles[index], point);
        for (int i = 0; i < 3; i++) {
            u += weights.at[i] * (double)corners->at[i].u;
            v += weights.at[i] * (double)corners->at[i].v;
        }
    } else {
        const RtVec3d p = rt_subd(point, rt_widen(m->texture.origin));
        const int axis = rt_major_axis(rt_narrow(normal));
        u = p.at[axis == 0 ? 1 : 0];
        v = p.at[axis == 2 ? 1 : 2];
    }
    return rt_texture_color(&m->texture, m->color, u, v);
}

RtSurface rt_surface(const RtScene *scene, const RtRay *ray, RtHit hit, RtHitMemory *hit_memory) {
    RtPlace place;
    rt_scene_place(scene, hit.object, ray, &place);
    const RtGeometry *g = &place.scene->geometry;
    const RtVec3d point = rt_ray_point(ray, hit.t);
    RtNormals normals = rt_object_normals(g, place.object, &place.ray, hit.t, hit_memory);
    const RtMaterial *material = place.material;
    if (!material)
        material =
            &scene->materials[normals.solid == RT_NO_SOLID ? place.scene->material_of[place.object]
                                                           : g->forest.set.solids[normals.solid].material];
    const RtVec3 color = material->texture.kind == RT_TEXTURE_NONE
                             ? material->color
                             : textured_color(place.scene, material, place.object,
                                              rt_ray_point(&place.ray, hit.t), normals.geometric);
    if (place.scene != scene) {
        normals.geometric = rt_normalized(rt_transform_normald(&place.to_world, normals.geometric));
        normals.shading = rt_normalized(rt_transform_normald(&place.to_world, normals.shading));
    }
    RtVec3d dir = rt_widen(ray->dir);
    bool entering = rt_dotd(dir, normals.geometric) < 0;
    RtVec3d side = entering ? normals.geometric : rt_scaled(normals.geometric, -1);
    bool turn = rt_dotd(normals.shading, side) < 0;
    return (RtSurface){
        .material = material,
        .color = color,
        .point = point,
        .arriving = rt_normalized(dir),
        .side = side,
        .normal = turn ? rt_scaled(normals.shading, -1) : normals.shading,
        .offset = offset_of(&scene->geometry, rt_geometry_holder(&scene->geometry, hit.object), point,
                            (double)hit.t * max_norm(dir)),
        .entering = entering,
    };
}

RtSurface rt_surface_outward(const RtSurface *surface) {
    RtSurface outward = *surface;
    if (surface->entering) return outward;
    outward.side = rt_scaled(surface->side, -1);
    outward.normal = rt_scaled(surface->normal, -1);
    return outward;
}

RtVec3 rt_ambient_light(const RtScene *scene, const RtSurface *surface) {
    return rt_scale(rt_mul(surface->color, scene->ambient), surface->material->ambient);
}

/* `dir` mirrored at the plane with unit normal `n`. */
static RtVec3d mirrored(RtVec3d dir, RtVec3d n) {
    return rt_add_scaledd(dir, n, -2 * rt_dotd(dir, n));
}

/* A ray that starts on the side `away` * surface->side, away = +1 or -1. */
static RtRay start_ray(const RtSurface *surface, double away, RtVec3d dir, RtRayKind kind) {
    RtVec3d org = rt_add_scaledd(surface->point, surface->side, away * surface->offset);
    return (RtRay){.org = rt_narrow(org), .dir = rt_narrow(dir), .tmax = INFINITY, .kind = kind};
}

static RtVec3d direction_to(const RtSurface *surface, const RtLight *light) {
    return rt_normalized(rt_subd(rt_widen(light->position), surface->point));
}

/* kd (N.L) */
static RtVec3 matte_light(const RtSurface *surface, RtVec3d to_light) {
    return rt_scale(surface->color,
                    (float)((double)surface->material->diffuse * rt_dotd(surface->normal, to_light)));
}

/* ks (R.V)^shine */
static RtVec3 highlight(const RtSurface *surface, RtVec3d to_light) {
    const RtMaterial *m = surface->material;
    double r_dot_v = rt_dotd(mirrored(to_light, surface->normal), surface->arriving);
    if (!(m->specular > 0 && r_dot_v > 0)) return rt_vec3(0, 0, 0);
    const float light = (float)((double)m->specular * rt_power(r_dot_v, (double)m->shine));
    return rt_vec3(light, light, light);
}

RtVec3 rt_diffuse_light(const RtScene *scene, const RtSurface *surface, uint32_t index) {
    const RtLight *source = &scene->lights[index];
    return rt_mul(source->intensity, matte_light(surface, direction_to(surface, source)));
}

bool rt_shadow_ray(const RtScene *scene, const RtSurface *surface, uint32_t index, RtRay *ray,
                   RtVec3 *light) {
    const RtLight *source = &scene->lights[index];
    RtVec3d to_light = direction_to(surface, source);
    if (!(rt_dotd(surface->normal, to_light) > 0) || !(rt_dotd(surface->side, to_light) > 0)) return false;

    *ray = start_ray(surface, 1, to_light, RT_RAY_SHADOW);
    ray->dir = rt_sub(source->position, ray->org);
    ray->tmax = 1;
    ray->source = index;
    if (!rt_ray_is_valid(ray)) return false;

    *light = rt_mul(source->intensity, rt_add(matte_light(surface, to_light), highlight(surface, to_light)));
    return true;
}

static RtVec3d reflected(const RtSurface *surface) {
    RtVec3d dir = mirrored(surface->arriving, surface->normal);
    if (!(rt_dotd(dir, surface->side) > 0)) dir = mirrored(surface->arriving, surface->side);
    return rt_normalized(dir);
}

/* Snell's law in vectors; false under total internal reflection. `ratio`: the index of refraction on this
 * side over that on the other. */
static bool refract(RtVec3d arriving, RtVec3d n, double ratio, RtVec3d *dir) {
    double cosine = -rt_dotd(arriving, n);
    double squared = 1 - ratio * ratio * (1 - cosine * cosine);
    if (squared < 0) return false;
    *dir = rt_normalized(rt_add_scaledd(rt_scaled(arriving, ratio), n, ratio * cosine - sqrt(squared)));
    return true;
}

static bool transmitted(const RtSurface *surface, RtVec3d *dir) {
    double ior = (double)surface->material->ior, ratio = surface->entering ? 1 / ior : ior;
    bool seen = rt_dotd(surface->arriving, surface->normal) < 0;
    if (!refract(surface->arriving, seen ? surface->normal : surface->side, ratio, dir)) return false;
    if (rt_dotd(*dir, surface->side) < 0) return true;
    return refract(surface->arriving, surface->side, ratio, dir);
}

uint32_t rt_spawn_rays(const RtSurface *surface, RtRay rays[RT_MAX_SPAWN], float factors[RT_MAX_SPAWN]) {
    const RtMaterial *m = surface->material;
    RtVec3d through;
    bool passes = m->transmission > 0 && transmitted(surface, &through);
    float mirror = m->reflection;
    if (m->transmission > 0 && !passes) mirror += m->transmission;

    uint32_t count = 0;
    if (mirror > 0) {
        rays[count] = start_ray(surface, 1, reflected(surface), RT_RAY_REFLECTION);
        factors[count] = mirror;
        count += rt_ray_is_valid(&rays[count]);
    }
    if (passes) {
        rays[count] = start_ray(surface, -1, through, RT_RAY_TRANSMISSION);
        factors[count] = m->transmission;
        count += rt_ray_is_valid(&rays[count]);
    }
    return count;
}
