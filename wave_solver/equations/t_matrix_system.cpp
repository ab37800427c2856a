#include "wave_solver/equations/t_matrix_system.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numbers/hankel_array.h"
#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/equations/basis_order.h"
#include "wave_solver/equations/system_memory.h"
#include "wave_solver/equations/tiles.h"

namespace flatspeckle::wave {

namespace {

constexpr std::size_t worth_threads = 300;  // unknowns

}  // namespace

TMatrixSystem::TMatrixSystem(Placement placement, double k, double tolerance,
                             std::span<const Vec2> sensors)
    : placement_(std::move(placement)), k_(k), first_{0} {
  const auto t = basis(placement_, k, tolerance, sensors);
  for (std::size_t j = 0; j < placement_.size(); ++j) {
    t_.emplace_back();
    for (int n = 0; n < static_cast<int>(t[j].size()); ++n) {
      const ScaledReal size = abs(t[j][n]), sigma = sqrt(size);
      const Complex diagonal =
          size.value() > 0 ? -static_cast<Complex>(size / t[j][n]) : Complex(1);
      t_[j].push_back(static_cast<ExtendedComplex>(t[j][n]));
      for (const bool odd : {false, true}) {
        if (n == 0 && odd) continue;
        modes_.push_back({n, odd, n == 0 ? root_half * sigma : sigma});
        diagonal_.push_back(diagonal);
        scatterer_.push_back(j);
      }
    }
    first_.push_back(modes_.size());
  }
}

ModeSet TMatrixSystem::modes(std::size_t j) const {
  return {placement_[j].position, std::span(modes_).subspan(first_[j], first_[j + 1] - first_[j]),
          order(j)};
}

// Unknowns as mode sets, one for each run of one scatterer.
struct TMatrixSystem::Listed {
  Listed(const TMatrixSystem& system, std::span<const std::size_t> unknowns) {
    modes.reserve(unknowns.size());
    for (std::size_t unknown : unknowns) {
      const std::size_t j = system.scatterer_[unknown];
      const Mode& mode = modes.emplace_back(system.modes_[unknown]);
      if (runs.empty() || scatterers.back() != j) {
        scatterers.push_back(j);
        first.push_back(modes.size() - 1);
        runs.push_back({system.placement_[j].position, {&mode, 0}, 0});
      }
      ModeSet& run = runs.back();
      run.modes = {run.modes.data(), run.modes.size() + 1};
      run.order = std::max(run.order, mode.order);
    }
  }

  std::vector<Mode> modes;
  std::vector<ModeSet> runs;
  std::vector<std::size_t> scatterers, first;  // of each run; its first place in the list
};

void TMatrixSystem::entries(std::span<const std::size_t> rows, std::span<const std::size_t> columns,
                            Complex* out, std::size_t ld) const {
  const Listed receivers(*this, rows), senders(*this, columns);
  for (std::size_t s = 0; s < senders.runs.size(); ++s) {
    Complex* const block = out + ld * senders.first[s];
    translate(k_, receivers.runs, senders.runs[s], {block, ld});
    const auto own_columns = columns.subspan(senders.first[s], senders.runs[s].modes.size());
    for (std::size_t r = 0; r < receivers.runs.size(); ++r) {
      if (receivers.scatterers[r] != senders.scatterers[s]) continue;
      for (std::size_t i = 0; i < receivers.runs[r].modes.size(); ++i)
        for (std::size_t j = 0; j < own_columns.size(); ++j)
          if (rows[receivers.first[r] + i] == own_columns[j])
            block[receivers.first[r] + i + ld * j] = diagonal_[own_columns[j]];
    }
  }
}

void TMatrixSystem::outgoing(std::span<const Vec2> points, std::span<const std::size_t> columns,
                             Complex* out, std::size_t ld) const {
  const Listed senders(*this, columns);
  for (std::size_t s = 0; s < senders.runs.size(); ++s)
    field_at(k_, points, senders.runs[s], {out + ld * senders.first[s], ld});
}

std::vector<ModeSet> TMatrixSystem::all_modes() const {
  std::vector<ModeSet> all;
  for (std::size_t j = 0; j < placement_.size(); ++j) all.push_back(modes(j));
  return all;
}

// Order 0 everywhere: plain arrays of distances.
void TMatrixSystem::point_columns(Complex* matrix) const {
  const std::size_t size = unknowns();
  std::vector<double> strength(size);
  std::vector<Vec2> positions(size);
  for (std::size_t j = 0; j < size; ++j) {
    strength[j] = std::numbers::sqrt2 * static_cast<double>(modes_[j].weight);
    positions[j] = placement_[j].position;
  }
  const auto fill = [&](std::size_t j) {
    Complex* const column = matrix + j * (size + 1);
    std::vector<double> distance(size - j);
    for (std::size_t i = 1; i < distance.size(); ++i) {
      const Vec2 d = positions[j + i] - positions[j];
      distance[i] = k_ * std::sqrt(dot(d, d));
    }
    column[0] = diagonal_[j];
    hankel0(std::span(distance).subspan(1), {column + 1, distance.size() - 1});
    for (std::size_t i = 1; i < distance.size(); ++i) column[i] *= strength[j] * strength[j + i];
  };
  parallel_for((size + tile - 1) / tile, size > worth_threads, [&](std::size_t part) {
    const std::size_t begin = part * tile, end = std::min(begin + tile, size);
    for (std::size_t j = begin; j < end; ++j) fill(j);
    mirror_columns(matrix, size, begin, end);
  });
}

void TMatrixSystem::multipole_columns(Complex* matrix) const {
  const std::size_t size = unknowns();
  const auto all = all_modes();
  parallel_for(all.size(), size > worth_threads, [&](std::size_t j) {
    Complex* const corner = matrix + first_[j] * (size + 1);
    const std::size_t height = all[j].modes.size();
    for (std::size_t i = 0; i < height; ++i) {
      std::fill_n(corner + i * size, height, Complex());
      corner[i * (size + 1)] = diagonal_[first_[j] + i];
    }
    translate(k_, std::span(all).subspan(j + 1), all[j], {corner + height, size});
    mirror_columns(matrix, size, first_[j], first_[j + 1]);
  });
}

Entries TMatrixSystem::matrix() const {
  require_dense_memory(unknowns());
  const std::size_t size = unknowns();
  Entries matrix(size * size);
  if (size == placement_.size())
    point_columns(matrix.data());
  else
    multipole_columns(matrix.data());
  return matrix;
}

// Scatterers one after the other whose columns make a block for BLAS; one at the least. Ends of
// them, the first 0.
std::vector<std::size_t> TMatrixSystem::column_blocks() const {
  constexpr std::size_t most_columns = 64;
  std::vector<std::size_t> ends{0};
  for (std::size_t j = 1; j < first_.size(); ++j)
    if (j + 1 == first_.size() || first_[j + 1] - first_[ends.back()] > most_columns)
      ends.push_back(j);
  return ends;
}

// M is symmetric: the columns of some scatterers, transposed, make their rows of the product.
std::vector<Complex> TMatrixSystem::apply(std::span<const Complex> x) const {
  const std::size_t size = unknowns();
  if (size == 0) return {};
  std::vector<Complex> y(x.size());
  const std::size_t columns = x.size() / size;
  const auto all = all_modes();
  const auto ends = column_blocks();
  parallel_for(ends.size() - 1, [&](std::size_t part) {
    const std::size_t begin = first_[ends[part]], width = first_[ends[part + 1]] - begin;
    std::vector<Complex> block(size * width);
    for (std::size_t j = ends[part]; j < ends[part + 1]; ++j)
      translate(k_, all, all[j], {&block[size * (first_[j] - begin)], size});
    multiply(CblasTrans, CblasNoTrans, width, columns, size, 1, block.data(), size, x.data(), size,
             0, &y[begin], size);
    for (std::size_t column = 0; column < columns; ++column)
      for (std::size_t row = begin; row < begin + width; ++row)
        y[column * size + row] += diagonal_[row] * x[column * size + row];
  });
  return y;
}

void TMatrixSystem::plane_wave(Vec2 w, Complex factor, std::span<Complex> column) const {
  std::vector<ModeSet> receivers;
  for (std::size_t j = 0; j < placement_.size(); ++j) receivers.push_back(modes(j));
  expand_plane_wave(k_, receivers, w, factor, column);
}

std::vector<Complex> TMatrixSystem::right_sides(std::span<const double> light_angles) const {
  std::vector<Complex> sides(light_angles.size() * unknowns());
  for (std::size_t light = 0; light < light_angles.size(); ++light)
    plane_wave(direction(light_angles[light]), -1,
               std::span(sides).subspan(light * unknowns(), unknowns()));
  return sides;
}

std::vector<Complex> TMatrixSystem::source_side(Vec2 source) const {
  auto side = near_row(source);
  for (Complex& value : side) value *= Complex(0, -0.25);
  return side;
}

std::vector<Complex> TMatrixSystem::far_row(double view_angle) const {
  std::vector<Complex> row(unknowns());
  const double size = std::sqrt(2 / (std::numbers::pi * k_));
  plane_wave(-direction(view_angle), std::polar(size, -std::numbers::pi / 4), row);
  return row;
}

std::vector<Complex> TMatrixSystem::near_row(Vec2 point) const {
  require_outside(placement_, point);
  std::vector<Complex> row(unknowns());
  for (std::size_t j = 0; j < placement_.size(); ++j)
    field_at(k_, {&point, 1}, modes(j), {&row[first_[j]], 1});
  return row;
}

}  // namespace flatspeckle::wave
