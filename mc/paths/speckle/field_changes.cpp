#include "mc/paths/speckle/field_changes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numbers/normal.h"

namespace flatspeckle::mc {

void ChangeTally::scattering(Vec x, Vec from, Vec to) {
  turn += motion->diffusion(x) * one_minus_cosine(from, to);
  slip += dot(from - to, motion->velocity(x));
}

Vec FieldChanges::largest_moves(const Scene& scene) const {
  constexpr double deviations = 6;
  const auto largest = [](const std::vector<double>& of) {
    double most = 0;
    for (const double value : of) most = std::max(most, std::abs(value));
    return most;
  };
  const double delay = largest(delays), shift = largest(shifts),
               diffused = deviations * std::sqrt(2 * motion.diffusion * delay) / scene.k;
  const Domain& box = scene.domain;
  const LocalMotion local(scene, motion);
  const Vec front = local.velocity({}), back = local.velocity({0, box.depth});
  const auto flow = [&](double Vec::*axis) {
    return delay * std::max(std::abs(front.*axis), std::abs(back.*axis));
  };
  return {diffused + flow(&Vec::x) + shift * box.width / 2,
          diffused + flow(&Vec::z) + shift * box.depth,
          diffused + flow(&Vec::y) + shift * box.height / 2};
}

ChangeDraw::ChangeDraw(const Scene& scene, const FieldChanges& changes)
    : changes_(changes),
      motion_(scene, changes.motion),
      k_(scene.k),
      dimension_(scene.medium.dimension),
      order_(changes.delays.size()),
      paths_(changes.count()) {
  std::iota(order_.begin(), order_.end(), 0);
  std::ranges::sort(order_, {}, [&](std::size_t i) { return changes.delays[i]; });
}

void ChangeDraw::draw_moves(Vec x, Vec ChangedPath::*move, RandomStream& random) {
  Vec diffused;
  double before = 0;
  for (const std::size_t i : order_) {
    const double delay = changes_.delays[i],
                 deviation = std::sqrt(2 * motion_.diffusion(x) * (delay - before)) / k_;
    if (deviation > 0) {
      Vec step{standard_normal(random), standard_normal(random), 0};
      if (dimension_ == 3) step.y = standard_normal(random);
      diffused = diffused + deviation * step;
    }
    paths_[i].*move = diffused + delay * motion_.velocity(x);
    before = delay;
  }
  for (std::size_t s = 0; s < changes_.shifts.size(); ++s)
    paths_[order_.size() + s].*move = changes_.shifts[s] * x;
}

std::span<const ChangedPath> ChangeDraw::draw(const Path& path, const ChangeTally& inner,
                                              RandomStream& random) {
  draw_moves(path.first, &ChangedPath::first_move, random);
  draw_moves(path.last, &ChangedPath::last_move, random);
  double phase = 0, before = 0;
  for (const std::size_t i : order_) {
    const double delay = changes_.delays[i], variance = 4 * inner.turn * (delay - before);
    if (variance > 0) phase += std::sqrt(variance) * standard_normal(random);
    ChangedPath& changed = paths_[i];
    changed.factor =
        std::polar(1.0, phase + k_ * (inner.slip * delay + dot(path.arrival, changed.last_move) -
                                      dot(path.start, changed.first_move)));
    before = delay;
  }
  for (std::size_t s = 0; s < changes_.shifts.size(); ++s)
    paths_[order_.size() + s].factor = std::polar(1.0, k_ * changes_.shifts[s] * inner.length);
  return paths_;
}

std::span<const ChangedPath> ChangeDraw::draw_single(Vec x, RandomStream& random) {
  draw_moves(x, &ChangedPath::first_move, random);
  for (ChangedPath& path : paths_) {
    path.last_move = path.first_move;
    path.factor = 1;
  }
  return paths_;
}

}  // namespace flatspeckle::mc
