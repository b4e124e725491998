// SPDX-License-Identifier: Apache-2.0
//
// madmann: the hierarchy of a public library, madmann91/bvh, as an exact plugin.
//
// The library builds and traverses the tree; its nodes, stack and box test are template arguments. Here nodes have
// raytally's boxes, and the test is raytally_box_hit. The library's own tests round differently and lose hits at the
// edges of boxes. Its tree is safe: minima and maxima of floats are exact, so the box of a node contains
// the boxes of all objects below it, and by box.h no hit is lost. README.md explains more.
//
// No exception leaves this file. A traversal's stack is the memory of a query; its size is the depth of the tree.
#include <raytally/accel.h>

#include <bvh/v2/default_builder.h>

#include <new>
#include <tuple>
#include <vector>

namespace {

using Vec = bvh::v2::Vec<float, 3>;
using BBox = bvh::v2::BBox<float, 3>;

struct Node { // as the library requires
    using Scalar = float;
    using Index = bvh::v2::Index<32, 4>;
    static constexpr std::size_t dimension = 3;
    raytally_box box;
    Index index;

    bool is_leaf() const { return index.is_leaf(); }
    void set_bbox(const BBox &b) { box = {{b.min[0], b.min[1], b.min[2]}, {b.max[0], b.max[1], b.max[2]}}; }
    BBox get_bbox() const {
        return {Vec(box.lo[0], box.lo[1], box.lo[2]), Vec(box.hi[0], box.hi[1], box.hi[2])};
    }
};

struct Stack {
    Node::Index *entries;
    std::size_t size = 0;
    bool is_empty() const { return size == 0; }
    void push(Node::Index index) { entries[size++] = index; }
    Node::Index pop() { return entries[--size]; }
};

using Builder = bvh::v2::DefaultBuilder<Node>;

struct Madmann {
    bvh::v2::Bvh<Node> bvh;
    std::vector<std::uint32_t> ids;
    std::size_t depth = 0;

    explicit Madmann(const raytally_build_input &what) {
        const std::size_t count = what.object_count, bytes = count * (2 * sizeof(Node) + sizeof ids[0]);
        if (count >= Node::Index::max_first_id / 2 || bytes > what.byte_limit) throw std::bad_alloc();
        if (count == 0) return;
        std::vector<BBox> boxes;
        std::vector<Vec> centers;
        for (std::uint32_t i = 0; i < count; i++) {
            boxes.push_back(Node{what.boxes[i], {}}.get_bbox());
            centers.push_back(boxes[i].get_center());
        }
        Builder::Config config;
        config.quality = static_cast<Builder::Quality>(what.values[0].choice);
        bvh = Builder::build(boxes, centers, config); // on one thread, so it is the same everywhere
        ids.assign(bvh.prim_ids.begin(), bvh.prim_ids.end());
        visit([&](const Node &, std::size_t level) { depth = std::max(depth, level); });
    }

    template <typename Each> void visit(Each &&each) const {
        std::vector<std::pair<std::size_t, std::size_t>> todo; // nodes, and their depths
        if (!bvh.nodes.empty()) todo.emplace_back(0, 0);
        while (!todo.empty()) {
            const auto [at, level] = todo.back();
            todo.pop_back();
            each(bvh.nodes[at], level);
            for (std::size_t s = 0; s < 2 && !bvh.nodes[at].is_leaf(); s++)
                todo.emplace_back(bvh.nodes[at].index.first_id() + s, level + 1);
        }
    }
};

const Madmann &of(const void *self) { return *static_cast<const Madmann *>(self); }

RAYTALLY_INLINE void search(const Madmann *self, void *memory, const raytally_prepared *ray, int any,
                            raytally_hit *best, raytally_counters *counters) {
    const auto hit = [&](const Node &node, float &enter) {
        RAYTALLY_COUNT(counters, RAYTALLY_EXTENT_TESTS, 1);
        return raytally_box_hit(&node.box, ray, raytally_tmax(ray, best), &enter) != 0;
    };
    const auto inner = [&](const Node &left, const Node &right) {
        float enter[2];
        const bool meets_left = hit(left, enter[0]), meets_right = hit(right, enter[1]);
        RAYTALLY_COUNT(counters, RAYTALLY_STEPS, 1);
        return std::make_tuple(meets_left, meets_right, enter[1] < enter[0]);
    };
    const auto leaf = [&](std::size_t first, std::size_t last) {
        RAYTALLY_COUNT(counters, RAYTALLY_STEPS, 1);
        RAYTALLY_COUNT(counters, RAYTALLY_LEAF_STEPS, 1);
        const auto count = static_cast<std::uint32_t>(last - first);
        return raytally_object_hits(ray, &self->ids[first], count, any, best, counters) != 0;
    };
    Stack stack{static_cast<Node::Index *>(memory)};
    float enter;
    const auto &bvh = self->bvh;
    if (bvh.nodes.empty() || !hit(bvh.get_root(), enter)) return;
    if (any) bvh.traverse_top_down<true>(bvh.get_root().index, stack, leaf, inner);
    else bvh.traverse_top_down<false>(bvh.get_root().index, stack, leaf, inner);
}

RAYTALLY_DEFINE_KERNELS(Madmann, search)

int build(const raytally_build_input *what, void **self) noexcept {
    try {
        *self = new Madmann(*what);
        return RAYTALLY_BUILD_OK;
    } catch (...) { // only allocations can fail
        return RAYTALLY_BUILD_NO_MEMORY;
    }
}

void describe(const void *self, raytally_description *out) {
    const std::size_t nodes = of(self).bvh.nodes.size();
    out->interior = nodes / 2;
    out->leaves = nodes - nodes / 2;
    out->references = of(self).ids.size();
    out->depth = of(self).depth;
    out->bytes = nodes * sizeof(Node) + of(self).ids.size() * sizeof of(self).ids[0];
}

void each_box(const void *self, raytally_box_visitor *show, void *viewer) {
    of(self).visit([&](const Node &node, std::size_t level) {
        show(viewer, &node.box, static_cast<std::uint32_t>(level), node.is_leaf());
    });
}

const raytally_param quality = {"quality", RAYTALLY_CHOICE, "high", 0, 0, "low|medium|high", nullptr,
                                "SAH in bins; at every centre; and then subtrees moved", "madmann91/bvh"};

const raytally_accel_ops ops = {
    RAYTALLY_ACCEL_ABI, sizeof(raytally_accel_ops), "madmann", "the hierarchy of madmann91/bvh, made exact",
    "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies, RT'07", &quality, 1, build,
    [](void *self) { delete static_cast<Madmann *>(self); }, search_nearest, search_occluded,
    [](const void *self) { return (of(self).depth + 1) * sizeof(Node::Index); }, nullptr, // + 1 for the root
    describe, nullptr, each_box, 0}; // no flags: exact, and counted

} // namespace

RAYTALLY_PLUGIN { return index == 0 ? &ops : nullptr; }
