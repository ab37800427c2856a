#include "mc/paths/bent/wave_table.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::mc {

namespace {

using Four = std::array<double, 4>;

/// Of values and slopes at 0 and 1 (Hermite): v0, v1, s0, s1.
Four hermite(double t) {
  const double u = 1 - t;
  return {u * u * (1 + 2 * t), t * t * (3 - 2 * t), t * u * u, -t * t * u};
}
Four hermite_slope(double t) {
  return {-6 * t * (1 - t), 6 * t * (1 - t), (1 - t) * (1 - 3 * t), t * (3 * t - 2)};
}
/// Of values at -1, 0, 1 and 2 (cubic convolution).
Four convolution(double t) {
  const double u = 1 - t;
  return {-t * u * u / 2, (2 - 5 * t * t + 3 * t * t * t) / 2, (2 - 5 * u * u + 3 * u * u * u) / 2,
          -t * t * u / 2};
}

std::size_t cells(double extent, double spacing) {
  constexpr double least = 4, most = 400;
  return static_cast<std::size_t>(std::clamp(std::ceil(extent / spacing), least, most));
}

}  // namespace

WaveTable::WaveTable(const Domain& box, double spacing, bool spreads, const At& at,
                     const std::string& whose)
    : box_(box),
      spreads_(spreads),
      columns_(cells(box.width, spacing) + 3),
      rows_(cells(box.depth, spacing) + 3) {
  dx_ = box.width / static_cast<double>(columns_ - 3);
  dz_ = box.depth / static_cast<double>(rows_ - 3);
  origin_ = {-box.width / 2 - dx_, -dz_};
  std::vector<Node> row(columns_);
  for (std::size_t j = 0; j < rows_; ++j)
    for (std::size_t i = 0; i < columns_; ++i) {
      const Vec2 x = origin_ + Vec2{static_cast<double>(i) * dx_, static_cast<double>(j) * dz_};
      const Node* guess = j > 0 ? &row[i] : i > 0 ? &row[i - 1] : nullptr;
      const auto node = at(x, guess);
      if (!node)
        throw InputError("index_field: light of " + whose + " does not come to (" +
                         number_text(x.x) + ", " + number_text(x.z) +
                         ") by one ray: a caustic is before it; take a weaker field, a smaller "
                         "box or other ends");
      row[i] = *node;
      const auto& [w, path, amplitude, inside, launch] = node->arrival;
      const double chord = box.contains(x) ? box.distance_to_edge(x, -w) : 0;
      entries_.push_back({path, node->index * w.x, node->index * w.z, 0,
                          std::log(spreads ? amplitude * std::sqrt(path) : amplitude),
                          chord > 1e-9 * dx_ ? inside / chord : 1 / node->index, launch});
    }
  find_mixed_derivatives();
}

/// By differences of by_x along z; at the outermost rows that of the next is as good.
void WaveTable::find_mixed_derivatives() {
  for (std::size_t j = 0; j < rows_; ++j)
    for (std::size_t i = 0; i < columns_; ++i) {
      const std::size_t middle = std::clamp<std::size_t>(j, 1, rows_ - 2);
      entries_[j * columns_ + i].by_both =
          (entry(i, middle + 1).by_x - entry(i, middle - 1).by_x) / (2 * dz_);
    }
}

std::optional<Arrival> WaveTable::at(Vec2 x) const {
  const double along = (x.x - origin_.x) / dx_, deep = (x.z - origin_.z) / dz_;
  const auto cell = [](double position, std::size_t size) {
    return static_cast<std::size_t>(std::clamp(position, 1.0, static_cast<double>(size - 3)));
  };
  const std::size_t i = cell(along, columns_), j = cell(deep, rows_);
  const double s = along - static_cast<double>(i), t = deep - static_cast<double>(j);
  const Four a = hermite(s), b = hermite(t), da = hermite_slope(s), db = hermite_slope(t),
             p = convolution(s), q = convolution(t);
  Arrival found{{}, 0, 0, 0, 0};
  Vec2 v{0, 0};
  for (std::size_t m = 0; m < 2; ++m)
    for (std::size_t n = 0; n < 2; ++n) {
      const Entry& e = entry(i + m, j + n);
      const double sx = dx_ * e.by_x, sz = dz_ * e.by_z, both = dx_ * dz_ * e.by_both;
      found.path +=
          a[m] * (b[n] * e.path + b[2 + n] * sz) + a[2 + m] * (b[n] * sx + b[2 + n] * both);
      v.x += (da[m] * (b[n] * e.path + b[2 + n] * sz) + da[2 + m] * (b[n] * sx + b[2 + n] * both)) /
             dx_;
      v.z +=
          (a[m] * (db[n] * e.path + db[2 + n] * sz) + a[2 + m] * (db[n] * sx + db[2 + n] * both)) /
          dz_;
      const double share = (m == 0 ? 1 - s : s) * (n == 0 ? 1 - t : t);
      found.inside += share * e.inside_per_chord;
      found.launch += share * e.launch;
    }
  double log_amplitude = 0;
  for (std::size_t m = 0; m < 4; ++m)
    for (std::size_t n = 0; n < 4; ++n)
      log_amplitude += p[m] * q[n] * entry(i + m - 1, j + n - 1).log_amplitude;
  found.w = 1 / length(v) * v;
  found.amplitude = std::exp(log_amplitude) / (spreads_ ? std::sqrt(found.path) : 1);
  found.inside *= box_.distance_to_edge(x, -found.w);
  return found;
}

}  // namespace flatspeckle::mc
