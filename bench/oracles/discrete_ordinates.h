#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace flatspeckle::oracles {

/// Solves transport of intensity through an infinite slab or a stack of layers deterministically,
/// for any phase function:
///   cos(theta) dI/dtau = -I + albedo int p(theta - theta') I(theta') dtheta'
/// on discrete ordinates over the circle, by adding and doubling from a layer so thin that it
/// scatters only once (van de Hulst [hulst1980], ch. 4). Illumination and detection directions are
/// ordinates of weight 0, so that nothing is interpolated. The nodes are Gauss-Legendre in
/// sqrt(pi/2 - theta): near the faces radiance has a logarithmic singularity at grazing angles. The
/// matrix of the phase function is scaled to conserve power.
class SlabTransport {
 public:
  struct Medium {
    double optical_depth, albedo;
    std::function<double(double)> phase;  ///< p(angle), even, integral 1 over 2 pi (C5)
  };
  /// angles: all illumination and detection directions that will be requested (C2), none of them
  /// parallel to the slab. `nodes` per quadrant: 50 give 1e-5 up to g = 0.8; forward peaks of width
  /// 1 - g require 6 / (1 - g).
  SlabTransport(const Medium& medium, const std::vector<double>& angles, int nodes)
      : SlabTransport(std::vector{medium}, angles, nodes) {}
  /// A stack of layers, from z = 0 on.
  SlabTransport(const std::vector<Medium>& layers, const std::vector<double>& angles, int nodes);

  /// Fractions of the power incident at an angle, |light| < pi/2. The transmittance excludes
  /// unscattered light.
  double reflectance(double light) const;
  double transmittance(double light) const;
  double direct_transmittance(double light) const;

  /// C_vv of C14 and C18 without reversed paths, per unit illuminated length: the power that leaves
  /// along `view`, per radian, for a plane wave of unit intensity.
  double covariance_without_reversed(double light, double view) const;

 private:
  /// Diffuse radiance per unit incident radiance, [out][in]. Angles are in the first quadrant; they
  /// are measured from the z axis, for reflected light from -z.
  struct Layer {
    std::vector<double> reflected, transmitted;
  };
  /// Response to light incident from above and from below.
  struct Stack {
    double optical_depth;
    Layer above, below;
  };
  void add_node(double angle, double complement, double weight);
  void scale_phase();
  double phase_element(std::size_t i, std::size_t j, bool backward, int parity) const;
  Layer thin_layer(double optical_depth, int parity) const;
  Layer doubled(const Layer& half, double optical_depth) const;
  Layer slab(int parity) const;
  std::vector<double> direct(double optical_depth) const;
  Stack added(const Stack& upper, const Stack& lower) const;
  std::optional<std::size_t> find(double angle) const;
  double flux(const std::vector<double>& radiance, double light) const;
  double radiance(double light, double view) const;

  Medium medium_;  ///< the layer under construction
  std::vector<double> angle_, cosine_, weight_, scale_;
  /// Solutions for radiance even and odd in theta, both stored for 0 < theta < pi/2.
  Stack even_, odd_;
};

/// 2D Henyey-Greenstein (C22).
std::function<double(double)> henyey_greenstein(double g);

}  // namespace flatspeckle::oracles
