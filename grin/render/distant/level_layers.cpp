#include "grin/render/distant/level_layers.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle::grin {

namespace {

/// Returns the bodies as boxes; nullopt if one of them is not a layer across the whole box.
std::optional<std::vector<Box>> boxes_across(const Stage& stage, int axis, const Box& box) {
  constexpr double rounding = 1e-9;
  const double apart = rounding * (box.high - box.low).maxCoeff();
  std::vector<Box> boxes;
  for (const Body& body : stage.bodies) {
    const auto* own = std::get_if<Box>(&body.surface);
    if (!own || body.face != BodyFace::refracts) return std::nullopt;
    for (const int across : {(axis + 1) % 3, (axis + 2) % 3})
      if (own->low[across] > box.low[across] + apart ||
          own->high[across] < box.high[across] - apart)
        return std::nullopt;
    boxes.push_back(*own);
  }
  return boxes;
}

}  // namespace

LevelLayers::LevelLayers(int axis, const Box& box) : axis_(axis) {
  low_ = local(box.low);
  high_ = local(box.high);
}

std::optional<LevelLayers> LevelLayers::of(const Stage& stage, int axis, double field_excess) {
  const auto* box = std::get_if<Box>(&stage.boundary);
  if (!box) return std::nullopt;
  for (Part part = around; part < stage.parts(); ++part)
    if (!stage.medium_in(part).is_uniform()) return std::nullopt;
  const auto bodies = boxes_across(stage, axis, *box);
  if (!bodies) return std::nullopt;
  std::vector<double> planes{box->low[axis], box->high[axis]};
  for (const Box& body : *bodies) planes.insert(planes.end(), {body.low[axis], body.high[axis]});
  std::ranges::sort(planes);

  LevelLayers found(axis, *box);
  found.add(stage, around, planes.front(), planes.front(), field_excess);
  for (std::size_t i = 0; i + 1 < planes.size(); ++i) {
    if (!(planes[i] < planes[i + 1])) continue;
    const double middle = (planes[i] + planes[i + 1]) / 2;
    Part part = around;
    for (Part body = 1; body < stage.parts(); ++body)
      if ((*bodies)[body - 1].low[axis] < middle && middle < (*bodies)[body - 1].high[axis])
        part = body;
    found.add(stage, part, planes[i], planes[i + 1], field_excess);
  }
  found.add(stage, around, planes.back(), planes.back(), field_excess);

  const auto& layers = found.layers_;
  const auto scatters = [](const LevelLayer& layer) { return layer.scatters(); };
  found.first_ = static_cast<int>(std::ranges::find_if(layers, scatters) - layers.begin());
  const auto end = std::find_if(layers.rbegin(), layers.rend(), scatters).base();
  found.last_ = static_cast<int>(end - layers.begin()) - 1;
  if (found.last_ < found.first_) return std::nullopt;
  const bool is_whole = std::all_of(layers.begin() + found.first_, end, scatters);
  // light in two layers outside of those that scatter might come back
  const bool is_simple = found.first_ <= 1 && found.last_ + 2 >= static_cast<int>(layers.size());
  return is_whole && is_simple ? std::optional(std::move(found)) : std::nullopt;
}

/// Adds a layer on top; it joins the one below if that belongs to the same part.
void LevelLayers::add(const Stage& stage, Part part, double low, double high, double field_excess) {
  if (!layers_.empty() && layers_.back().part == part) {
    layers_.back().high = high;
    return;
  }
  const double excess = part == stage.field_part() ? field_excess : stage.excess_in(part);
  layers_.push_back({part, low, high, excess, stage.medium_in(part)});
}

double LevelLayers::distance_to_sides(const Vec3& x) const {
  return std::min((x - low_).head<2>().minCoeff(), (high_ - x).head<2>().minCoeff());
}

}  // namespace flatspeckle::grin
