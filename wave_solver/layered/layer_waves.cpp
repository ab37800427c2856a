#include "wave_solver/layered/layer_waves.h"

#include <cmath>
#include <numbers>

namespace flatspeckle::wave {

namespace {

/// Returns sqrt(k^2 - p^2) with Im >= 0.
Complex along_z(double k, Complex p) {
  const Complex root = std::sqrt(Complex(k * k) - p * p);
  return root.imag() < 0 ? -root : root;
}

}  // namespace

LayerWaves::LayerWaves(const Faces& faces, double k, double depth)
    : k_(k),
      outside_k_(k * (faces.outside / faces.inside)),
      depth_(depth),
      derivative_ratio_(
          faces.polarisation == Polarisation::te ? std::pow(faces.inside / faces.outside, 2) : 1) {}

Complex LayerWaves::inside(Complex p) const {
  return along_z(k_, p);
}
Complex LayerWaves::outside(Complex p) const {
  return along_z(outside_k_, p);
}
Complex LayerWaves::reflected(Complex p) const {
  const Complex within = inside(p), beyond = derivative_ratio_ * outside(p);
  return (within - beyond) / (within + beyond);
}

Complex LayerWaves::illuminated(double angle, Vec point) const {
  const double p = outside_k_ * std::sin(angle), normal = outside_k_ * std::abs(std::cos(angle));
  const bool downwards = std::cos(angle) > 0;
  // The field is an even function of the wavenumber along z, so that a small one replaces 0.
  Complex within = inside(p);
  if (std::abs(within) < 1e-7 * k_) within = 1e-7 * k_;
  const double beyond = derivative_ratio_ * normal,
               from_face = downwards ? point.z : depth_ - point.z;
  const Complex near = propagated(within, from_face), far = propagated(within, depth_ - from_face),
                across = propagated(within, depth_);
  const Complex even = (near + far) / (beyond * (1.0 + across) + within * (1.0 - across)),
                odd = (near - far) / (within * (1.0 + across) + beyond * (1.0 - across));
  const double face_phase = p * point.x - (downwards ? 0 : normal * depth_);
  return beyond * (even + odd) * std::polar(1.0, face_phase);
}

Complex LayerWaves::emitted(double angle, Vec point) const {
  const Complex reversed = illuminated(angle + std::numbers::pi, point) / derivative_ratio_;
  return std::sqrt(2 / (std::numbers::pi * outside_k_)) * std::polar(1.0, -std::numbers::pi / 4) *
         reversed;
}

}  // namespace flatspeckle::wave
