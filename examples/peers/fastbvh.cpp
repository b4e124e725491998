// SPDX-License-Identifier: Apache-2.0
//
// fastbvh: brandonpelfrey/Fast-BVH, with its only builder of a tree (halves by centre, leaves of at most four
// triangles). It has no triangle test of its own: as in its benchmark the intersector is that of Möller and
// Trumbore, here with edges computed in advance. Its loop knows no largest t, so a hit beyond that is dropped
// only once it is found. OnlyTestOcclusion answers any-hit rays. One thread, one ray at a time.
#include "peer.h"

#include <FastBVH.h>

#include <vector>

namespace {

using Vec3 = FastBVH::Vector3<float>;
using BBox = FastBVH::BBox<float>;

struct Triangle {
    Vec3 vertex, edge1, edge2;
    std::uint32_t object;
};

using Hit = FastBVH::Intersection<float, Triangle>;

Vec3 vec3(const float *v) {
    return {v[0], v[1], v[2]};
}

BBox box_of(const raytally_build_input &from, std::uint32_t object) {
    return {vec3(from.boxes[object].lo), vec3(from.boxes[object].hi)};
}

struct Intersector {
    float tmin, tmax;

    Hit operator()(const Triangle &triangle, const FastBVH::Ray<float> &ray) const noexcept {
        const Vec3 p = cross(ray.d, triangle.edge2);
        const float inverse = 1 / dot(triangle.edge1, p);
        const Vec3 s = ray.o - triangle.vertex;
        const float u = dot(s, p) * inverse;
        const Vec3 q = cross(s, triangle.edge1);
        const float v = dot(ray.d, q) * inverse, t = dot(triangle.edge2, q) * inverse;
        if (!(u >= 0 && v >= 0 && u + v <= 1 && t >= tmin && t <= tmax)) return {};
        return {t, &triangle, {0, 0, 1}, {u, v}};
    }
};

class Library {
  public:
    explicit Library(const raytally_build_input &from) : triangles_(triangles_of(from)), bvh_(build(from)) {
    }

    void nearest(const raytally_ray *rays, std::size_t count, raytally_hit *hits) const {
        for (std::size_t i = 0; i < count; i++) {
            const peer::Ray ray(rays[i]);
            const Hit hit = trace<FastBVH::TraverserFlags(0)>(ray);
            hits[i] = hit ? ray.hit(hit.t, hit.object->object) : peer::miss;
        }
    }

    void occluded(const raytally_ray *rays, std::size_t count, std::uint32_t *occluders) const {
        for (std::size_t i = 0; i < count; i++)
            occluders[i] = peer::occluder(trace<FastBVH::OnlyTestOcclusion>(peer::Ray(rays[i])));
    }

    void describe(raytally_description &out) const {
        const auto nodes = bvh_.getNodes();
        out.leaves = bvh_.countLeafs();
        out.interior = nodes.size() - out.leaves;
        out.references = triangles_.size();
        out.depth = depth(0);
        out.bytes = nodes.size() * sizeof *nodes.begin() + triangles_.size() * sizeof(Triangle);
    }

  private:
    static std::vector<Triangle> triangles_of(const raytally_build_input &from) {
        peer::require_triangles(from);
        std::vector<Triangle> triangles;
        for (std::uint32_t i = 0; i < from.triangle_count; i++) {
            const Vec3 a = vec3(peer::corner(from, i, 0));
            triangles.push_back(
                {a, vec3(peer::corner(from, i, 1)) - a, vec3(peer::corner(from, i, 2)) - a, i});
        }
        return triangles;
    }

    FastBVH::BVH<float, Triangle> build(const raytally_build_input &from) {
        return FastBVH::DefaultBuilder<float>()(
            triangles_, [&](const Triangle &one) { return box_of(from, one.object); });
    }

    std::size_t depth(std::size_t at) const {
        const auto &node = *(bvh_.getNodes().begin() + at);
        return node.isLeaf() ? 0 : 1 + std::max(depth(at + 1), depth(at + node.right_offset));
    }

    template <FastBVH::TraverserFlags flags> Hit trace(const peer::Ray &from) const {
        const Intersector intersector{from.tmin, from.tmax};
        return FastBVH::Traverser<float, Triangle, Intersector, flags>(bvh_, intersector)
            .traverse({vec3(from.org), vec3(from.dir)});
    }

    std::vector<Triangle> triangles_; // the builder sorts them
    FastBVH::BVH<float, Triangle> bvh_;
};

constexpr raytally_accel_ops table =
    peer::ops<Library>("fastbvh", "brandonpelfrey/Fast-BVH as it is",
                       "Rubin and Whitted 1980, A 3-dimensional representation for fast rendering of complex "
                       "scenes, SIGGRAPH '80",
                       nullptr, 0);

} // namespace

RAYTALLY_PLUGIN {
    return index == 0 ? &table : nullptr;
}
