// SPDX-License-Identifier: Apache-2.0
//
// madmann91: madmann91/bvh, version 2, as its simple example and its benchmark use it: binary nodes, the tree
// of quality High, triangles precomputed and in the order of the leaves, the fast box test. `robust` selects
// the slower box test that its README offers. One ray at a time: the library has no packets. It builds on one
// thread: its parallel builder makes another tree.
#include "peer.h"

#include <bvh/v2/bvh.h>
#include <bvh/v2/default_builder.h>
#include <bvh/v2/node.h>
#include <bvh/v2/ray.h>
#include <bvh/v2/stack.h>
#include <bvh/v2/tri.h>

#include <utility>
#include <vector>

namespace {

using Vec3 = bvh::v2::Vec<float, 3>;
using BBox = bvh::v2::BBox<float, 3>;
using Ray = bvh::v2::Ray<float, 3>;
using Node = bvh::v2::Node<float, 3>;
using Bvh = bvh::v2::Bvh<Node>;
using Builder = bvh::v2::DefaultBuilder<Node>;

constexpr unsigned stack_size = 64; // as in the benchmark; a push beyond it is only asserted

enum { BUILD, ROBUST, PARAMS };
const raytally_param params[PARAMS] = {
    {"build", RAYTALLY_CHOICE, "high", 0, 0, "low|medium|high", nullptr,
     "SAH in bins; at every centre; and then with reinsertion", "madmann91/bvh, test/benchmark.cpp"},
    {"robust", RAYTALLY_FLAG, "off", 0, 0, nullptr, nullptr, "the box test of Ize 2013",
     "madmann91/bvh, test/benchmark.cpp"},
};

Vec3 vec3(const float *v) {
    return {v[0], v[1], v[2]};
}

class Library {
  public:
    explicit Library(const raytally_build_input &from) : robust_(from.values[ROBUST].flag != 0) {
        peer::require_triangles(from);
        std::vector<bvh::v2::Tri<float, 3>> tris;
        std::vector<BBox> boxes;
        std::vector<Vec3> centers;
        for (std::size_t i = 0; i < from.triangle_count; i++) {
            tris.emplace_back(vec3(peer::corner(from, i, 0)), vec3(peer::corner(from, i, 1)),
                              vec3(peer::corner(from, i, 2)));
            boxes.push_back(tris[i].get_bbox());
            centers.push_back(tris[i].get_center());
        }
        Builder::Config config;
        config.quality = static_cast<Builder::Quality>(from.values[BUILD].choice);
        bvh_ = Builder::build(boxes, centers, config);
        for (const std::size_t id : bvh_.prim_ids) tris_.emplace_back(tris[id]);
        if (depth() > stack_size) throw peer::Refused("its tree is deeper than its stack");
    }

    void nearest(const raytally_ray *rays, std::size_t count, raytally_hit *hits) const {
        for (std::size_t i = 0; i < count; i++)
            hits[i] = robust_ ? search<false, true>(rays[i]) : search<false, false>(rays[i]);
    }

    void occluded(const raytally_ray *rays, std::size_t count, std::uint32_t *occluders) const {
        for (std::size_t i = 0; i < count; i++)
            occluders[i] = (robust_ ? search<true, true>(rays[i]) : search<true, false>(rays[i])).object;
    }

    void describe(raytally_description &out) const {
        out.interior = bvh_.nodes.size() / 2;
        out.leaves = bvh_.nodes.size() - out.interior;
        out.references = tris_.size();
        out.depth = depth();
        out.bytes =
            bvh_.nodes.size() * sizeof(Node) + tris_.size() * (sizeof tris_[0] + sizeof bvh_.prim_ids[0]);
    }

  private:
    template <bool any, bool robust> raytally_hit search(const raytally_ray &of) const {
        const peer::Ray from(of);
        Ray ray(vec3(from.org), vec3(from.dir), from.tmin, from.tmax);
        bvh::v2::SmallStack<Bvh::Index, stack_size> stack;
        std::size_t found = tris_.size();
        const auto leaf = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; i++) {
                if (const auto hit = tris_[i].intersect(ray)) {
                    ray.tmax = std::get<0>(*hit);
                    found = i;
                }
            }
            return found < tris_.size();
        };
        bvh_.intersect<any, robust>(ray, bvh_.get_root().index, stack, leaf);
        if (found == tris_.size()) return peer::miss;
        return from.hit(ray.tmax, static_cast<std::uint32_t>(bvh_.prim_ids[found]));
    }

    std::size_t depth() const {
        std::size_t deepest = 0;
        std::vector<std::pair<std::size_t, std::size_t>> todo{{0, 0}}; // nodes and their depths
        while (!todo.empty()) {
            const auto [at, level] = todo.back();
            todo.pop_back();
            deepest = std::max(deepest, level);
            const auto &index = bvh_.nodes[at].index;
            if (!index.is_leaf())
                todo.insert(todo.end(), {{index.first_id(), level + 1}, {index.first_id() + 1, level + 1}});
        }
        return deepest;
    }

    bool robust_;
    Bvh bvh_;
    std::vector<bvh::v2::PrecomputedTri<float>> tris_; // in the order of the leaves
};

constexpr raytally_accel_ops table = peer::ops<Library>(
    "madmann91", "madmann91/bvh as it is",
    "Meister and Bittner 2018, Parallel Reinsertion for Bounding Volume Hierarchy Optimization, CGF 37(2)",
    params, PARAMS, RAYTALLY_ABSOLUTE_HITS); // its fast box test multiplies the origin out

} // namespace

RAYTALLY_PLUGIN {
    return index == 0 ? &table : nullptr;
}
