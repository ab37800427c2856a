#include "grin/render/distant/distance_importance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/SparseCholesky>

#include "grin/rays/surfaces/interface.h"

namespace flatspeckle::grin {

namespace {

double share_within(double r, double distance, double radius) {
  if (!(radius > 0) || r >= distance + radius || distance >= r + radius) return 0;
  if (r + distance <= radius) return 1;
  const double cosine = (r * r + distance * distance - radius * radius) / (2 * r * distance);
  return std::acos(std::clamp(cosine, -1.0, 1.0)) / std::numbers::pi;
}

/// Returns the outward flux of diffuse light at a plane, divided by its fluence rate. The reflected
/// shares of fluence rate and flux follow from Fresnel's law [haskell1994].
double flux_through(double excess, double excess_outside) {
  constexpr int points = 256;
  double fluence = 0, flux = 0;
  for (int i = 0; i < points; ++i) {
    const double cosine = (i + 0.5) / points, sine = std::sqrt(1 - cosine * cosine);
    const Interface face((1 + excess) * Vec3(sine, 0, cosine), Vec3::UnitZ(), excess,
                         excess_outside);
    fluence += 2 * cosine * face.reflectance() / points;
    flux += 3 * cosine * cosine * face.reflectance() / points;
  }
  return (1 - fluence) / (2 * (1 + flux));
}

/// Returns the mean of exp(-decay (1 - cos)) over the phase function.
double mean_decay(const SpacePhaseFunction& phase, double decay) {
  constexpr int samples = 4096;
  if (decay == 0) return 1;
  RandomStream random(0, static_cast<std::uint64_t>(Stream::render), 0);
  double sum = 0;
  for (int i = 0; i < samples; ++i) sum += std::exp(-decay * phase.one_minus_cosine(random));
  return sum / samples;
}

double reduced_scattering(const ScatteringMedium& medium) {
  return medium.mu_s * (1 - medium.phase.mean_cosine());
}

/// Selects the delays that the importance is made for: none, the first, the middle and the last.
std::vector<double> some_delays(const FieldDecay* decay) {
  std::vector<double> some{0};
  if (!decay) return some;
  std::vector<double> all = decay->delays;
  std::ranges::sort(all);
  for (const std::size_t i : {std::size_t{0}, all.size() / 2, all.size() - 1})
    if (all[i] > some.back()) some.push_back(all[i]);
  return some;
}

}  // namespace

double RingTarget::share(double r) const {
  return share_within(r, distance, outer) - share_within(r, distance, inner);
}

DistanceImportance::DistanceImportance(const LevelLayers& layers,
                                       const std::vector<RingTarget>& targets, const Vec3& start,
                                       bool goes_up, const FieldDecay* decay, int cells)
    : delays_(some_delays(decay)) {
  constexpr int fewest_rows = 24;
  const LevelLayer &first = layers.layers()[layers.first()], &last = layers.layers()[layers.last()];
  double farthest = 0;
  for (const RingTarget& target : targets)
    farthest = std::max(farthest, target.distance + target.outer);
  const double depth = std::clamp(start[2], first.low, last.high);
  int entered = layers.first();
  while (entered < layers.last() && depth >= layers.layers()[entered].high) ++entered;
  const double transport = 1 / reduced_scattering(layers.layers()[entered].medium),
               thickness = last.high - first.low;
  const double width = std::min(2 * farthest + 20 * transport, 2 * layers.distance_to_sides(start));
  const double cell = width / cells;
  const int rows = std::clamp(static_cast<int>(thickness / cell), fewest_rows, cells);
  grid_ = {cell, thickness / rows, first.low, cells, rows};

  // light has lost its direction after a transport mean free path
  const double middle = depth + (goes_up ? transport : -transport);
  const int row = std::clamp(static_cast<int>((middle - grid_.low) / grid_.height), 0, rows - 1);

  nodes_.resize(static_cast<std::size_t>(grid_.columns) * grid_.rows * delays_.size());
  for (std::size_t delay = 0; delay < delays_.size(); ++delay) {
    std::vector<double> absorptions;
    for (const LevelLayer& layer : layers.layers()) {
      const double moved =
          decay ? 2 * delays_[delay] * decay->diffusion[static_cast<std::size_t>(layer.part)] : 0;
      absorptions.push_back(layer.medium.mu_a +
                            layer.medium.mu_s * (1 - mean_decay(layer.medium.phase, moved)));
    }
    for (const auto& field : solve(layers, targets, absorptions)) {
      const double share = field[static_cast<std::size_t>(row) * grid_.columns];
      if (delay == 0) least_share_ = std::min(least_share_, share);
      const double scale =
          1 / (std::max(share, 1e-300) * static_cast<double>(targets.size() * delays_.size()));
      for (std::size_t i = 0; i < field.size(); ++i)
        nodes_[i * delays_.size() + delay] += scale * std::max(field[i], 0.0);
    }
  }
}

/// Solves the diffusion equation for the importance of each target, by finite volumes that are
/// rings about the axis. absorptions: by layer.
std::vector<std::vector<double>> DistanceImportance::solve(
    const LevelLayers& layers, const std::vector<RingTarget>& targets,
    const std::vector<double>& absorptions) const {
  const int columns = grid_.columns, rows = grid_.rows, cells = columns * rows;
  const double w = grid_.width, h = grid_.height;
  const auto& all = layers.layers();
  std::vector<double> diffusion, absorption;
  int layer = layers.first();
  for (int row = 0; row < rows; ++row) {
    const double z = grid_.low + (row + 0.5) * h;
    while (layer < layers.last() && z > all[layer].high) ++layer;
    absorption.push_back(absorptions[layer]);
    diffusion.push_back(1 / (3 * (absorptions[layer] + reduced_scattering(all[layer].medium))));
  }
  const auto out_of = [&](int inside, int outside, double d) {
    const bool is_edge = outside < 0 || outside >= static_cast<int>(all.size());
    const double excess = all[inside].excess;
    return 1 / (h / (2 * d) + 1 / flux_through(excess, is_edge ? excess : all[outside].excess));
  };
  const double out_first = out_of(layers.first(), layers.first() - 1, diffusion.front()),
               out_last = out_of(layers.last(), layers.last() + 1, diffusion.back());

  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd sources = Eigen::MatrixXd::Zero(cells, static_cast<Eigen::Index>(targets.size()));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const int cell = row * columns + column;
      const double area = (column + 0.5) * w * w;  // divided by 2 pi, as all below
      double diagonal = absorption[row] * area * h;
      const auto link = [&](int other, double conductance) {
        diagonal += conductance;
        entries.emplace_back(cell, other, -conductance);
      };
      const auto between = [&](int other) {
        return 2 / (1 / diffusion[row] + 1 / diffusion[other]) / h * area;
      };
      if (column > 0) link(cell - 1, diffusion[row] * column * h);
      if (column + 1 < columns)
        link(cell + 1, diffusion[row] * (column + 1) * h);
      else
        diagonal += (column + 1) * w * h / 2;
      if (row > 0) link(cell - columns, between(row - 1));
      if (row + 1 < rows) link(cell + columns, between(row + 1));
      for (const bool is_last : {false, true}) {
        if (row != (is_last ? rows - 1 : 0)) continue;
        const double out = (is_last ? out_last : out_first) * area;
        diagonal += out;
        constexpr int points = 8;
        for (std::size_t t = 0; t < targets.size(); ++t)
          for (int i = 0; i < points && targets[t].is_last == is_last; ++i)
            sources(cell, static_cast<Eigen::Index>(t)) +=
                out / points * targets[t].share((column + (i + 0.5) / points) * w);
      }
      entries.emplace_back(cell, cell, diagonal);
    }
  Eigen::SparseMatrix<double> matrix(cells, cells);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
  const Eigen::MatrixXd fields = factors.solve(sources);
  std::vector<std::vector<double>> found;
  for (Eigen::Index t = 0; t < fields.cols(); ++t)
    found.emplace_back(fields.col(t).data(), fields.col(t).data() + cells);
  return found;
}

DistanceImportance::Value DistanceImportance::at(const Vec3& x, const Decays& decays) const {
  constexpr double least = 1e-12;  // keeps weights finite where there is no importance
  const double r = x.head<2>().norm();
  const double column = r / grid_.width - 0.5, row = (x[2] - grid_.low) / grid_.height - 0.5;
  const int i = std::clamp(static_cast<int>(column), 0, grid_.columns - 2),
            j = std::clamp(static_cast<int>(row), 0, grid_.rows - 2);
  const double a = std::clamp(column - i, 0.0, 1.0), b = std::clamp(row - j, -0.5, 1.5);
  const std::size_t stride = delays_.size();
  const double* const here = &nodes_[(static_cast<std::size_t>(j) * grid_.columns + i) * stride];
  const double* const above = here + static_cast<std::size_t>(grid_.columns) * stride;
  double low = 0, high = 0, low_rise = 0, high_rise = 0;
  for (std::size_t d = 0; d < stride; ++d) {
    const double f = decays[d];
    low += f * here[d];
    low_rise += f * (here[stride + d] - here[d]);
    high += f * above[d];
    high_rise += f * (above[stride + d] - above[d]);
  }
  low += a * low_rise;
  high += a * high_rise;
  const double value = std::max({low + b * (high - low), 0.25 * std::min(low, high), least});
  const double outwards = (low_rise + b * (high_rise - low_rise)) / (grid_.width * value);
  const double across = r > 0 ? outwards / r : 0;
  return {value, {across * x[0], across * x[1], (high - low) / (grid_.height * value)}};
}

}  // namespace flatspeckle::grin
