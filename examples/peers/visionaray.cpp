// SPDX-License-Identifier: Apache-2.0
//
// visionaray: szellmann/visionaray 0.6.1: binary trees by SAH in bins, with spatial splits or without. `mode`
// chooses how they are traced: one ray at a time, packets of 4 or 8 rays, which the library is known for
// (those of 16 do not compile), or one ray in the tree collapsed to 8 children. Packets take the rays as they
// come; the last is filled with rays that end before they begin. wide8 loses hits of rays that start in the
// plane of a box, whose distance it compares, -0, as an unsigned integer. It builds on one thread.
#include "peer.h"

#include <visionaray/bvh.h>
#include <visionaray/math/simd/simd.h>
#include <visionaray/traverse.h>

#include <vector>

namespace {

using namespace visionaray;
using Triangle = basic_triangle<3, float>;

enum { MODE, BUILD, PARAMS };
enum { SINGLE, PACKET4, PACKET8, WIDE8 };
const raytally_param params[PARAMS] = {
    {"mode", RAYTALLY_CHOICE, "packet8", 0, 0, "single|packet4|packet8|wide8", nullptr,
     "one ray; packets; one ray in a tree of 8 children", "measured"},
    {"build", RAYTALLY_CHOICE, "spatial", 0, 0, "binned|spatial", nullptr, "SAH in bins; with spatial splits",
     "visionaray, viewer"},
};

vec3 vector_of(const float *v) {
    return {v[0], v[1], v[2]};
}

basic_ray<float> ray_of(const peer::Ray &from) {
    return {vector_of(from.org), vector_of(from.dir), from.tmin, from.tmax};
}

template <detail::traversal_type type, typename R, typename Tree> auto trace(const R &ray, const Tree &tree) {
    default_intersector intersector;
    if constexpr (Tree::Width > 2)
        return intersect_ray1_bvhN<type>(ray, tree, intersector);
    else
        return intersect<type>(ray, tree, intersector);
}

class Library {
  public:
    explicit Library(const raytally_build_input &from) : mode_(from.values[MODE].choice) {
        peer::require_triangles(from);
        aligned_vector<Triangle> triangles;
        for (unsigned i = 0; i < from.triangle_count; i++) {
            const vec3 a = vector_of(peer::corner(from, i, 0));
            triangles.emplace_back(a, vector_of(peer::corner(from, i, 1)) - a,
                                   vector_of(peer::corner(from, i, 2)) - a);
            triangles[i].prim_id = i;
            triangles[i].geom_id = 0;
        }
        binned_sah_builder builder;
        builder.enable_spatial_splits(from.values[BUILD].choice != 0);
        tree_ = builder.build(index_bvh<Triangle>{}, triangles.data(), triangles.size());
        if (mode_ != WIDE8 && entries(0) > 32) throw peer::Refused("its tree is deeper than its stack");
        if (mode_ != WIDE8) return;
        wide_ = index_bvh8<Triangle>(tree_.primitives().data(), tree_.num_primitives());
        wide_.indices() = tree_.indices();
        thread_pool none(0);
        bvh_collapser().collapse(tree_, wide_, none);
    }

    void nearest(const raytally_ray *rays, std::size_t count, raytally_hit *hits) const {
        const auto take = [=](std::size_t i, const peer::Ray &ray, bool hit, float t, int id) {
            hits[i] = hit ? ray.hit(t, static_cast<std::uint32_t>(id)) : peer::miss;
        };
        search<detail::ClosestHit>(rays, count, take);
    }

    void occluded(const raytally_ray *rays, std::size_t count, std::uint32_t *occluders) const {
        search<detail::AnyHit>(rays, count, [=](std::size_t i, const peer::Ray &, bool hit, float, int) {
            occluders[i] = peer::occluder(hit);
        });
    }

    void describe(raytally_description &out) const {
        out.bytes = mode_ == WIDE8 ? wide_.num_nodes() * sizeof wide_.nodes()[0]
                                   : tree_.num_nodes() * sizeof(bvh_node);
        out.bytes += tree_.num_indices() * sizeof(unsigned) + tree_.num_primitives() * sizeof(Triangle);
    }

  private:
    // The most entries that a traversal has on its stack below a node.
    std::size_t entries(std::size_t at) const {
        const bvh_node &node = tree_.node(at);
        return 1 + (is_leaf(node) ? 0 : std::max(entries(node.get_child(0)), entries(node.get_child(1))));
    }

    template <detail::traversal_type type, typename Take>
    void search(const raytally_ray *rays, std::size_t count, const Take &take) const {
        switch (mode_) {
        case PACKET4: return packets<type, simd::float4>(rays, count, take);
        case PACKET8: return packets<type, simd::float8>(rays, count, take);
        case WIDE8: return singles<type>(wide_.ref(), rays, count, take);
        default: return singles<type>(tree_.ref(), rays, count, take);
        }
    }

    template <detail::traversal_type type, typename Tree, typename Take>
    static void singles(const Tree &tree, const raytally_ray *rays, std::size_t count, const Take &take) {
        for (std::size_t i = 0; i < count; i++) {
            const peer::Ray ray(rays[i]);
            const auto hit = trace<type>(ray_of(ray), tree);
            take(i, ray, hit.hit, hit.t, static_cast<int>(hit.prim_id));
        }
    }

    template <detail::traversal_type type, typename F, typename Take>
    void packets(const raytally_ray *rays, std::size_t count, const Take &take) const {
        constexpr std::size_t width = simd::num_elements<F>::value;
        using I = simd::int_type_t<F>;
        for (std::size_t first = 0; first < count; first += width) {
            array<basic_ray<float>, width> lanes;
            for (std::size_t i = 0; i < width; i++) {
                lanes[i] = ray_of(peer::Ray(rays[std::min(first + i, count - 1)]));
                if (first + i >= count) lanes[i].tmax = -1;
            }
            const auto hit = trace<type>(simd::pack(lanes), tree_.ref());
            simd::aligned_array_t<F> t;
            simd::aligned_array_t<I> ids, found;
            simd::store(t, hit.t);
            simd::store(ids, hit.prim_id);
            simd::store(found, select(hit.hit, I(1), I(0)));
            for (std::size_t i = 0; i < width && first + i < count; i++)
                take(first + i, peer::Ray(rays[first + i]), found[i] != 0, t[i], ids[i]);
        }
    }

    std::uint32_t mode_;
    index_bvh<Triangle> tree_;
    index_bvh8<Triangle> wide_;
};

constexpr raytally_accel_ops table = peer::ops<Library>(
    "visionaray", "szellmann/visionaray as it is",
    "Zellmann, Wickeroth and Lang 2017, Visionaray: A Cross-Platform Ray Tracing Template Library, SEARIS'17",
    params, PARAMS);

} // namespace

RAYTALLY_PLUGIN {
    return index == 0 ? &table : nullptr;
}
