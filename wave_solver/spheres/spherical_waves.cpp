#include "wave_solver/spheres/spherical_waves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include "core/error.h"
#include "core/numbers/phasor.h"
#include "core/numbers/wide/every_width.h"
#include "core/numbers/wide/functions.h"
#include "wave_solver/spheres/sphere_translations.h"

namespace flatspeckle::wave {

namespace {

constexpr std::size_t lanes = 8;        // displacements that are processed at once
constexpr double largest_wave = 1e200;  // limit of |h_L|, as in cylinder_waves.cpp

template <typename Real>
using Lane = std::array<Real, lanes>;

inline void sine_cosine(double x, double& sine, double& cosine) {
  const auto [s, c] = wide_sine_cosine(x);
  sine = s;
  cosine = c;
}
inline void sine_cosine(long double x, long double& sine, long double& cosine) {
  sine = std::sin(x);
  cosine = std::cos(x);
}

// Values of h_L(k d) R_LM(d / |d|) for a few displacements d: [harmonic][lane].
template <typename Real>
struct LaneWaves {
  std::vector<Lane<Real>> re, im, h_re, h_im;

  void resize(int order) {
    re.resize(harmonics_up_to(order));
    im.resize(harmonics_up_to(order));
    h_re.resize(order + 2);
    h_im.resize(order + 2);
  }
};

// Computes h_L by upward recurrence from h_0 = -i e^{ix} / x and h_1 = -e^{ix} (x + i) / x^2.
template <typename Real>
inline void hankel_lanes(const Lane<Real>& x, int order, LaneWaves<Real>& waves) {
  auto &re = waves.h_re, &im = waves.h_im;
  for (std::size_t i = 0; i < lanes; ++i) {
    Real sine, cosine;
    sine_cosine(x[i], sine, cosine);
    const Real inverse = 1 / x[i];
    re[0][i] = sine * inverse;
    im[0][i] = -cosine * inverse;
    re[1][i] = (sine * inverse - cosine) * inverse;
    im[1][i] = -(cosine * inverse + sine) * inverse;
  }
  for (int l = 1; l < order; ++l)
    for (std::size_t i = 0; i < lanes; ++i) {
      const Real rise = static_cast<Real>(2 * l + 1) / x[i];
      re[l + 1][i] = rise * re[l][i] - re[l - 1][i];
      im[l + 1][i] = rise * im[l][i] - im[l - 1][i];
    }
}

template <typename Real>
inline void fill_lanes(double k, const Lane<Vec>& d, int order, const Harmonics& harmonics,
                       LaneWaves<Real>& waves) {
  Lane<Real> x, u, v, w, cosine, sine;
  for (std::size_t i = 0; i < lanes; ++i) {
    const Real a = d[i].x, b = d[i].y, c = d[i].z, r = std::sqrt(a * a + b * b + c * c);
    u[i] = a / r;
    v[i] = b / r;
    w[i] = c / r;
    x[i] = static_cast<Real>(k) * r;
    cosine[i] = 1;
    sine[i] = 0;
  }
  hankel_lanes(x, order, waves);
  for (int m = 0; m <= order; ++m) {
    Lane<Real> before{}, here;
    here.fill(static_cast<Real>(harmonics.diagonal(m)));
    for (int l = m; l <= order; ++l) {
      if (l > m) {
        const auto rise = static_cast<Real>(harmonics.rise(l, m)),
                   fall = static_cast<Real>(harmonics.fall(l, m));
        for (std::size_t i = 0; i < lanes; ++i) {
          const Real next = rise * (w[i] * here[i] - fall * before[i]);
          before[i] = here[i];
          here[i] = next;
        }
      }
      const std::size_t even = harmonic_index(l, m);
      for (std::size_t i = 0; i < lanes; ++i) {
        const Real part = here[i] * cosine[i];
        waves.re[even][i] = part * waves.h_re[l][i];
        waves.im[even][i] = part * waves.h_im[l][i];
      }
      if (m == 0) continue;
      for (std::size_t i = 0; i < lanes; ++i) {
        const Real part = here[i] * sine[i];
        waves.re[even + 1][i] = part * waves.h_re[l][i];
        waves.im[even + 1][i] = part * waves.h_im[l][i];
      }
    }
    for (std::size_t i = 0; i < lanes; ++i) {
      const Real turned = cosine[i] * u[i] - sine[i] * v[i];
      sine[i] = cosine[i] * v[i] + sine[i] * u[i];
      cosine[i] = turned;
    }
  }
}

// Sums over L of the waves with cos(M phi) and sin(M phi), for one M.
template <typename Real>
struct LaneSum {
  Lane<Real> cos_re{}, cos_im{}, sin_re{}, sin_im{};

  inline void add(const SphereTranslations::Sum& sum, int m, const LaneWaves<Real>& waves) {
    for (int j = 0; j < sum.count; ++j) {
      const std::size_t even = harmonic_index(sum.first + 2 * j, m);
      const auto factor = static_cast<Real>(sum.values[j]);
      for (std::size_t i = 0; i < lanes; ++i) {
        cos_re[i] += factor * waves.re[even][i];
        cos_im[i] += factor * waves.im[even][i];
      }
      if (m == 0) continue;
      for (std::size_t i = 0; i < lanes; ++i) {
        sin_re[i] += factor * waves.re[even + 1][i];
        sin_im[i] += factor * waves.im[even + 1][i];
      }
    }
  }
};

// Receivers of equal order, a chunk of which is processed at once, and their first rows.
struct Chunk {
  Lane<const SphereSet*> set;
  Lane<std::size_t> row;
  Lane<bool> apart;  // whether the receiver is not at the position of the sender
  Lane<Vec> displacement;
  std::size_t count = 0;
};

// Writes one element of the translation to all receivers of the chunk.
template <typename Real>
inline void write(const Chunk& chunk, int l, std::size_t row, std::size_t column, Real weight,
                  const Lane<Real>& re, const Lane<Real>& im, Target out) {
  for (std::size_t i = 0; i < chunk.count; ++i) {
    const Real own = weight * static_cast<Real>(chunk.set[i]->weight[l]);
    out.data[chunk.row[i] + row + out.ld * column] =
        chunk.apart[i] ? Complex(static_cast<double>(re[i] * own), static_cast<double>(im[i] * own))
                       : Complex();
  }
}

// Writes the elements between the waves (l, m) of the receivers and (other_l, other_m) of the
// sender. From cos a cos b = (cos(a - b) + cos(a + b)) / 2 and the like.
template <typename Real>
inline void write_orders(const Chunk& chunk, const SphereTranslations& table, int l, int m,
                         int other_l, int other_m, const LaneWaves<Real>& waves, Real weight,
                         Target out) {
  LaneSum<Real> minus, plus;
  minus.add(table.factors(l, m, other_l, other_m, false), std::abs(m - other_m), waves);
  plus.add(table.factors(l, m, other_l, other_m, true), m + other_m, waves);
  const Real sign = m < other_m ? -1 : 1;
  const auto put = [&](bool odd, bool other_odd, const Lane<Real>& a_re, const Lane<Real>& a_im,
                       Real factor, const Lane<Real>& b_re, const Lane<Real>& b_im) {
    Lane<Real> re, im;
    for (std::size_t i = 0; i < lanes; ++i) {
      re[i] = a_re[i] + factor * b_re[i];
      im[i] = a_im[i] + factor * b_im[i];
    }
    write(chunk, l, harmonic_index(l, m, odd), harmonic_index(other_l, other_m, other_odd), weight,
          re, im, out);
  };
  put(false, false, minus.cos_re, minus.cos_im, 1, plus.cos_re, plus.cos_im);
  if (m > 0) put(true, false, plus.sin_re, plus.sin_im, sign, minus.sin_re, minus.sin_im);
  if (other_m > 0) put(false, true, plus.sin_re, plus.sin_im, -sign, minus.sin_re, minus.sin_im);
  if (m > 0 && other_m > 0)
    put(true, true, minus.cos_re, minus.cos_im, -1, plus.cos_re, plus.cos_im);
}

template <typename Real>
inline void write_chunk(const Chunk& chunk, const SphereTranslations& table,
                        const SphereSet& sender, const LaneWaves<Real>& waves, Target out) {
  for (int other_l = 0; other_l <= sender.order; ++other_l)
    for (int other_m = 0; other_m <= other_l; ++other_m)
      for (int l = 0; l <= chunk.set[0]->order; ++l)
        for (int m = 0; m <= l; ++m)
          write_orders(chunk, table, l, m, other_l, other_m, waves,
                       static_cast<Real>(sender.weight[other_l]), out);
}

// Returns whether h_L is within the safe range, so that the elements are written.
FLATSPECKLE_EVERY_WIDTH bool translate_chunk(double k, const Chunk& chunk,
                                             const SphereTranslations& table,
                                             const SphereSet& sender, LaneWaves<double>& waves,
                                             Target out) {
  const int order = chunk.set[0]->order + sender.order;
  fill_lanes(k, chunk.displacement, order, table.harmonics(), waves);
  for (std::size_t i = 0; i < lanes; ++i)
    if (!(std::abs(waves.h_im[order][i]) < largest_wave)) return false;
  write_chunk(chunk, table, sender, waves, out);
  return true;
}

void translate_exactly(double k, const Chunk& chunk, const SphereTranslations& table,
                       const SphereSet& sender, Target out) {
  const int order = chunk.set[0]->order + sender.order;
  LaneWaves<long double> waves;
  waves.resize(order);
  fill_lanes(k, chunk.displacement, order, table.harmonics(), waves);
  write_chunk(chunk, table, sender, waves, out);
}

FLATSPECKLE_EVERY_WIDTH void fill_doubles(double k, const Lane<Vec>& d, int order,
                                          const Harmonics& harmonics, LaneWaves<double>& waves) {
  fill_lanes(k, d, order, harmonics, waves);
}

bool is_origin(Vec d) {
  return d.x == 0 && d.y == 0 && d.z == 0;
}

// Copies a wave at each point of a chunk to the columns of the target.
template <typename Real>
void write_field(const LaneWaves<Real>& waves, const SphereSet& sender, std::size_t first,
                 std::size_t count, Target out) {
  std::size_t column = 0;
  for (int l = 0; l <= sender.order; ++l)
    for (int m = -l; m <= l; ++m, ++column) {
      const auto weight = static_cast<Real>(sender.weight[l]);
      for (std::size_t i = 0; i < count; ++i)
        out.data[first + i + out.ld * column] = {static_cast<double>(waves.re[column][i] * weight),
                                                 static_cast<double>(waves.im[column][i] * weight)};
    }
}

}  // namespace

void translate(double k, std::span<const SphereSet> receivers, const SphereSet& sender,
               Target out) {
  int highest = sender.order;
  std::vector<std::size_t> row{0}, by_order(receivers.size());
  for (const SphereSet& receiver : receivers) {
    highest = std::max(highest, receiver.order);
    row.push_back(row.back() + harmonics_up_to(receiver.order));
  }
  std::iota(by_order.begin(), by_order.end(), std::size_t{0});
  std::ranges::stable_sort(by_order, {}, [&](std::size_t i) { return receivers[i].order; });
  const auto table = sphere_translations(highest);
  LaneWaves<double> waves;
  waves.resize(2 * highest);
  for (std::size_t next = 0; next < by_order.size();) {
    Chunk chunk;
    const int order = receivers[by_order[next]].order;
    for (; chunk.count < lanes && next < by_order.size(); ++next, ++chunk.count) {
      const SphereSet& receiver = receivers[by_order[next]];
      if (receiver.order != order) break;
      const Vec d = receiver.centre - sender.centre;
      chunk.set[chunk.count] = &receiver;
      chunk.row[chunk.count] = row[by_order[next]];
      chunk.apart[chunk.count] = !is_origin(d);
      chunk.displacement[chunk.count] = is_origin(d) ? Vec{1 / k, 0} : d;
    }
    for (std::size_t i = chunk.count; i < lanes; ++i) chunk.displacement[i] = chunk.displacement[0];
    if (!translate_chunk(k, chunk, *table, sender, waves, out))
      translate_exactly(k, chunk, *table, sender, out);
  }
}

void field_at(double k, std::span<const Vec> points, const SphereSet& sender, Target out) {
  const auto table = sphere_translations(sender.order);
  LaneWaves<double> waves;
  waves.resize(sender.order);
  for (std::size_t first = 0; first < points.size(); first += lanes) {
    const std::size_t count = std::min(lanes, points.size() - first);
    Lane<Vec> d;
    for (std::size_t i = 0; i < lanes; ++i)
      d[i] = points[first + std::min(i, count - 1)] - sender.centre;
    fill_doubles(k, d, sender.order, table->harmonics(), waves);
    const auto& top = waves.h_im[sender.order];
    if (std::ranges::all_of(top, [](double h) { return std::abs(h) < largest_wave; })) {
      write_field(waves, sender, first, count, out);
      continue;
    }
    LaneWaves<long double> wide;
    wide.resize(sender.order);
    fill_lanes(k, d, sender.order, table->harmonics(), wide);
    write_field(wide, sender, first, count, out);
  }
}

void add_plane_wave(double k, std::span<const SphereSet> receivers, Vec w, Complex factor,
                    std::span<Complex> out) {
  int highest = 0;
  std::vector<double> phases;
  phases.reserve(receivers.size());
  for (const SphereSet& receiver : receivers) {
    highest = std::max(highest, receiver.order);
    phases.push_back(k * dot(w, receiver.centre));
  }
  const auto harmonics = sphere_translations(highest)->harmonics().at(w);
  std::vector<Complex> waves(phases.size());
  damped_phasors(phases, std::vector<double>(phases.size()), waves);
  constexpr Complex power[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  std::size_t at = 0;
  for (std::size_t j = 0; j < receivers.size(); ++j) {
    const Complex there = product(waves[j], 4 * std::numbers::pi * factor);
    for (int l = 0; l <= receivers[j].order; ++l) {
      const Complex own =
          product(there, power[l % 4]) * static_cast<double>(receivers[j].weight[l]);
      for (std::size_t i = harmonic_index(l, 0); i < harmonics_up_to(l); ++i)
        out[at++] += own * harmonics[i];
    }
  }
}

void PointArrays::add(Vec point) {
  x.push_back(point.x);
  y.push_back(point.y);
  z.push_back(point.z);
}

FLATSPECKLE_EVERY_WIDTH void point_waves(double k, const PointArrays& points, std::size_t begin,
                                         Vec centre, std::span<double> re, std::span<double> im) {
  const double *x = &points.x[begin], *y = &points.y[begin], *z = &points.z[begin];
  double *out_re = re.data(), *out_im = im.data();
  const std::size_t count = re.size();
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) {
    const double a = x[i] - centre.x, b = y[i] - centre.y, c = z[i] - centre.z,
                 size = k * std::sqrt(a * a + b * b + c * c);
    const auto [sine, cosine] = wide_sine_cosine(size);
    const double inverse = size > 0 ? 1 / size : 0;
    out_re[i] = sine * inverse;
    out_im[i] = -cosine * inverse;
  }
}

}  // namespace flatspeckle::wave
