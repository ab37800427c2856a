#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/algebra/dense.h"
#include "mc/distance/layer_modes.h"

namespace flatspeckle::mc {

/// Derivatives of the reflected light by the coefficients of one layer.
struct LossDerivatives {
  std::vector<Complex> loss;  ///< by LayerLosses::loss
  Complex beam;               ///< by LayerLosses::beam
};

/// Light of a beam along z that layers reflect, at one transverse frequency.
struct Reflected {
  Complex power;  ///< per power of the beam in the first layer
  std::vector<LossDerivatives> derivatives;
};

/// Radiance in a stack of layers at one transverse frequency, as a sum of modes of each layer. The
/// layers have one refractive index; the faces above and below them may reflect.
class LayeredRadiance {
 public:
  /// layers and modes: one for each layer, from the top down. top, bottom: conditions at the faces,
  /// each seen from the layers.
  LayeredRadiance(const RadianceHarmonics& harmonics, const std::vector<LayerLosses>& layers,
                  std::vector<LayerModes> modes, const FaceConditions& top,
                  const FaceConditions& bottom);

  /// Returns the light that leaves through the top face. with_derivatives: whether the derivatives
  /// are also computed.
  Reflected reflected(bool with_derivatives) const;
  /// Returns the power of Reflected as a functional of the radiance itself. reflected() computes it
  /// from the adjoint radiance instead; the two agree by reciprocity.
  Complex reflected_by_radiance() const;

 private:
  using Vector = Eigen::VectorXcd;

  /// Amplitudes of the modes of a layer: downward modes at its top, upward modes at its bottom.
  struct Amplitudes {
    Vector down, up;
  };
  /// Odd coefficients and flow.
  struct Trace {
    Vector odd, flow;
  };
  /// Right-hand sides: of the condition at the top face and of that at the bottom face, and jumps
  /// of the radiance at the faces between layers.
  struct Sources {
    Vector top, bottom;
    std::vector<Trace> jumps;
  };
  /// Radiance that follows the unscattered beam: `mode` exp(-beam z) times the power of the beam at
  /// the top of the layer.
  struct Following {
    Vector even, odd, flow;
  };
  class Solver;

  Vector attenuation(std::size_t layer) const;
  Vector beam_source(std::size_t layer) const;
  Following following(std::size_t layer) const;
  Sources sources_of_beam(const std::vector<Following>& following) const;
  Sources sources_of_detector() const;
  Complex power_from(std::size_t layer, const Amplitudes& adjoint) const;
  LossDerivatives derivatives(std::size_t layer, const Amplitudes& adjoint,
                              const Amplitudes& radiance, const Following& following) const;

  const RadianceHarmonics& harmonics_;
  const std::vector<LayerLosses>& layers_;
  std::vector<LayerModes> modes_;
  const FaceConditions &top_, &bottom_;
  std::vector<double> beam_;  ///< power of the beam at the top of each layer
};

}  // namespace flatspeckle::mc
