#include "wave_solver/equations/wave_equations.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <omp.h>

#include "core/error.h"
#include "core/numbers/address_space.h"
#include "core/numbers/complex.h"
#include "core/numbers/hankel_array.h"
#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

int concurrent_systems() {
  return omp_in_parallel() ? omp_get_num_threads() : 1;
}

// Inside a parallel region the other threads have already allocated their share of address space.
double memory_of_system(int together) {
  constexpr double share = 0.9;
  const double address_space = address_space_left() / (omp_in_parallel() ? 1 : together);
  return share * std::min(physical_memory() / together, address_space);
}

void require_dense_memory(std::size_t unknowns, int together) {
  const auto n = static_cast<double>(unknowns);
  const double bytes = sizeof(Complex) * n * n, memory = memory_of_system(together);
  if (bytes <= memory) return;
  const auto whole = [](double value) { return std::to_string(static_cast<long long>(value)); };
  const bool many = together > 1;
  throw InputError("unknowns", unknowns,
                   "the dense matrix needs " + whole(bytes) +
                       " bytes; available bytes: " + whole(memory) +
                       (many ? " for each of " + std::to_string(together) + " threads" : "") +
                       "; use fewer scatterers, wider gaps" + (many ? ", fewer threads" : "") +
                       " or a larger tolerance");
}

namespace {

constexpr std::size_t threads_pay_from = 300;  // number of unknowns from which threads save time

}  // namespace

void WaveEquations::add(const Body& body, std::span<const Mode> modes) {
  const std::size_t number = bodies_.size();
  bodies_.push_back(body);
  modes_.insert(modes_.end(), modes.begin(), modes.end());
  body_of_.resize(modes_.size(), number);
  first_.push_back(modes_.size());
}

void WaveEquations::add(const Body& body, std::span<const Mode> modes,
                        std::span<const Complex> diagonal) {
  add(body, modes);
  diagonal_.insert(diagonal_.end(), diagonal.begin(), diagonal.end());
  own_.emplace_back();
}

void WaveEquations::add(const Body& body, std::span<const Mode> modes, OwnBlock own) {
  add(body, modes);
  for (std::size_t i = 0; i < modes.size(); ++i)
    diagonal_.push_back((*own)[i * (modes.size() + 1)]);
  own_.push_back(std::move(own));
}

int WaveEquations::order(std::size_t body) const {
  return modes_[first_[body + 1] - 1].order;
}

double WaveEquations::strength(std::size_t unknown) const {
  const auto weight = static_cast<double>(modes_[unknown].weight);
  return (modes_[unknown].order == 0 ? 2 : 1) * weight * weight;
}

Complex WaveEquations::own(std::size_t row, std::size_t column) const {
  const std::size_t body = body_of_[row];
  if (!own_[body]) return row == column ? diagonal_[row] : Complex();
  const std::size_t first = first_[body], size = first_[body + 1] - first;
  return (*own_[body])[row - first + size * (column - first)];
}

ModeSet WaveEquations::modes(std::size_t j) const {
  return {bodies_[j].centre, std::span(modes_).subspan(first_[j], first_[j + 1] - first_[j]),
          order(j)};
}

// The modes of a list of unknowns. Unknowns of the same body that follow one another in the list (a
// run) form one ModeSet.
struct WaveEquations::Listed {
  Listed(const WaveEquations& system, std::span<const std::size_t> unknowns) {
    modes.reserve(unknowns.size());
    for (std::size_t unknown : unknowns) {
      const std::size_t j = system.body_of_[unknown];
      const Mode& mode = modes.emplace_back(system.modes_[unknown]);
      if (runs.empty() || bodies.back() != j) {
        bodies.push_back(j);
        first.push_back(modes.size() - 1);
        runs.push_back({system.bodies_[j].centre, {&mode, 0}, 0});
      }
      ModeSet& run = runs.back();
      run.modes = {run.modes.data(), run.modes.size() + 1};
      run.order = std::max(run.order, mode.order);
    }
  }

  std::vector<Mode> modes;
  std::vector<ModeSet> runs;
  std::vector<std::size_t> bodies, first;  // for each run: its body; its first index in the list
};

void WaveEquations::entries(std::span<const std::size_t> rows, std::span<const std::size_t> columns,
                            Complex* out, std::size_t ld) const {
  const Listed receivers(*this, rows), senders(*this, columns);
  for (std::size_t s = 0; s < senders.runs.size(); ++s) {
    Complex* const block = out + ld * senders.first[s];
    translate_copies(receivers.runs, senders.runs[s], {block, ld});
    const auto own_columns = columns.subspan(senders.first[s], senders.runs[s].modes.size());
    for (std::size_t r = 0; r < receivers.runs.size(); ++r) {
      if (receivers.bodies[r] != senders.bodies[s]) continue;
      for (std::size_t j = 0; j < own_columns.size(); ++j)
        for (std::size_t i = 0; i < receivers.runs[r].modes.size(); ++i)
          block[receivers.first[r] + i + ld * j] +=
              own(rows[receivers.first[r] + i], own_columns[j]);
    }
  }
}

void WaveEquations::outgoing(std::span<const Vec> points, std::span<const std::size_t> columns,
                             Complex* out, std::size_t ld) const {
  const Listed senders(*this, columns);
  for (std::size_t s = 0; s < senders.runs.size(); ++s)
    field_at(k_, points, senders.runs[s], {out + ld * senders.first[s], ld});
}

void WaveEquations::translate_copies(std::span<const ModeSet> receivers, const ModeSet& sender,
                                     Target out, bool reversed) const {
  translate(k_, receivers, sender, out);
  if (copies_.count == 0) return;
  std::size_t rows = 0;
  for (const ModeSet& receiver : receivers) rows += receiver.modes.size();
  std::vector<Complex> part(rows * sender.modes.size());
  ModeSet copy = sender;
  for (int n = -copies_.count; n <= copies_.count; ++n) {
    if (n == 0) continue;
    copy.centre.x = sender.centre.x + n * copies_.period;
    translate(k_, receivers, copy, {part.data(), rows});
    const Complex factor = copies_.factor(reversed ? -n : n);
    for (std::size_t column = 0; column < sender.modes.size(); ++column)
      for (std::size_t row = 0; row < rows; ++row)
        out.data[row + out.ld * column] += product(factor, part[row + rows * column]);
  }
}

std::vector<ModeSet> WaveEquations::all_modes() const {
  std::vector<ModeSet> all;
  all.reserve(bodies_.size());
  for (std::size_t j = 0; j < bodies_.size(); ++j) all.push_back(modes(j));
  return all;
}

// Fills M if every body has a single unknown, of order 0. Hankel functions are evaluated for arrays
// of distances.
void WaveEquations::point_columns(Complex* matrix) const {
  const std::size_t size = unknowns();
  std::vector<double> strength(size);
  std::vector<Vec> positions(size);
  for (std::size_t j = 0; j < size; ++j) {
    strength[j] = std::numbers::sqrt2 * static_cast<double>(modes_[j].weight);
    positions[j] = bodies_[j].centre;
  }
  const auto fill = [&](std::size_t j) {
    Complex* const column = matrix + j * (size + 1);
    std::vector<double> distance(size - j);
    for (std::size_t i = 1; i < distance.size(); ++i) {
      const Vec d = positions[j + i] - positions[j];
      distance[i] = k_ * std::sqrt(dot(d, d));
    }
    column[0] = diagonal_[j];
    hankel0(std::span(distance).subspan(1), {column + 1, distance.size() - 1});
    for (std::size_t i = 1; i < distance.size(); ++i) column[i] *= strength[j] * strength[j + i];
  };
  parallel_for((size + tile_side - 1) / tile_side, size > threads_pay_from, [&](std::size_t part) {
    const std::size_t begin = part * tile_side, end = std::min(begin + tile_side, size);
    for (std::size_t j = begin; j < end; ++j) fill(j);
    mirror_columns(matrix, size, begin, end);
  });
}

void WaveEquations::multipole_columns(Complex* matrix) const {
  const std::size_t size = unknowns();
  const auto all = all_modes();
  parallel_for(all.size(), size > threads_pay_from, [&](std::size_t j) {
    Complex* const corner = matrix + first_[j] * (size + 1);
    const std::size_t height = all[j].modes.size();
    if (copies_.symmetric())
      translate_copies(std::span(all).subspan(j), all[j], {corner, size});
    else
      translate_copies(all, all[j], {corner - first_[j], size});
    for (std::size_t i = 0; i < height; ++i)
      for (std::size_t l = 0; l < height; ++l)
        corner[i * size + l] += own(first_[j] + l, first_[j] + i);
    if (copies_.symmetric()) mirror_columns(matrix, size, first_[j], first_[j + 1]);
  });
}

Entries WaveEquations::matrix() const {
  require_dense_memory(unknowns());
  const std::size_t size = unknowns();
  Entries matrix(size * size);
  if (size == bodies_.size() && copies_.count == 0)
    point_columns(matrix.data());
  else
    multipole_columns(matrix.data());
  return matrix;
}

// Divides the bodies into groups of consecutive bodies, whose columns of M form a block for BLAS.
// Returns 0, followed by the end of each group.
std::vector<std::size_t> WaveEquations::column_blocks() const {
  constexpr std::size_t most_columns = 64;
  std::vector<std::size_t> ends{0};
  for (std::size_t j = 1; j < first_.size(); ++j)
    if (j + 1 == first_.size() || first_[j + 1] - first_[ends.back()] > most_columns)
      ends.push_back(j);
  return ends;
}

// Adds to y the product of x and the diagonal blocks of M that belong to bodies begin .. end - 1.
void WaveEquations::add_own(std::size_t begin, std::size_t end, const Complex* x,
                            Complex* y) const {
  for (std::size_t body = begin; body < end; ++body)
    for (std::size_t row = first_[body]; row < first_[body + 1]; ++row)
      if (own_[body])
        for (std::size_t i = first_[body]; i < first_[body + 1]; ++i) y[row] += own(row, i) * x[i];
      else
        y[row] += diagonal_[row] * x[row];
}

// Computes the columns of M^T for one group of bodies at a time. The transpose of these columns is
// the group's rows of M, which give its rows of the product.
std::vector<Complex> WaveEquations::apply(std::span<const Complex> x) const {
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
      translate_copies(all, all[j], {&block[size * (first_[j] - begin)], size}, true);
    multiply(CblasTrans, CblasNoTrans, width, columns, size, 1, block.data(), size, x.data(), size,
             0, &y[begin], size);
    for (std::size_t column = 0; column < columns; ++column)
      add_own(ends[part], ends[part + 1], &x[column * size], &y[column * size]);
  });
  return y;
}

// Expands plane waves of amplitude `factor` in the regular modes of all bodies: [wave][unknown].
// The waves travel along `sign` times the directions of the angles.
std::vector<Complex> WaveEquations::plane_waves(std::span<const double> angles, double sign,
                                                Complex factor) const {
  std::vector<Complex> waves(angles.size() * unknowns());
  const auto receivers = all_modes();
  for (std::size_t wave = 0; wave < angles.size(); ++wave)
    expand_plane_wave(k_, receivers, sign * direction(angles[wave]), factor,
                      std::span(waves).subspan(wave * unknowns(), unknowns()));
  return waves;
}

std::vector<Complex> WaveEquations::plane_waves(std::span<const WaveDirection> directions,
                                                Vec origin) const {
  return plane_waves(directions, origin, all_modes(), unknowns());
}

std::vector<Complex> WaveEquations::plane_waves(std::span<const WaveDirection> directions,
                                                Vec origin,
                                                std::span<const std::size_t> unknowns) const {
  return plane_waves(directions, origin, Listed(*this, unknowns).runs, unknowns.size());
}

std::vector<Complex> WaveEquations::plane_waves(std::span<const WaveDirection> directions,
                                                Vec origin, std::span<const ModeSet> receivers,
                                                std::size_t unknowns) const {
  std::vector<Complex> waves(directions.size() * unknowns);
  parallel_for(directions.size(), [&](std::size_t wave) {
    const WaveDirection& w = directions[wave];
    expand_plane_wave(k_, receivers, w,
                      std::exp(Complex(0, -k_) * (w.x * origin.x + w.z * origin.z)),
                      std::span(waves).subspan(wave * unknowns, unknowns));
  });
  return waves;
}

std::vector<Complex> WaveEquations::right_hand_sides(std::span<const double> light_angles) const {
  return plane_waves(light_angles, 1, -1);
}

std::vector<Complex> WaveEquations::far_rows(std::span<const double> view_angles) const {
  const double size = std::sqrt(2 / (std::numbers::pi * k_));
  return plane_waves(view_angles, -1, std::polar(size, -std::numbers::pi / 4));
}

std::vector<Complex> WaveEquations::outside_row(Vec point) const {
  std::vector<Complex> row(unknowns());
  const Mode value{0, false, root_half};  // the field is the coefficient of J_0 about the point
  const ModeSet receiver{point, {&value, 1}, 0};
  for (std::size_t j = 0; j < bodies_.size(); ++j)
    translate_copies({&receiver, 1}, modes(j), {&row[first_[j]], 1});
  return row;
}

std::vector<Complex> WaveEquations::view_rows(std::span<const View> views) const {
  std::vector<Complex> rows;
  rows.reserve(views.size() * unknowns());
  for (const View& view : views) {
    const auto row = view.near ? outside_row(view.point) : far_rows({&view.angle, 1});
    rows.insert(rows.end(), row.begin(), row.end());
  }
  return rows;
}

}  // namespace flatspeckle::wave
