// SPDX-License-Identifier: Apache-2.0
//
// bvh_cpp: a binary hierarchy of boxes in C++17, as a plugin: a class behind raytally's C interface.
//
// Paper: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies", RT'07.
//
// Layout: nodes of 32 bytes in one vector, the root first, siblings side by side and after their parent; all
// lists of objects in another. Invariant: the box of a node contains everything below it, every object is in
// one leaf, no leaf is deeper than max_depth. Exactness follows from box.h: a node is skipped only if
// raytally_box_hit says no, or if the ray enters it beyond the best hit, by `>` and not by `>=`.
//
// No exception leaves this file: `build` and `validate` are the only functions that allocate, and they catch.
#include <raytally/accel.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <new>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace {

constexpr std::uint32_t plane_depth = 32; // deeper groups are halved by number, so ...
constexpr std::uint32_t max_depth = 64;   // ... no leaf is deeper than this
constexpr std::uint32_t most_bins = 64;

raytally_box empty_box() {
    constexpr float inf = std::numeric_limits<float>::infinity();
    return {{inf, inf, inf}, {-inf, -inf, -inf}};
}

void grow(raytally_box &box, const raytally_box &by) {
    for (int a = 0; a < 3; a++) {
        box.lo[a] = std::min(box.lo[a], by.lo[a]);
        box.hi[a] = std::max(box.hi[a], by.hi[a]);
    }
}

double half_area(const raytally_box &box) {
    const double x = double(box.hi[0]) - double(box.lo[0]), y = double(box.hi[1]) - double(box.lo[1]),
                 z = double(box.hi[2]) - double(box.lo[2]);
    return x * y + y * z + z * x;
}

float center(const raytally_box &box, int axis) {
    return 0.5F * box.lo[axis] + 0.5F * box.hi[axis];
}

class Hierarchy {
  public:
    explicit Hierarchy(const raytally_build_input &what);

    [[gnu::always_inline]] void search(const raytally_prepared &ray, bool any, raytally_hit &best,
                                       raytally_counters *counters) const;
    void describe(raytally_description &out) const;
    void validate() const; // throws std::logic_error, with what is broken
    void each_box(raytally_box_visitor *show, void *viewer) const;

  private:
    struct Node {
        raytally_box box;
        std::uint32_t first; // inner: the left child; leaf: the first of its ids
        std::uint32_t count; // objects of a leaf; 0: inner
    };
    struct Range {
        std::uint32_t first, count;
    };
    struct Split {
        double cost;
        int axis;
        float plane; // centres below it go left
    };

    void divide(std::uint32_t index, Range range, std::uint32_t depth);
    Split find_split(Range range) const;
    void try_axis(Range range, int axis, float lo, float hi, Split &best) const;

    template <typename Visit>
    void visit(Visit &&each, std::uint32_t index = 0, std::uint32_t depth = 0) const {
        if (nodes.empty()) return;
        each(nodes[index], depth);
        for (std::uint32_t s = 0; s < 2 && nodes[index].count == 0; s++)
            visit(each, nodes[index].first + s, depth + 1);
    }

    const raytally_box *boxes; // boxes of the objects. Borrowed
    std::uint32_t bins, max_leaf_size;
    std::vector<Node> nodes;
    std::vector<std::uint32_t> ids;
};

// ---- build ----

enum { param_bins, param_max_leaf_size };

const std::array<raytally_param, 2> params = {{
    {"bins", RAYTALLY_INT, "16", 2, most_bins, nullptr, "2|64",
     "bins along each axis in which splits are sought", "Wald 2007"},
    {"max_leaf_size", RAYTALLY_INT, "8", 1, 1024, nullptr, "1|64", "most objects a leaf may hold",
     "as in bvh"},
}};

Hierarchy::Hierarchy(const raytally_build_input &what)
    : boxes(what.boxes), bins(static_cast<std::uint32_t>(what.values[param_bins].integer)),
      max_leaf_size(static_cast<std::uint32_t>(what.values[param_max_leaf_size].integer)) {
    const std::size_t count = what.object_count;
    if (count == 0) return;
    if (count > std::numeric_limits<std::uint32_t>::max() / 2)
        throw std::length_error("there are more objects than nodes have numbers for");
    if (2 * count * sizeof(Node) + count * sizeof(std::uint32_t) > what.byte_limit) throw std::bad_alloc();
    ids.resize(count);
    std::iota(ids.begin(), ids.end(), 0U);
    nodes.reserve(2 * count - 1);
    nodes.emplace_back();
    divide(0, {0, what.object_count}, 0);
    nodes.shrink_to_fit();
}

void Hierarchy::divide(std::uint32_t index, Range range, std::uint32_t depth) {
    const auto begin = ids.begin() + range.first, end = begin + range.count;
    raytally_box box = empty_box();
    std::for_each(begin, end, [&](std::uint32_t id) { grow(box, boxes[id]); });
    nodes[index] = {box, range.first, range.count};
    if (range.count == 1) return;

    // A step costs as much as a test.
    const Split split = find_split(range);
    const double area = half_area(box);
    if (range.count <= max_leaf_size && !(area + split.cost < area * range.count)) return;
    auto middle = begin + range.count / 2;
    if (depth < plane_depth && split.cost < std::numeric_limits<double>::infinity())
        middle = std::partition(
            begin, end, [&](std::uint32_t id) { return center(boxes[id], split.axis) < split.plane; });

    const auto left = static_cast<std::uint32_t>(middle - begin);
    const auto child = static_cast<std::uint32_t>(nodes.size());
    nodes.resize(nodes.size() + 2);
    nodes[index].first = child;
    nodes[index].count = 0;
    divide(child, {range.first, left}, depth + 1);
    divide(child + 1, {range.first + left, range.count - left}, depth + 1);
}

Hierarchy::Split Hierarchy::find_split(Range range) const {
    Split best = {std::numeric_limits<double>::infinity(), 0, 0};
    for (int a = 0; a < 3; a++) {
        const auto below = [&](std::uint32_t x, std::uint32_t y) {
            return center(boxes[x], a) < center(boxes[y], a);
        };
        const auto begin = ids.begin() + range.first;
        const auto [lo, hi] = std::minmax_element(begin, begin + range.count, below);
        try_axis(range, a, center(boxes[*lo], a), center(boxes[*hi], a), best);
    }
    return best;
}

// Tries the planes between bins that separate the centres, at least one of which is at `lo` and one at `hi`.
void Hierarchy::try_axis(Range range, int axis, float lo, float hi, Split &best) const {
    std::array<Range, most_bins> counts{};
    std::array<raytally_box, most_bins> around;
    std::array<double, most_bins> right{};
    around.fill(empty_box());
    const auto plane = [&](std::uint32_t bin) {
        return lo + (hi - lo) * static_cast<float>(bin) / static_cast<float>(bins);
    };
    for (std::uint32_t i = range.first; i < range.first + range.count && lo < hi; i++) {
        const float at = center(boxes[ids[i]], axis);
        auto bin =
            std::min(static_cast<std::uint32_t>((at - lo) / (hi - lo) * static_cast<float>(bins)), bins - 1);
        while (bin > 0 && at < plane(bin)) bin--;
        while (bin < bins - 1 && at >= plane(bin + 1)) bin++;
        grow(around[bin], boxes[ids[i]]);
        counts[bin].count++;
    }
    raytally_box box = empty_box();
    for (std::uint32_t bin = bins - 1; bin > 0; bin--) {
        grow(box, around[bin]);
        right[bin] = half_area(box);
    }
    box = empty_box();
    std::uint32_t left = 0;
    for (std::uint32_t bin = 1; bin < bins; bin++) {
        grow(box, around[bin - 1]);
        left += counts[bin - 1].count;
        if (left == 0 || left == range.count) continue;
        const double cost = half_area(box) * left + right[bin] * (range.count - left);
        if (cost < best.cost) best = {cost, axis, plane(bin)};
    }
}

// ---- queries ----

inline void Hierarchy::search(const raytally_prepared &ray, bool any, raytally_hit &best,
                              raytally_counters *counters) const {
    struct Waiting {
        std::uint32_t node;
        float enter;
    };
    std::array<Waiting, max_depth> stack; // each level adds one child
    std::uint32_t stacked = 0, index = 0;
    float enter[2];
    if (nodes.empty()) return;
    RAYTALLY_COUNT(counters, RAYTALLY_EXTENT_TESTS, 1);
    if (!raytally_box_hit(&nodes[0].box, &ray, ray.tmax, &enter[0])) return;
    for (;;) {
        const Node &node = nodes[index];
        RAYTALLY_COUNT(counters, RAYTALLY_STEPS, 1);
        if (node.count == 0) {
            const float limit = raytally_tmax(&ray, &best);
            const bool left = raytally_box_hit(&nodes[node.first].box, &ray, limit, &enter[0]);
            const bool right = raytally_box_hit(&nodes[node.first + 1].box, &ray, limit, &enter[1]);
            RAYTALLY_COUNT(counters, RAYTALLY_EXTENT_TESTS, 2);
            if (left || right) {
                const std::uint32_t nearer = left && right ? enter[1] < enter[0] : right;
                if (left && right) stack[stacked++] = {node.first + 1 - nearer, enter[1 - nearer]};
                index = node.first + nearer;
                continue;
            }
        } else {
            RAYTALLY_COUNT(counters, RAYTALLY_LEAF_STEPS, 1);
            if (raytally_object_hits(&ray, &ids[node.first], node.count, any, &best, counters)) return;
        }
        do {
            if (stacked == 0) return;
            stacked--;
        } while (stack[stacked].enter > raytally_tmax(&ray, &best));
        index = stack[stacked].node;
    }
}

// ---- inspection ----

void Hierarchy::describe(raytally_description &out) const {
    out.references = ids.size();
    out.bytes = nodes.size() * sizeof(Node) + ids.size() * sizeof(std::uint32_t);
    visit([&](const Node &node, std::uint32_t depth) {
        (node.count == 0 ? out.interior : out.leaves)++;
        out.depth = std::max(out.depth, std::uint64_t(depth));
    });
}

void Hierarchy::validate() const {
    const auto demand = [](bool holds, const char *broken) {
        if (!holds) throw std::logic_error(broken);
    };
    const auto inside = [](const raytally_box &in, const raytally_box &box) {
        for (int a = 0; a < 3; a++)
            if (!(box.lo[a] <= in.lo[a] && in.hi[a] <= box.hi[a])) return false;
        return true;
    };
    std::vector<bool> seen(ids.size());
    visit([&](const Node &node, std::uint32_t depth) {
        demand(depth <= max_depth, "a leaf is too deep");
        for (std::uint32_t s = 0; s < 2 && node.count == 0; s++)
            demand(inside(nodes[node.first + s].box, node.box), "a child lies outside its parent");
        for (std::uint32_t i = node.first; i < node.first + node.count; i++) {
            demand(inside(boxes[ids[i]], node.box), "an object lies outside its leaf");
            demand(!seen[ids[i]], "an object is listed twice");
            seen[ids[i]] = true;
        }
    });
    demand(std::find(seen.begin(), seen.end(), false) == seen.end(), "an object is in no leaf");
}

void Hierarchy::each_box(raytally_box_visitor *show, void *viewer) const {
    visit([&](const Node &node, std::uint32_t depth) { show(viewer, &node.box, depth, node.count > 0); });
}

// ---- the C interface ----

const Hierarchy &of(const void *self) {
    return *static_cast<const Hierarchy *>(self);
}

int build(const raytally_build_input *what, void **self) noexcept {
    try {
        *self = new Hierarchy(*what);
        return RAYTALLY_BUILD_OK;
    } catch (const std::bad_alloc &) {
        return RAYTALLY_BUILD_NO_MEMORY;
    } catch (const std::exception &error) {
        std::snprintf(what->message, what->message_room, "%s", error.what());
        return RAYTALLY_BUILD_REFUSED;
    }
}

int validate(const void *self, char *message, std::size_t room) noexcept {
    try {
        of(self).validate();
        return 0;
    } catch (const std::exception &error) {
        std::snprintf(message, room, "%s", error.what());
        return 1;
    }
}

RAYTALLY_INLINE void search(const Hierarchy *self, void *, const raytally_prepared *ray, int any,
                            raytally_hit *best, raytally_counters *counters) {
    self->search(*ray, any != 0, *best, counters);
}

RAYTALLY_DEFINE_KERNELS(Hierarchy, search)

// C++17 has no designated initializers: in the order of raytally_accel_ops.
const raytally_accel_ops ops = {
    RAYTALLY_ACCEL_ABI,
    sizeof(raytally_accel_ops),
    "bvh_cpp",
    "binary hierarchy of boxes by the surface area heuristic, in C++",
    "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies, RT'07",
    params.data(),
    params.size(),
    build,
    [](void *self) { delete static_cast<Hierarchy *>(self); },
    search_nearest,
    search_occluded,
    nullptr, // query_bytes
    nullptr, // begin
    [](const void *self, raytally_description *out) { of(self).describe(*out); },
    validate,
    [](const void *self, raytally_box_visitor *show, void *viewer) { of(self).each_box(show, viewer); },
    0, // flags: exact, and counted
};

} // namespace

RAYTALLY_PLUGIN {
    return index == 0 ? &ops : nullptr;
}
