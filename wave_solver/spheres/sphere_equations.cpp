#include "wave_solver/spheres/sphere_equations.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numbers/bessel.h"
#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/equations/wave_equations.h"
#include "wave_solver/spheres/incident_waves.h"

namespace flatspeckle::wave {

namespace {

constexpr std::size_t threaded_from = 300;  // number of unknowns from which threads save time

}  // namespace

SphereEquations::SphereEquations(Placement placement, double k, const Basis& basis)
    : k_(k), placement_(std::move(placement)), first_{0} {
  std::vector<std::size_t> begin;
  for (std::size_t j = 0; j < placement_.size(); ++j) {
    centres_.add(placement_[j].position);
    begin.push_back(t_.size());
    for (std::size_t l = 0; l < basis.t[j].size(); ++l) {
      const ScaledReal size = abs(basis.t[j][l]);
      const Complex own =
          size.value() > 0 ? -static_cast<Complex>(size / basis.t[j][l]) : Complex(1);
      degree_.insert(degree_.end(), 2 * l + 1, t_.size());
      diagonal_.insert(diagonal_.end(), 2 * l + 1, own);
      t_.push_back(static_cast<ExtendedComplex>(basis.t[j][l]));
      sigma_.push_back(static_cast<long double>(sqrt(size)));
    }
    first_.push_back(degree_.size());
  }
  for (std::size_t j = 0; j < placement_.size(); ++j)
    sets_.push_back({placement_[j].position, static_cast<int>(basis.t[j].size()) - 1,
                     std::span(sigma_).subspan(begin[j], basis.t[j].size())});
}

double SphereEquations::strength(std::size_t unknown) const {
  return static_cast<double>(std::abs(t_matrix(unknown)));
}

Entries SphereEquations::matrix() const {
  require_dense_memory(unknowns());
  Entries matrix(unknowns() * unknowns());
  only_points() ? point_columns(matrix.data()) : sphere_columns(matrix.data());
  return matrix;
}

void SphereEquations::point_columns(Complex* matrix) const {
  const std::size_t size = unknowns();
  std::vector<double> sigma(sigma_.begin(), sigma_.end());
  parallel_for((size + tile_side - 1) / tile_side, size > threaded_from, [&](std::size_t part) {
    const std::size_t begin = part * tile_side, end = std::min(begin + tile_side, size);
    std::vector<double> re(size), im(size);
    for (std::size_t j = begin; j < end; ++j) {
      Complex* const column = matrix + j * size;
      const std::size_t below = size - j - 1;
      column[j] = diagonal_[j];
      if (below > 0)
        point_waves(k_, centres_, j + 1, placement_[j].position, std::span(re).first(below),
                    std::span(im).first(below));
      for (std::size_t i = 0; i < below; ++i) {
        const double weight = sigma[j] * sigma[j + 1 + i];
        column[j + 1 + i] = {weight * re[i], weight * im[i]};
      }
    }
    mirror_columns(matrix, size, begin, end);
  });
}

void SphereEquations::sphere_columns(Complex* matrix) const {
  const std::size_t size = unknowns();
  parallel_for(sets_.size(), size > threaded_from, [&](std::size_t j) {
    const std::size_t begin = first_[j], height = first_[j + 1] - begin;
    Complex* const corner = matrix + begin * (size + 1);
    for (std::size_t i = 0; i < height; ++i)
      for (std::size_t l = 0; l < height; ++l)
        corner[i * size + l] = i == l ? diagonal_[begin + i] : Complex();
    translate(k_, std::span(sets_).subspan(j + 1), sets_[j], {corner + height, size});
    mirror_columns(matrix, size, begin, first_[j + 1]);
  });
}

std::vector<Complex> SphereEquations::apply(std::span<const Complex> x) const {
  if (unknowns() == 0) return {};
  return only_points() ? apply_points(x) : apply_spheres(x);
}

// Computes the waves of a tile of points at a time, and multiplies them by all columns.
std::vector<Complex> SphereEquations::apply_points(std::span<const Complex> x) const {
  constexpr std::size_t chunk = 256, receivers = 32;
  const std::size_t size = unknowns(), columns = x.size() / size;
  const std::vector<double> sigma(sigma_.begin(), sigma_.end());
  std::vector<Complex> sources(x.begin(), x.end()), y(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) sources[i] *= sigma[i % size];
  parallel_for((size + receivers - 1) / receivers, size > threaded_from, [&](std::size_t part) {
    std::vector<double> re(chunk), im(chunk);
    std::vector<Complex> waves(chunk * receivers), sums(columns * receivers);
    const std::size_t begin = part * receivers, rows = std::min(receivers, size - begin);
    for (std::size_t first = 0; first < size; first += chunk) {
      const std::size_t count = std::min(chunk, size - first);
      for (std::size_t i = 0; i < rows; ++i) {
        point_waves(k_, centres_, first, placement_[begin + i].position, std::span(re).first(count),
                    std::span(im).first(count));
        for (std::size_t j = 0; j < count; ++j) waves[i * chunk + j] = {re[j], im[j]};
      }
      multiply(CblasTrans, CblasNoTrans, rows, columns, count, 1, waves.data(), chunk,
               &sources[first], size, 1, sums.data(), receivers);
    }
    for (std::size_t column = 0; column < columns; ++column)
      for (std::size_t i = 0; i < rows; ++i) {
        const std::size_t at = column * size + begin + i;
        y[at] = diagonal_[begin + i] * x[at] + sigma[begin + i] * sums[column * receivers + i];
      }
  });
  return y;
}

// Because M is symmetric, the transpose of the columns of one sphere gives its rows of the product.
std::vector<Complex> SphereEquations::apply_spheres(std::span<const Complex> x) const {
  const std::size_t size = unknowns(), columns = x.size() / size;
  std::vector<Complex> y(x.size());
  parallel_for(sets_.size(), size > threaded_from, [&](std::size_t j) {
    const std::size_t begin = first_[j], width = first_[j + 1] - begin;
    std::vector<Complex> block(size * width);
    translate(k_, sets_, sets_[j], {block.data(), size});
    for (std::size_t i = 0; i < width; ++i) block[begin + i + size * i] = diagonal_[begin + i];
    multiply(CblasTrans, CblasNoTrans, width, columns, size, 1, block.data(), size, x.data(), size,
             0, &y[begin], size);
  });
  return y;
}

std::vector<Complex> SphereEquations::right_hand_sides(const Lights& lights,
                                                       double tolerance) const {
  std::vector<Complex> sides(lights.size() * unknowns());
  for (std::size_t number = 0; number < lights.size(); ++number) {
    const Light& light = lights[number];
    if (light.kind == Light::Kind::point) require_outside(placement_, light.point);
    add_incident(k_, sets_, light, tolerance, -1,
                 std::span(sides).subspan(number * unknowns(), unknowns()));
  }
  return sides;
}

// By reciprocity the row of a far view is a multiple of the waves of the light that comes from it.
std::vector<Complex> SphereEquations::view_rows(std::span<const View> views) const {
  std::vector<Complex> rows(views.size() * unknowns());
  const Complex factor(0, -1 / (4 * std::numbers::pi * k_));
  for (std::size_t number = 0; number < views.size(); ++number) {
    const auto row = std::span(rows).subspan(number * unknowns(), unknowns());
    if (views[number].near)
      add_outgoing(k_, sets_, views[number].point, 1, row);
    else
      add_plane_wave(k_, sets_, -views[number].direction(), factor, row);
  }
  return rows;
}

}  // namespace flatspeckle::wave
