// SPDX-License-Identifier: Apache-2.0
//
// peer.h: what the plugins of this folder share. A peer is a whole ray-tracing library, measured as it is:
// its builder, its layout, its loop and its own triangle test (RAYTALLY_OWN_HITS). peer::ops makes an
// accelerator of a class with these members; a library without an any-hit query answers the nearest hit.
//
//     explicit Library(const raytally_build_input &); // may throw peer::Refused
//     void nearest(const raytally_ray *rays, std::size_t count, raytally_hit *hits) const;
//     void occluded(const raytally_ray *rays, std::size_t count, std::uint32_t *occluders) const;
//     void describe(raytally_description &out) const; // at least the bytes
//
// Rays are converted to the library's type within the time that is measured, as in a program that calls it.
#ifndef RAYTALLY_PEER_H
#define RAYTALLY_PEER_H

#include <raytally/accel.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <new>
#include <stdexcept>

namespace peer {

/// Why a scene cannot be built: a sentence for the user.
struct Refused : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Refuses scenes that are not made of triangles alone. In all others triangle i is object i.
inline void require_triangles(const raytally_build_input &from) {
    if (from.triangle_count != from.object_count)
        throw Refused("it knows triangles only; this scene has other objects");
}

/// The corner 0, 1 or 2 of a triangle: x, y, z.
inline const float *corner(const raytally_build_input &from, std::size_t triangle, std::size_t which) {
    return &from.triangles[9 * triangle + 3 * which];
}

/// A miss.
constexpr raytally_hit miss{std::numeric_limits<float>::infinity(), RAYTALLY_NO_OBJECT};

/// The answer of a library that says only whether something lies on the ray.
constexpr std::uint32_t occluder(bool hit) {
    return hit ? RAYTALLY_UNNAMED_OBJECT : RAYTALLY_NO_OBJECT;
}

/// A ray as libraries expect it. They compare with small constants, so if the direction is far from unit
/// length, it is scaled by a power of two, which is exact; t then counts another unit. Rays of `bench` seldom
/// need it, those of `verify` often.
struct Ray : raytally_ray {
    float unit = 1;

    explicit Ray(const raytally_ray &from) : raytally_ray(from) {
        const float longest = std::max({std::fabs(dir[0]), std::fabs(dir[1]), std::fabs(dir[2])});
        if (longest > 0x1p-12F && longest < 0x1p12F) return;
        unit = std::ldexp(1.0F, std::ilogb(longest));
        for (float &d : dir) d /= unit;
        tmin *= unit;
        tmax *= unit;
    }
    /// The answer to raytally, from a t of this ray.
    raytally_hit hit(float t, std::uint32_t object) const {
        return {t / unit, object};
    }
};

/// The table of an accelerator; `ops.flags` (with more, such as RAYTALLY_ABSOLUTE_HITS) and all functions are
/// set, names and parameters are the plugin's.
template <typename Library>
constexpr raytally_accel_ops ops(const char *name, const char *summary, const char *paper,
                                 const raytally_param *params, std::uint32_t param_count,
                                 std::uint64_t more_flags = 0) {
    raytally_accel_ops ops{};
    ops.abi = RAYTALLY_ACCEL_ABI;
    ops.size = sizeof ops;
    ops.name = name;
    ops.summary = summary;
    ops.paper = paper;
    ops.params = params;
    ops.param_count = param_count;
    ops.flags = RAYTALLY_OWN_HITS | RAYTALLY_NO_COUNTS | more_flags;
    ops.build = [](const raytally_build_input *from, void **self) -> int {
        try {
            if (from->object_count == 0) throw Refused("the scene is empty");
            *self = new Library(*from);
            return RAYTALLY_BUILD_OK;
        } catch (const Refused &why) {
            std::snprintf(from->message, from->message_room, "%s", why.what());
            return RAYTALLY_BUILD_REFUSED;
        } catch (...) { // no exception may leave a plugin
            return RAYTALLY_BUILD_NO_MEMORY;
        }
    };
    ops.destroy = [](void *self) { delete static_cast<Library *>(self); };
    ops.nearest = [](const void *self, void *, raytally_query *, const raytally_ray *rays, std::size_t count,
                     raytally_hit *hits,
                     raytally_counters *) { static_cast<const Library *>(self)->nearest(rays, count, hits); };
    ops.occluded = [](const void *self, void *, raytally_query *, const raytally_ray *rays, std::size_t count,
                      std::uint32_t *occluders, raytally_counters *) {
        static_cast<const Library *>(self)->occluded(rays, count, occluders);
    };
    ops.describe = [](const void *self, raytally_description *out) {
        static_cast<const Library *>(self)->describe(*out);
    };
    return ops;
}

} // namespace peer

#endif
