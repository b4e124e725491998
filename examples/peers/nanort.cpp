// SPDX-License-Identifier: Apache-2.0
//
// nanort: lighttransport/nanort with its default options: a binary tree by SAH in bins, leaves of at most
// four triangles, its watertight triangle test. Not its newest commit: since 5ef99d0 (2023) its builder fills
// the bins of the x axis alone, and traces sixty times slower; this is the commit before. It has no any-hit
// query, so occluded searches the nearest hit, as its examples do for shadows. It has no packets. It builds
// on one thread: its parallel builder takes all processors and makes another tree.
#include "peer.h"

#include <nanort.h>

#include <numeric>
#include <vector>

namespace {

enum { LEAF, BINS, PARAMS };
const raytally_param params[PARAMS] = {
    {"leaf", RAYTALLY_INT, "4", 1, 64, nullptr, "1|4|16", "the most triangles of a leaf", "nanort.h"},
    {"bins", RAYTALLY_INT, "64", 2, 1024, nullptr, "16|64", "bins along an axis", "nanort.h"},
};

class Library {
  public:
    explicit Library(const raytally_build_input &from)
        : vertices_(from.triangles), faces_(3 * std::size_t{from.triangle_count}) {
        peer::require_triangles(from);
        std::iota(faces_.begin(), faces_.end(), 0U);
        nanort::BVHBuildOptions<float> options;
        options.min_leaf_primitives = static_cast<unsigned>(from.values[LEAF].integer);
        options.bin_size = static_cast<unsigned>(from.values[BINS].integer);
        options.cache_bbox = true; // the same tree, built faster
        const nanort::TriangleMesh<float> mesh(vertices_, faces_.data(), stride);
        const nanort::TriangleSAHPred<float> sah(vertices_, faces_.data(), stride);
        if (!bvh_.Build(from.triangle_count, mesh, sah, options))
            throw peer::Refused("it cannot build this scene");
    }

    void nearest(const raytally_ray *rays, std::size_t count, raytally_hit *hits) const {
        const nanort::TriangleIntersector<float> intersector(vertices_, faces_.data(), stride);
        for (std::size_t i = 0; i < count; i++) {
            const peer::Ray from(rays[i]);
            nanort::Ray<float> ray;
            std::copy_n(from.org, 3, ray.org);
            std::copy_n(from.dir, 3, ray.dir);
            ray.min_t = from.tmin;
            ray.max_t = from.tmax;
            nanort::TriangleIntersection<float> hit;
            hits[i] = bvh_.Traverse(ray, intersector, &hit) ? from.hit(hit.t, hit.prim_id) : peer::miss;
        }
    }

    void occluded(const raytally_ray *rays, std::size_t count, std::uint32_t *occluders) const {
        for (std::size_t i = 0; i < count; i++) {
            raytally_hit hit;
            nearest(&rays[i], 1, &hit);
            occluders[i] = hit.object;
        }
    }

    void describe(raytally_description &out) const {
        const nanort::BVHBuildStatistics statistics = bvh_.GetStatistics();
        out.interior = statistics.num_branch_nodes;
        out.leaves = statistics.num_leaf_nodes;
        out.references = bvh_.GetIndices().size();
        out.depth = statistics.max_tree_depth;
        out.bytes = bvh_.GetNodes().size() * sizeof(nanort::BVHNode<float>) +
                    bvh_.GetIndices().size() * sizeof(unsigned) +
                    faces_.size() * (sizeof(unsigned) + 3 * sizeof(float)); // it reads the caller's mesh
    }

  private:
    static constexpr std::size_t stride = 3 * sizeof(float);

    const float *vertices_;
    std::vector<unsigned> faces_;
    nanort::BVHAccel<float> bvh_;
};

constexpr raytally_accel_ops table =
    peer::ops<Library>("nanort", "lighttransport/nanort as it is",
                       "Woop et al. 2013, Watertight Ray/Triangle Intersection, JCGT 2(1)", params, PARAMS);

} // namespace

RAYTALLY_PLUGIN {
    return index == 0 ? &table : nullptr;
}
