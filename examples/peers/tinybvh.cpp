// SPDX-License-Identifier: Apache-2.0
//
// tinybvh: jbikker/tinybvh 1.6.7, as its own speed test uses it: by default the layout that its README calls
// the fastest on a CPU, BVH8_CPU, over a tree with spatial splits (BuildHQ), and IsOccluded for any-hit rays.
// Directions are normalised, as its rays need: the empty slots of its wide nodes are boxes at 1e30 on the
// diagonal, which a ray with a longer direction meets. Its packets of 256 rays are left out: they want one
// origin and a fixed pattern, and the library calls them a proof of concept.
#include "peer.h"

#define TINYBVH_IMPLEMENTATION
#include <tiny_bvh.h>

#include <variant>
#include <vector>

namespace {

using namespace tinybvh;

enum { LAYOUT, BUILD, OPTIMIZE, PARAMS };

const raytally_param params[PARAMS] = {
    {"layout", RAYTALLY_CHOICE, "bvh8", 0, 0, "bvh2|soa|bvh4|bvh8", nullptr,
     "BVH; BVH_SoA, SSE; BVH4_CPU, SSE; BVH8_CPU, AVX2", "tinybvh, README"},
    {"build", RAYTALLY_CHOICE, "spatial", 0, 0, "binned|spatial", nullptr,
     "Build: SAH in bins; BuildHQ: with spatial splits", "tinybvh, tiny_bvh_speedtest.cpp"},
    {"optimize", RAYTALLY_INT, "0", 0, 1000, nullptr, "0|25", "rounds of reinsertion after building",
     "tinybvh, README"},
};

// The binary tree that a layout is made from.
template <typename Layout> auto &tree_of(Layout &layout) {
    if constexpr (requires { layout.bvh8; })
        return layout.bvh8.bvh;
    else if constexpr (requires { layout.bvh4; })
        return layout.bvh4.bvh;
    else if constexpr (requires { layout.bvh; })
        return layout.bvh;
    else
        return layout;
}

// A ray of the library: from t = 0 on, for it has no least t, and with a direction of length 1, so t counts
// lengths. The origin moves, with rounding, only if tmin is not 0, as in `verify`.
struct UnitRay {
    const raytally_ray &from;
    double length;
    float end;
    tinybvh::Ray ray;

    explicit UnitRay(const raytally_ray &of) : from(of) {
        const double x = of.dir[0], y = of.dir[1], z = of.dir[2], tmin = of.tmin;
        length = std::sqrt(x * x + y * y + z * z);
        end = static_cast<float>(std::min((of.tmax - tmin) * length, double{BVH_FAR}));
        ray.O = vec3(of.org[0] + tmin * x, of.org[1] + tmin * y, of.org[2] + tmin * z);
        ray.D = vec3(x / length, y / length, z / length);
        ray.rD = tinybvh_rcp(ray.D);
        ray.hit.t = end;
    }
    raytally_hit answer() const {
        if (!(ray.hit.t < end)) return peer::miss;
        return {std::min(static_cast<float>(from.tmin + ray.hit.t / length), from.tmax), ray.hit.prim};
    }
    static bvhvec3 vec3(double x, double y, double z) {
        return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    }
};

class Library {
  public:
    explicit Library(const raytally_build_input &from) {
        peer::require_triangles(from);
        vertices_.resize(3 * std::size_t{from.triangle_count});
        for (std::size_t i = 0; i < vertices_.size(); i++) {
            const float *v = peer::corner(from, i / 3, i % 3);
            vertices_[i] = {v[0], v[1], v[2], 0};
        }
        switch (from.values[LAYOUT].choice) {
        case 0: build(std::get<BVH>(layout_), from); break;
        case 1: build(layout_.emplace<BVH_SoA>(), from); break;
        case 2: build(layout_.emplace<BVH4_CPU>(), from); break;
        default: build(layout_.emplace<BVH8_CPU>(), from);
        }
    }

    void nearest(const raytally_ray *rays, std::size_t count, raytally_hit *hits) const {
        const auto trace = [&](const auto &bvh) {
            for (std::size_t i = 0; i < count; i++) {
                UnitRay of(rays[i]);
                bvh.Intersect(of.ray);
                hits[i] = of.answer();
            }
        };
        std::visit(trace, layout_);
    }

    void occluded(const raytally_ray *rays, std::size_t count, std::uint32_t *occluders) const {
        const auto trace = [&](const auto &bvh) {
            for (std::size_t i = 0; i < count; i++)
                occluders[i] = peer::occluder(bvh.IsOccluded(UnitRay(rays[i]).ray));
        };
        std::visit(trace, layout_);
    }

    void describe(raytally_description &out) const {
        out.bytes = std::visit([](const auto &bvh) { return bytes_of(bvh); }, layout_);
    }

  private:
    template <typename Layout> void build(Layout &bvh, const raytally_build_input &from) {
        tree_of(bvh).threadedBuild = from.threads > 1;
        const bool spatial = from.values[BUILD].choice == 1;
        if (spatial)
            bvh.BuildHQ(vertices_.data(), from.triangle_count);
        else
            bvh.Build(vertices_.data(), from.triangle_count);
        const auto rounds = static_cast<std::uint32_t>(from.values[OPTIMIZE].integer);
        if (rounds > 0) bvh.Optimize(rounds, true);
    }

    // What tracing reads. The narrow layouts read the vertices too, which the others copy.
    template <typename Layout> static std::size_t bytes_of(const Layout &layout) {
        if constexpr (requires { layout.usedBlocks; })
            return layout.usedBlocks * 64;
        else
            return layout.usedNodes * sizeof *layout.bvhNode +
                   tree_of(layout).idxCount * sizeof(std::uint32_t) + layout.triCount * 3 * sizeof(bvhvec4);
    }

    std::vector<bvhvec4> vertices_;
    std::variant<BVH, BVH_SoA, BVH4_CPU, BVH8_CPU> layout_;
};

constexpr raytally_accel_ops table = peer::ops<Library>(
    "tinybvh", "jbikker/tinybvh as it is",
    "Fuetterling et al. 2017, Accelerated Single Ray Tracing for Wide Vector Units, HPG'17", params, PARAMS,
    RAYTALLY_ABSOLUTE_HITS); // its box tests multiply the origin out

} // namespace

RAYTALLY_PLUGIN {
    return index == 0 ? &table : nullptr;
}
