#include "mc/paths/speckle/camera_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/numbers/blas.h"
#include "core/numbers/phasor.h"

namespace flatspeckle::mc {

namespace {

/// Sets a direction without its angle, which scattering in space does not use.
void put(Directions& all, std::size_t i, Vec w) {
  all.x[i] = w.x, all.z[i] = w.z, all.y[i] = w.y;
}

}  // namespace

CameraBox::CameraBox(const PathWalks& walks, const FarCamera& camera)
    : walks_(walks),
      camera_(camera),
      box_(walks.scene().domain),
      k_(walks.scene().k),
      mu_t_(walks.scene().medium.mu_t) {}

Vec CameraBox::towards(double x, double y) const {
  return {x, std::copysign(std::sqrt(1 - x * x - y * y), camera_.axis.z), y};
}

Directions CameraBox::square(const std::vector<double>& at) const {
  Directions all(at.size() * at.size());
  for (std::size_t b = 0; b < at.size(); ++b)
    for (std::size_t a = 0; a < at.size(); ++a)
      all.set(b * at.size() + a, towards(camera_.axis.x + camera_.aperture * at[a],
                                         camera_.axis.y + camera_.aperture * at[b]));
  return all;
}

LineSums::LineSums(const CameraBox& box, bool columns, const CameraResolution& resolution,
                   std::size_t fields)
    : box_(box),
      along_(columns ? &Vec::x : &Vec::y),
      across_(columns ? &Vec::y : &Vec::x),
      half_((columns ? box.box().width : box.box().height) / 2),
      fields_(fields),
      node_(chebyshev_nodes(resolution.side_nodes)) {
  const FarCamera& camera = box.camera();
  for (std::size_t i = 0; i < camera.pixels; ++i) {
    cosine_.push_back(camera.cosine(camera.axis.*along_, i));
    double least = 1, most = 0;
    for (std::size_t j = 0; j < camera.pixels; ++j) {
      const double z =
          std::abs(box.towards(cosine_.back(), camera.cosine(camera.axis.*across_, j)).z);
      least = std::min(least, z);
      most = std::max(most, z);
    }
    least_.push_back(least);
    most_.push_back(most);
  }
  tangent_ = camera.axis.*across_ / camera.axis.z;
  const double edge =
      (columns ? box.box().height : box.box().width) / 2 + std::abs(tangent_) * box.box().depth / 2;
  axis_ = {-edge, edge, 2 * box.k() * camera.aperture, resolution.width};
  grid_.resize(fields * camera.pixels * axis_.size() * node_.size());
}

LineSums::Leaves LineSums::leaves(Vec x, std::size_t line) const {
  const double along = box_.depth_of(x) * std::abs(cosine_[line]), to_side = gap(x, line);
  if (along <= to_side * least_[line]) return Leaves::none;
  return along > to_side * most_[line] ? Leaves::whole : Leaves::part;
}

bool LineSums::reached(Vec x) const {
  return leaves(x, 0) != Leaves::none || leaves(x, cosine_.size() - 1) != Leaves::none;
}

double LineSums::place(const PathEnd& end) const {
  return end.place.*across_ - tangent_ * (end.place.z - box_.box().depth / 2);
}

void LineSums::choose_lines(Vec x) {
  lines_.clear();
  for (std::size_t i = 0; i < cosine_.size(); ++i)
    if (leaves(x, i) == Leaves::whole) lines_.push_back(i);
}

void LineSums::choose_directions(const std::vector<double>& across) {
  directions_ = Directions(lines_.size() * across.size());
  const FarCamera& camera = box_.camera();
  std::size_t j = 0;
  for (const std::size_t line : lines_)
    for (const double t : across) {
      const double b = camera.axis.*across_ + camera.aperture * t;
      directions_.set(
          j++, along_ == &Vec::x ? box_.towards(cosine_[line], b) : box_.towards(b, cosine_[line]));
    }
}

void LineSums::find_factors(const PathEnd& end) {
  const FarCamera& camera = box_.camera();
  const std::size_t count = directions_.size(), each = count / lines_.size();
  const double z = end.place.z - box_.box().depth / 2, depth = box_.depth_of(end.x);
  phase_.resize(count), by_side_.resize(count), by_face_.resize(count), zero_.resize(count);
  value_.resize(count);
  for (std::size_t j = 0; j < count; ++j) {
    const std::size_t line = lines_[j / each];
    const Vec w = directions_[j];
    const double off = w.*across_ - camera.axis.*across_;
    phase_[j] =
        -box_.k() * (cosine_[line] * end.place.*along_ + camera.axis.*across_ * end.place.*across_ +
                     (w.z + tangent_ * off) * z);
    by_side_[j] = -box_.mu_t() * distance(end.x, line) / 2;
    by_face_[j] = -box_.mu_t() * depth / std::abs(w.z) / 2;
  }
  damped_phasors(phase_, zero_, value_);
  damping(by_side_, by_side_);
  damping(by_face_, by_face_);
  for (std::size_t j = 0; j < count; ++j) value_[j] *= by_side_[j] - by_face_[j];
  box_.walks().towards(end.x, end.arrival, directions_, value_);
}

void LineSums::add(const WeightedEnd& weighted) {
  const PathEnd& end = weighted.end;
  choose_lines(end.x);
  if (lines_.empty()) return;
  choose_directions(node_);
  find_factors(end);
  std::array<double, SpreadingAxis::widest> weights;
  const std::size_t first = axis_.spread(place(end), weights), many = node_.size();
  scaled_.resize(many);
  for (std::size_t f = 0; f < weighted.factors.size(); ++f)
    for (std::size_t l = 0; l < lines_.size(); ++l) {
      for (std::size_t b = 0; b < many; ++b)
        scaled_[b] = product(weighted.factors[f], value_[l * many + b]);
      const std::size_t line = (weighted.field + f) * cosine_.size() + lines_[l];
      Complex* to = &grid_[(line * axis_.size() + first) * many];
      for (int i = 0; i < axis_.width(); ++i, to += many)
        for (std::size_t b = 0; b < many; ++b)
          to[b] += product(scaled_[b], weights[static_cast<std::size_t>(i)]);
    }
}

double LineSums::squared_error(const PathEnd& end) {
  choose_lines(end.x);
  if (lines_.empty()) return 0;
  choose_directions(node_);
  find_factors(end);
  const std::vector<Complex> at_nodes = value_;
  const FarCamera& camera = box_.camera();
  std::vector<double> pixel;
  for (std::size_t i = 0; i < camera.pixels; ++i)
    pixel.push_back(camera.cosine(0, i) / camera.aperture);
  choose_directions(pixel);
  find_factors(end);
  double sum = 0;
  for (std::size_t p = 0; p < pixel.size(); ++p) {
    const auto weights = lagrange(node_, pixel[p]);
    for (std::size_t l = 0; l < lines_.size(); ++l) {
      Complex off = -value_[l * pixel.size() + p];
      for (std::size_t b = 0; b < node_.size(); ++b)
        off += weights[b] * at_nodes[l * node_.size() + b];
      sum += std::norm(off);
    }
  }
  return sum / static_cast<double>(camera.pixels * camera.pixels);
}

void LineSums::finish(std::span<Complex> out) const {
  const FarCamera& camera = box_.camera();
  const std::size_t pixels = camera.pixels, many = axis_.size() * node_.size();
  const auto matrix = axis_.to_pixels(camera, camera.axis.*across_, box_.k(), node_);
  std::vector<Complex> image(pixels * pixels);
  const Complex one = 1, zero = 0;
  for (std::size_t f = 0; f < fields_; ++f) {
    // Image [line][pixel of the line]
    cblas_zgemm(CblasRowMajor, CblasNoTrans, CblasTrans, blas_size(pixels), blas_size(pixels),
                blas_size(many), &one, &grid_[f * pixels * many], blas_size(many), matrix.data(),
                blas_size(many), &zero, image.data(), blas_size(pixels));
    for (std::size_t line = 0; line < pixels; ++line)
      for (std::size_t p = 0; p < pixels; ++p) {
        const bool columns = along_ == &Vec::x;
        const std::size_t row = columns ? p : line, column = columns ? line : p;
        const Vec w = box_.pixel(row, column);
        // Phase of the middle of the box, from which depths were measured
        out[(f * pixels + row) * pixels + column] += product(
            image[line * pixels + p], std::polar(1.0, -box_.k() * w.z * box_.box().depth / 2));
      }
  }
}

CameraSides::CameraSides(const CameraBox& box, const CameraResolution& resolution,
                         std::size_t fields)
    : box_(box), columns_(box, true, resolution, fields), rows_(box, false, resolution, fields) {
  const FarCamera& camera = box.camera();
  for (std::size_t row = 0; row < camera.pixels; ++row)
    for (std::size_t column = 0; column < camera.pixels; ++column)
      direction_.push_back(box.pixel(row, column));
  for (const Vec w : direction_) per_cosine_.push_back(1 / std::abs(w.z));
  field_.resize(fields * direction_.size());
}

void CameraSides::add(std::span<const WeightedEnd> ends) {
  const auto add_lines = [&](LineSums& lines) {
    std::vector<const WeightedEnd*> order;
    for (const WeightedEnd& weighted : ends)
      if (lines.reached(weighted.end.x)) order.push_back(&weighted);
    std::ranges::sort(order, {}, [&](const WeightedEnd* of) { return lines.place(of->end); });
    for (const WeightedEnd* weighted : order) lines.add(*weighted);
  };
  add_lines(columns_);
  add_lines(rows_);
  for (const WeightedEnd& weighted : ends)
    if (columns_.reached(weighted.end.x) || rows_.reached(weighted.end.x)) add_pixels(weighted);
}

void CameraSides::choose_pixels(Vec x) {
  using Leaves = LineSums::Leaves;
  const std::size_t count = box_.camera().pixels;
  std::vector<std::size_t> all(count), reached, partly;
  std::iota(all.begin(), all.end(), 0);
  std::vector<Leaves> column(count);
  for (std::size_t i = 0; i < count; ++i) {
    column[i] = columns_.leaves(x, i);
    if (column[i] != Leaves::none) reached.push_back(i);
    if (column[i] == Leaves::part) partly.push_back(i);
  }
  pixels_.clear(), wanted_.clear(), added_.clear();
  for (std::size_t row = 0; row < count; ++row) {
    const Leaves leaves = rows_.leaves(x, row);
    const auto& chosen = leaves == Leaves::none ? partly : leaves == Leaves::part ? all : reached;
    const double to_row = rows_.distance(x, row);
    for (const std::size_t i : chosen) {
      const std::size_t pixel = row * count + i;
      const double to_face = box_.depth_of(x) * per_cosine_[pixel],
                   to_column = columns_.distance(x, i);
      double wanted = std::min({to_face, to_column, to_row}), added = to_face;
      if (leaves == Leaves::whole && column[i] == Leaves::whole)
        wanted = to_face, added = std::max(to_row, to_column);
      else if (leaves == Leaves::whole)
        added = to_row;
      else if (column[i] == Leaves::whole)
        added = to_column;
      if (wanted == added) continue;
      pixels_.push_back(pixel);
      wanted_.push_back(-box_.mu_t() * wanted / 2);
      added_.push_back(-box_.mu_t() * added / 2);
    }
  }
}

void CameraSides::add_pixels(const WeightedEnd& weighted) {
  const PathEnd& end = weighted.end;
  choose_pixels(end.x);
  const std::size_t count = pixels_.size();
  if (count == 0) return;
  directions_ = Directions(count);
  phase_.resize(count), zero_.resize(count), value_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec w = direction_[pixels_[i]];
    put(directions_, i, w);
    phase_[i] = -box_.k() * dot(w, end.place);
  }
  damped_phasors(phase_, zero_, value_);
  damping(wanted_, wanted_);
  damping(added_, added_);
  for (std::size_t i = 0; i < count; ++i) value_[i] *= wanted_[i] - added_[i];
  box_.walks().towards(end.x, end.arrival, directions_, value_);
  for (std::size_t f = 0; f < weighted.factors.size(); ++f) {
    Complex* const to = &field_[(weighted.field + f) * direction_.size()];
    for (std::size_t i = 0; i < count; ++i)
      to[pixels_[i]] += product(weighted.factors[f], value_[i]);
  }
}

void CameraSides::finish(std::span<Complex> out) const {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += field_[i];
  columns_.finish(out);
  rows_.finish(out);
}

}  // namespace flatspeckle::mc
