#pragma once

#include <span>

#include "core/numbers/wide/every_width.h"
#include "grin/media/index/lanes.h"
#include "grin/rays/marching/ray_step.h"

namespace flatspeckle::grin {

/// The state of the ray in each lane (RayState), the largest measured difference between |v| and
/// the index n, and the step length.
struct RayLanes {
  LaneVectors x, v;
  alignas(64) double arc_length[lanes], optical_path[lanes], index_mismatch[lanes], step[lanes];

  RayState at(int lane) const {
    return {x.at(lane), v.at(lane), arc_length[lane], optical_path[lane]};
  }
  void put(int lane, const RayState& ray) {
    x.put(lane, ray.x);
    v.put(lane, ray.v);
    arc_length[lane] = ray.arc_length;
    optical_path[lane] = ray.optical_path;
  }
};

namespace lane_parts {

// In the following functions, `part` is a fraction of each lane's step.

inline void drift(RayLanes& rays, double part) {
#pragma omp simd
  for (int k = 0; k < lanes; ++k) {
    const double h = part * rays.step[k];
    rays.x.x[k] += h * rays.v.x[k];
    rays.x.y[k] += h * rays.v.y[k];
    rays.x.z[k] += h * rays.v.z[k];
  }
}

/// Makes a kick over `part` of the step, and then a drift over half of it.
inline void kick(RayLanes& rays, const LaneGradients& at, double part) {
#pragma omp simd
  for (int k = 0; k < lanes; ++k) {
    const double h = part * rays.step[k], n = 1 + at.excess[k], path = h * n;
    rays.arc_length[k] += path;
    rays.optical_path[k] += n * path;
    rays.v.x[k] += path * at.gradient.x[k];
    rays.v.y[k] += path * at.gradient.y[k];
    rays.v.z[k] += path * at.gradient.z[k];
    rays.x.x[k] += h / 2 * rays.v.x[k];
    rays.x.y[k] += h / 2 * rays.v.y[k];
    rays.x.z[k] += h / 2 * rays.v.z[k];
  }
}

/// Computes x + h v + h^2/2 n grad n in each lane, where h is `part` of the step.
inline void displaced(const RayLanes& rays, double part, const LaneGradients& at, LaneVectors& to) {
#pragma omp simd
  for (int k = 0; k < lanes; ++k) {
    const double h = part * rays.step[k], force = h * h / 2 * (1 + at.excess[k]);
    to.x[k] = rays.x.x[k] + h * rays.v.x[k] + force * at.gradient.x[k];
    to.y[k] = rays.x.y[k] + h * rays.v.y[k] + force * at.gradient.y[k];
    to.z[k] = rays.x.z[k] + h * rays.v.z[k] + force * at.gradient.z[k];
  }
}

/// Makes a step of the integrator Sharma from the gradients a, b and c at its three points.
inline void advance(RayLanes& rays, const LaneGradients& a, const LaneGradients& b,
                    const LaneGradients& c) {
#pragma omp simd
  for (int k = 0; k < lanes; ++k) {
    const double h = rays.step[k];
    const double na = 1 + a.excess[k], nb = 1 + b.excess[k], nc = 1 + c.excess[k];
    rays.arc_length[k] += h / 6 * (na + 4 * nb + nc);
    rays.optical_path[k] += h / 6 * (na * na + 4 * nb * nb + nc * nc);
    const auto move = [&](double* x, double* v, const double* fa, const double* fb,
                          const double* fc) {
      const double at_a = na * fa[k], at_b = nb * fb[k], at_c = nc * fc[k];
      x[k] += h * v[k] + h * h / 6 * (at_a + 2 * at_b);
      v[k] += h / 6 * (at_a + 4 * at_b + at_c);
    };
    move(rays.x.x, rays.v.x, a.gradient.x, b.gradient.x, c.gradient.x);
    move(rays.x.y, rays.v.y, a.gradient.y, b.gradient.y, c.gradient.y);
    move(rays.x.z, rays.v.z, a.gradient.z, b.gradient.z, c.gradient.z);
  }
}

// The following functions make the steps of ray_step.h in all lanes.

template <LaneField F>
void leap(const F& field, RayLanes& rays, double part) {
  drift(rays, part / 2);
  LaneGradients at;
  field.gradients(rays.x, at);
  kick(rays, at, part);
}
template <LaneField F>
void sharma(const F& field, RayLanes& rays) {
  LaneGradients a, b, c;
  LaneVectors x;
  field.gradients(rays.x, a);
  displaced(rays, 0.5, a, x);
  field.gradients(x, b);
  displaced(rays, 1, b, x);
  field.gradients(x, c);
  advance(rays, a, b, c);
}

}  // namespace lane_parts

/// Makes `steps` steps of the integrator Sharma in all lanes.
template <LaneField F>
FLATSPECKLE_EVERY_WIDTH void make_steps(Sharma, const F& field, RayLanes& __restrict rays,
                                        int steps) {
  for (int i = 0; i < steps; ++i) lane_parts::sharma(field, rays);
}
/// Makes `steps` steps in all lanes. Each step consists of several leapfrog steps, over the given
/// fractions of its length.
template <LaneField F>
FLATSPECKLE_EVERY_WIDTH void make_leaps(const F& field, RayLanes& __restrict rays,
                                        std::span<const double> parts, int steps) {
  for (int i = 0; i < steps; ++i)
    for (const double part : parts) lane_parts::leap(field, rays, part);
}
template <LaneField F>
void make_steps(Leapfrog, const F& field, RayLanes& rays, int steps) {
  constexpr double whole = 1;
  make_leaps(field, rays, {&whole, 1}, steps);
}
template <LaneField F>
void make_steps(Yoshida4, const F& field, RayLanes& rays, int steps) {
  make_leaps(field, rays, Yoshida4::parts, steps);
}

/// Updates the largest difference between |v| and n in all lanes.
template <LaneField F>
FLATSPECKLE_EVERY_WIDTH void check_for_mismatch(const F& field, RayLanes& __restrict rays) {
  LaneGradients at;
  field.gradients(rays.x, at);
#pragma omp simd
  for (int k = 0; k < lanes; ++k) {
    const double vx = rays.v.x[k], vy = rays.v.y[k], vz = rays.v.z[k];
    const double off = std::abs(std::sqrt(vx * vx + vy * vy + vz * vz) - (1 + at.excess[k]));
    const double most = rays.index_mismatch[k];
    rays.index_mismatch[k] = off <= most ? most : off;  // NaN is kept
  }
}

}  // namespace flatspeckle::grin
