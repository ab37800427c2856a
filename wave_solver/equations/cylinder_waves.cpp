#include "wave_solver/equations/cylinder_waves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/numbers/bessel.h"
#include "core/numbers/hankel_array.h"
#include "core/numbers/phasor.h"

namespace flatspeckle::wave {

namespace {

// Limit of |H_m|, beyond which products with the weights of modes might overflow in double
// precision.
constexpr double safe = 1e200;

// E_m and O_m of translate() for one displacement. They are stored for m = 0 .. order; those of
// negative m follow by symmetry.
template <typename Number>
struct Pair {
  std::vector<Number> cosine, sine;

  void resize(int order) {
    cosine.resize(order + 1);
    sine.resize(order + 1);
  }
  Number e(int m) const { return m >= 0 ? cosine[m] : (m % 2 == 0 ? cosine[-m] : -cosine[-m]); }
  Number o(int m) const { return m >= 0 ? sine[m] : (m % 2 == 0 ? -sine[-m] : sine[-m]); }

  Number translation(const Mode& to, const Mode& from) const {
    const int p = to.order, n = from.order;
    const Number direct = to.odd == from.odd ? e(n - p) : (to.odd ? -o(n - p) : o(n - p));
    const Number image = to.odd == from.odd ? e(n + p) : o(n + p);
    const bool minus = (p % 2 != 0) != (to.odd && from.odd);
    return minus ? direct - image : direct + image;
  }

  // Returns the derivative of an outgoing mode along the direction of angle alpha, divided by k.
  // With s the length in that direction, it follows from d/ds H_n e^{i n phi} = (k/2) [H_{n-1}
  // e^{i(n-1)phi} e^{i alpha} - H_{n+1} e^{i(n+1)phi} e^{-i alpha}].
  template <typename Real>
  Number derivative(const Mode& mode, Real cos_alpha, Real sin_alpha) const {
    const int n = mode.order;
    const Number along = mode.odd ? o(n - 1) - o(n + 1) : e(n - 1) - e(n + 1);
    const Number across = mode.odd ? e(n - 1) + e(n + 1) : -(o(n - 1) + o(n + 1));
    return (along * cos_alpha + across * sin_alpha) * Real(0.5);
  }
};

// Makes the Pair of one displacement from its radial functions (H_m or J_m) of orders m = 0, 1, ...
// turn: e^{i theta}, with theta the angle of the displacement.
template <typename Radial>
Pair<ScaledComplex> scaled_pair(const std::vector<Radial>& radial, ExtendedComplex turn) {
  Pair<ScaledComplex> pair;
  pair.resize(static_cast<int>(radial.size()) - 1);
  ExtendedComplex phase = 1;
  for (std::size_t m = 0; m < radial.size(); ++m) {
    pair.cosine[m] = phase.real() * ScaledComplex(radial[m]);
    pair.sine[m] = phase.imag() * ScaledComplex(radial[m]);
    phase = product(phase, turn);
  }
  return pair;
}

// Makes the Pair of H_m in Scaled numbers, whose range is sufficient for orders of thousands.
Pair<ScaledComplex> scaled_pair(double k, Vec d, int order) {
  const long double x = d.x, z = d.z, r = std::sqrt(x * x + z * z);
  return scaled_pair(scaled_hankel(order, static_cast<double>(k * r)), {z / r, x / r});
}

Pair<ScaledComplex> regular_pair(double k, Vec d, int order) {
  const long double x = d.x, z = d.z, r = std::sqrt(x * x + z * z);
  if (r > 0) return scaled_pair(scaled_bessel_j(order, static_cast<double>(k * r)), {z / r, x / r});
  std::vector<ScaledComplex> at_centre(order + 1);
  at_centre[0] = ScaledComplex(ExtendedComplex(1));
  return scaled_pair(at_centre, 1);
}

// Values of H_m, cos(m theta) and sin(m theta) for many displacements: [m][displacement].
class PairTable {
 public:
  PairTable(double k, std::span<const Vec> displacements, int order)
      : count_(displacements.size()) {
    const std::size_t size = (order + 1) * count_;
    for (auto* values : {&h_re_, &h_im_, &cosine_, &sine_}) values->resize(size);
    std::vector<double> r(count_), turn_re(count_), turn_im(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      const double x = displacements[i].x, z = displacements[i].z;
      const double length = std::sqrt(x * x + z * z);
      turn_re[i] = z / length;
      turn_im[i] = x / length;
      r[i] = k * length;
    }
    hankel_sets(r, order, h_re_.data(), h_im_.data());
    std::fill_n(cosine_.begin(), count_, 1.0);
    for (int m = 1; m <= order; ++m) rotate(m, turn_re, turn_im);
  }

  bool is_safe(std::size_t i, int order) const {
    return std::abs(h_im_[order * count_ + i]) < safe;
  }

  void read(std::size_t i, int order, Pair<Complex>& pair) const {
    for (int m = 0; m <= order; ++m) {
      const std::size_t at = m * count_ + i;
      pair.cosine[m] = {h_re_[at] * cosine_[at], h_im_[at] * cosine_[at]};
      pair.sine[m] = {h_re_[at] * sine_[at], h_im_[at] * sine_[at]};
    }
  }

 private:
  void rotate(int m, const std::vector<double>& turn_re, const std::vector<double>& turn_im) {
    const double *re = &cosine_[(m - 1) * count_], *im = &sine_[(m - 1) * count_];
    double *next_re = &cosine_[m * count_], *next_im = &sine_[m * count_];
    for (std::size_t i = 0; i < count_; ++i) {
      next_re[i] = re[i] * turn_re[i] - im[i] * turn_im[i];
      next_im[i] = re[i] * turn_im[i] + im[i] * turn_re[i];
    }
  }

  std::size_t count_;
  std::vector<double> h_re_, h_im_, cosine_, sine_;
};

// A displacement and the largest order required for it.
struct Displacement {
  Vec d;
  int order = 0;
};

bool is_zero(Vec d) {
  return d.x == 0 && d.z == 0;
}

// Calls element(pair, i) for all displacements, a chunk at a time. For a zero displacement both
// functions of the pair are 0.
template <typename Element>
void for_each_pair(double k, const std::vector<Displacement>& displacements,
                   const Element& element) {
  int order = 0;
  for (const auto& displacement : displacements) order = std::max(order, displacement.order);
  const std::size_t chunk = std::max<std::size_t>(8, 2048 / (order + 1));
  Pair<Complex> pair, nothing;
  pair.resize(order);
  nothing.resize(order);
  std::vector<Vec> part;
  for (std::size_t first = 0; first < displacements.size(); first += chunk) {
    const std::size_t last = std::min(first + chunk, displacements.size());
    part.clear();
    for (std::size_t i = first; i < last; ++i)
      part.push_back(is_zero(displacements[i].d) ? Vec{1 / k, 0} : displacements[i].d);
    const PairTable table(k, part, order);
    for (std::size_t i = first; i < last; ++i) {
      if (is_zero(displacements[i].d)) {
        element(nothing, i);
      } else if (table.is_safe(i - first, displacements[i].order)) {
        table.read(i - first, displacements[i].order, pair);
        element(pair, i);
      } else {
        element(scaled_pair(k, displacements[i].d, displacements[i].order), i);
      }
    }
  }
}

// Multiplies by the weights one after the other, because their product may underflow if the wave is
// large.
Complex weighted(Complex wave, const ScaledReal& to, const ScaledReal& from) {
  return wave * static_cast<double>(to) * static_cast<double>(from);
}
Complex weighted(const ScaledComplex& wave, const ScaledReal& to, const ScaledReal& from) {
  const auto result = static_cast<Complex>(wave * to * from);
  if (!std::isfinite(result.real()) || !std::isfinite(result.imag()))
    throw InputError(
        "two scatterers are so close at this wavelength that the translation of their waves "
        "overflows; widen the gap (min_gap)");
  return result;
}

void translate_points(double k, std::span<const ModeSet> receivers, const ModeSet& sender,
                      Target out) {
  std::vector<double> r(receivers.size());
  for (std::size_t i = 0; i < r.size(); ++i) {
    const Vec d = receivers[i].centre - sender.centre;
    r[i] = is_zero(d) ? 1 : k * std::sqrt(dot(d, d));
  }
  hankel0(r, {out.data, r.size()});
  const auto from = 2 * static_cast<double>(sender.modes[0].weight);
  for (std::size_t i = 0; i < r.size(); ++i) {
    const bool apart = !is_zero(receivers[i].centre - sender.centre);
    out.data[i] *= apart ? from * static_cast<double>(receivers[i].modes[0].weight) : 0;
  }
}

bool is_point(const ModeSet& set) {
  return set.order == 0 && set.modes.size() == 1;
}

}  // namespace

void translate(double k, std::span<const ModeSet> receivers, const ModeSet& sender, Target out) {
  if (is_point(sender) && std::all_of(receivers.begin(), receivers.end(), is_point))
    return translate_points(k, receivers, sender, out);
  std::vector<Displacement> displacements;
  std::vector<std::size_t> first_row{0};
  for (const ModeSet& receiver : receivers) {
    displacements.push_back({receiver.centre - sender.centre, receiver.order + sender.order});
    first_row.push_back(first_row.back() + receiver.modes.size());
  }
  for_each_pair(k, displacements, [&](const auto& pair, std::size_t i) {
    for (std::size_t column = 0; column < sender.modes.size(); ++column) {
      Complex* to = out.data + out.ld * column + first_row[i];
      const Mode& from = sender.modes[column];
      for (const Mode& mode : receivers[i].modes)
        *to++ = weighted(pair.translation(mode, from), mode.weight, from.weight);
    }
  });
}

void translate_regular(double k, std::span<const ModeSet> receivers, const ModeSet& sender,
                       Target out) {
  std::size_t row = 0;
  for (const ModeSet& receiver : receivers) {
    const auto pair =
        regular_pair(k, receiver.centre - sender.centre, receiver.order + sender.order);
    for (const Mode& to : receiver.modes) {
      for (std::size_t column = 0; column < sender.modes.size(); ++column) {
        const Mode& from = sender.modes[column];
        out.data[row + out.ld * column] =
            weighted(pair.translation(to, from), to.weight, from.weight);
      }
      ++row;
    }
  }
}

void expand_plane_wave(double k, std::span<const ModeSet> receivers, const WaveDirection& w,
                       Complex factor, std::span<Complex> out) {
  int highest = 0;
  std::vector<double> phases, logs;
  phases.reserve(receivers.size());
  logs.reserve(receivers.size());
  for (const ModeSet& receiver : receivers) {
    highest = std::max(highest, receiver.order);
    const Vec r = receiver.centre;
    phases.push_back(k * (w.x.real() * r.x + w.z.real() * r.z));
    logs.push_back(-k * (w.x.imag() * r.x + w.z.imag() * r.z));
  }
  std::vector<Complex> cosines, sines;  // cos(n angle) and sin(n angle), times i^n
  constexpr ExtendedComplex i(0, 1);
  const ExtendedComplex x(w.x), z(w.z), turn = z + product(i, x), back = z - product(i, x);
  ExtendedComplex forth_power = 1, back_power = 1;  // (i turn)^n and (i back)^n
  for (int n = 0; n <= highest; ++n) {
    cosines.push_back(Complex((forth_power + back_power) * 0.5L));
    sines.push_back(Complex(product(forth_power - back_power, -0.5L * i)));
    forth_power = product(forth_power, product(i, turn));
    back_power = product(back_power, product(i, back));
  }
  std::vector<Complex> waves(phases.size());
  damped_phasors(phases, logs, waves);
  std::size_t row = 0;
  for (std::size_t j = 0; j < receivers.size(); ++j) {
    const Complex there = product(waves[j], std::numbers::sqrt2 * factor);
    for (const Mode& mode : receivers[j].modes) {
      const Complex turned = mode.odd ? sines[mode.order] : cosines[mode.order];
      out[row++] = product(turned, there) * static_cast<double>(mode.weight);
    }
  }
}

// Treats the points as receivers: the field at a point is the coefficient of J_0 about that point.
void field_at(double k, std::span<const Vec> points, const ModeSet& sender, Target out) {
  const Mode value{0, false, root_half};
  std::vector<ModeSet> receivers;
  for (const Vec& point : points) receivers.push_back({point, {&value, 1}, 0});
  translate(k, receivers, sender, out);
}

void directional_derivatives(double k, std::span<const Vec> points, std::span<const Vec> along,
                             const ModeSet& sender, Target out) {
  std::vector<Displacement> displacements;
  for (const Vec& point : points)
    displacements.push_back({point - sender.centre, sender.order + 1});
  for_each_pair(k, displacements, [&](const auto& pair, std::size_t i) {
    for (std::size_t column = 0; column < sender.modes.size(); ++column) {
      const Mode& mode = sender.modes[column];
      using Real = typename std::decay_t<decltype(pair.e(0))>::value_type;
      const auto derivative = pair.derivative(mode, Real(along[i].z), Real(along[i].x));
      out.data[out.ld * column + i] = weighted(derivative, 2 * root_half, mode.weight);
    }
  });
}

}  // namespace flatspeckle::wave
