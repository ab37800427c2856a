// Index fields and index jumps where they are faint, steep, far from the centre or on an axis.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/oracles/multiprecision.h"
#include "bench/stability/extreme_rows.h"
#include "grin/media/fields/fisheye.h"
#include "grin/media/fields/luneburg.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/sech.h"
#include "grin/media/fields/tanh_ramp.h"
#include "grin/media/fields/ultrasound.h"
#include "grin/rays/surfaces/interface.h"
#include "grin/trace/trace_scene.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;
using namespace oracles;
using std::numbers::pi;

/// Compares n = n0 / (1 + r^2), to an absolute accuracy of 1e-16, and its gradient -2 r n / (1 +
/// r^2), to full relative accuracy.
Finding fisheye_far_out(double r) {
  const Fisheye eye(FisheyeProfile{1, 1});
  const double n = 2 / (1 + r * r), derivative = -2 * r * n / (1 + r * r);
  const double value_error = std::abs(index(eye, Vec3(r, 0, 0)) - n);
  const double derivative_error = std::abs(eye.gradient({r, 0, 0}).gradient[0] / derivative - 1);
  return {larger(value_error, derivative_error), 1e-14};
}

/// Compares n - 1 = sqrt(2 - r^2) - 1 inside and 0 outside, and the gradient -r / n, which jumps by
/// 1 at the rim.
Finding luneburg_rim() {
  const Luneburg lens(LuneburgProfile{});
  double worst = 0;
  for (const double below : {1e-3, 1e-9, 1e-15, 0.0}) {
    const long double r = 1 - static_cast<long double>(below), n = std::sqrt(2 - r * r);
    const auto at = lens.gradient({1 - below, 0, 0});
    const double r_double = 1 - below;
    const long double exact = (1 - static_cast<long double>(r_double) * r_double) / (1 + n);
    worst = larger({worst, static_cast<double>(std::abs(at.excess - exact)),
                    static_cast<double>(std::abs(at.gradient[0] + r / n))});
  }
  const auto outside = lens.gradient({1 + 1e-8, 0, 0});
  return {worst + std::abs(outside.excess) + outside.gradient.norm(), 1e-15};
}

/// Checks the relative error of n - 1 = 1e-6.
Finding faint_guide() {
  const double excess = 1e-6, alpha = 1e-3;
  const ParabolicGuide guide({excess, alpha});
  return worst_of({0.0, 1e-9, 0.5, 1.0, 1.41}, 1e-15, [&](double rho) {
    const Wide n0 = 1 + Wide(excess), square = n0 * n0 - Wide(alpha) * alpha * rho * rho;
    const Wide exact = sqrt(square) - 1;
    const double derivative = static_cast<double>(-Wide(alpha) * alpha * rho / sqrt(square));
    const auto at = guide.gradient({0, rho, 3});
    return larger({static_cast<double>(abs(Wide(at.excess) - exact)) / excess,
                   std::abs(at.gradient[1] - derivative) / (alpha * alpha)});
  });
}

/// Checks n = n0 sech(alpha rho) far from the axis: it must not be negative, and not NaN as long as
/// cosh is finite.
Finding sech_far_out() {
  const SechGuide guide({0.5, 1});
  double wrong = 0;
  for (const double rho : {30.0, 300.0, 700.0}) {
    const auto at = guide.gradient({rho, 0, 0});
    const double n = 1 + at.excess;
    if (!(n >= 0 && n < 1e-12 && at.gradient[0] <= 0 && at.gradient[0] >= -1e-12)) ++wrong;
  }
  return {wrong, 0};
}

/// Checks that the gradient is (high - low) / (2 width) in the middle of the ramp and 0 beyond some
/// tens of widths.
Finding steep_ramp(double width) {
  const TanhRamp ramp{0.1, 0.6, width};
  const auto middle = ramp.gradient(Vec3::Zero()), above = ramp.gradient({0, 0, 30 * width}),
             below = ramp.gradient({0, 0, -1e9 * width});
  return {
      larger({std::abs(middle.gradient[2] * width / 0.25 - 1), std::abs(middle.excess - 0.35),
              std::abs(above.excess - 0.6), std::abs(below.excess - 0.1), below.gradient.norm()}),
      1e-15};
}

/// Checks J_m(kr rho) cos(m phi) near the axis: 1, x kr/2 and (x^2 - y^2) kr^2/8 for m = 0, 1 and
/// 2, and 0 for larger m.
Finding sound_on_axis(int m, double off) {
  const double kr = 7, amplitude = 0.02;
  const StandingWave wave(0.33, amplitude, m, kr, 2);
  const IndexHessian at = wave.hessian({off, 0, 0.3});
  Vec3 gradient = Vec3::Zero();
  Mat3 hessian = Mat3::Zero();
  if (m == 0) hessian.diagonal() = Vec3(-1, -1, 0) / 2;
  if (m == 1) gradient = Vec3(0.5, 0, 0);
  if (m == 2) hessian.diagonal() = Vec3(1, -1, 0) / 4;
  return {larger({std::abs(at.excess - 0.33 - (m == 0 ? amplitude : 0)) / amplitude,
                  (at.gradient / (amplitude * kr) - gradient).norm(),
                  (at.hessian / (amplitude * kr * kr) - hessian).norm()}),
          1e-12};
}

/// Compares J_m(x) cos(m phi) with 50 digits, relative to the envelope sqrt(2 / (pi x)).
Finding sound_far_out(int m, double x) {
  const double kr = 7, rho = x / kr, phi = 0.3;
  const StandingWave wave(0, 1, m, kr, 100);
  const Vec3 place(rho * std::cos(phi), rho * std::sin(phi), 0);
  const double there = kr * std::hypot(place[0], place[1]), angle = std::atan2(place[1], place[0]);
  const double exact = static_cast<double>(bessel_oracle(m, there).j) * std::cos(m * angle);
  return {std::abs(wave.excess(place) - exact) / std::sqrt(2 / (pi * x)), 1e-15 * x + 1e-12};
}

/// Compares the reflectance, averaged over both polarizations, with Fresnel's formulas in 50
/// digits.
Finding reflectance(double excess_from, double excess_to, double cosine, double limit) {
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  const Vec3 v = (1 + excess_from) * Vec3(sine, 0, cosine);
  const Interface face(v, Vec3::UnitZ(), excess_from, excess_to);
  const Wide n1 = 1 + Wide(excess_from), n2 = 1 + Wide(excess_to), q1(v[2]);
  const Wide square = q1 * q1 + n2 * n2 - n1 * n1;
  if (square <= 0) return {face.is_total() ? std::abs(face.reflectance() - 1) : 1, limit};
  if (face.is_total()) return {1, limit};
  const Wide q2 = sqrt(square), s = (q1 - q2) / (q1 + q2),
             p = (n2 * n2 * q1 - n1 * n1 * q2) / (n2 * n2 * q1 + n1 * n1 * q2);
  const Wide exact = (s * s + p * p) / 2;
  return {static_cast<double>(abs(Wide(face.reflectance()) / exact - 1)), limit};
}

/// Checks that |v| = n beyond an index jump, and that the tangential component of v is conserved.
Finding snell() {
  double worst = 0;
  for (const double cosine : {1.0, 1e-3, 1e-9}) {
    const Vec3 v(std::sqrt(1 - cosine * cosine), 0, cosine);
    for (const double jump : {1e-9, 0.5}) {
      const Vec3 beyond = *Interface(v, -Vec3::UnitZ(), 0, jump).refracted();
      worst = larger({worst, std::abs(beyond.norm() / (1 + jump) - 1), std::abs(beyond[0] - v[0])});
    }
  }
  return {worst, 1e-15};
}

void add_fields(ExtremeRows& rows) {
  rows.add("Luneburg rim from inside and outside", "n - 1 and grad n", luneburg_rim);
  rows.add_each("fisheye ", {1e3, 1e6}, " radii out, n to 1e-12", "n and grad n", fisheye_far_out);
  rows.add("guide of n - 1 = 1e-6", "n - 1 and grad n in 50 digits", faint_guide);
  rows.add("sech guide, alpha rho to 700, n to 1e-304", "0 <= n, bounds", sech_far_out);
  rows.add_each("ramp of width ", {1e-9, 1e-100}, "", "slope, ends", steep_ramp);
}

void add_sound(ExtremeRows& rows) {
  for (const int m : {0, 1, 2, 64})
    rows.add("ultrasound of order " + std::to_string(m) + ", on the axis",
             "value, slope, curvature",
             [=] { return worse(sound_on_axis(m, 0), sound_on_axis(m, 1e-160)); });
  for (const auto& [m, x] : {std::pair(0, 300.0), {64, 60.0}, {0, 1e6}, {64, 3e4}})
    rows.add("ultrasound of order " + std::to_string(m) + " at kr rho = " + short_number(x),
             "J_m in 50 digits", sound_far_out, m, x);
  rows.add_refused("ultrasound of order 65", "must be from 0 to 64", [] {
    grin::TraceValues values;
    values.field.of<grin::UltrasoundValues>().sound_order = 65;
    make_trace_scene(values);
  });
}

void add_jumps(ExtremeRows& rows) {
  const std::string digits = "Fresnel in 50 digits";
  rows.add("jump of 1e-12, normal incidence: 2.5e-25 reflected", digits, reflectance, 0, 1e-12, 1,
           1e-14);
  // the cosine of pi/2 is 6e-17 in double precision
  rows.add("jump of 0.5, at exactly pi/2", digits, reflectance, 0, 0.5, std::cos(pi / 2), 1e-14);
  // q2, the normal component beyond the jump, has q2^2 = 1.5e-12. This difference of numbers of
  // about 1 is accurate to 1e-4, and 1 - R = 4 q2 / q1
  const double critical = std::sqrt(1 - 1 / 2.25);
  rows.add("jump of -0.5, cosine 1e-12 below the critical angle", digits, reflectance, 0.5, 0,
           critical + 1e-12, 1e-9);
  rows.add("jump of -0.5, cosine 1e-12 beyond the critical angle", digits, reflectance, 0.5, 0,
           critical - 1e-12, 0);
  rows.add("jumps of 1e-9 and 0.5, cosines 1 to 1e-9", "|v| = n, tangential part", snell);
}

}  // namespace

void index_extremes(ExtremeRows& rows) {
  add_fields(rows);
  add_sound(rows);
  add_jumps(rows);
}

}  // namespace flatspeckle::bench
