// SPDX-License-Identifier: Apache-2.0
//
// my_bvh: the library of the plugin in examples/peers/README.md: it tests every triangle, after Möller and
// Trumbore, in double.
#pragma once

#include <cstddef>
#include <limits>

namespace my {

struct Options {
    bool high_quality = false;
    int threads = 1;
};

struct Hit {
    bool valid = false;
    float t = std::numeric_limits<float>::infinity();
    unsigned triangle = 0;
};

class Bvh {
  public:
    void build(const float *triangles, std::size_t count, const Options &) {
        triangles_ = triangles;
        count_ = count;
    }

    Hit closest_hit(const float *org, const float *dir, float tmin, float tmax) const {
        Hit best;
        for (unsigned i = 0; i < count_; i++) {
            const float t = hit(&triangles_[9 * std::size_t{i}], org, dir);
            if (t >= tmin && t <= tmax && t < best.t) best = {true, t, i};
        }
        return best;
    }

    bool any_hit(const float *org, const float *dir, float tmin, float tmax) const {
        return closest_hit(org, dir, tmin, tmax).valid;
    }

    std::size_t bytes() const {
        return count_ * 9 * sizeof(float);
    }

  private:
    struct Vec {
        double x, y, z;
        Vec(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {
        }
        explicit Vec(const float *v) : x(v[0]), y(v[1]), z(v[2]) {
        }
        Vec operator-(const Vec &b) const {
            return {x - b.x, y - b.y, z - b.z};
        }
        Vec cross(const Vec &b) const {
            return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x};
        }
        double dot(const Vec &b) const {
            return x * b.x + y * b.y + z * b.z;
        }
    };

    // The t of the hit, or NaN.
    static float hit(const float *v, const float *org, const float *dir) {
        const Vec edge1 = Vec(v + 3) - Vec(v), edge2 = Vec(v + 6) - Vec(v), s = Vec(org) - Vec(v), d(dir);
        const Vec p = d.cross(edge2), q = s.cross(edge1);
        const double inverse = 1 / edge1.dot(p), a = s.dot(p) * inverse, b = d.dot(q) * inverse;
        if (!(a >= 0 && b >= 0 && a + b <= 1)) return std::numeric_limits<float>::quiet_NaN();
        return static_cast<float>(edge2.dot(q) * inverse);
    }

    const float *triangles_ = nullptr;
    std::size_t count_ = 0;
};

} // namespace my
