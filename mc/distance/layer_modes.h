#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/algebra/dense.h"
#include "core/numbers/complex.h"
#include "mc/distance/harmonics.h"

namespace flatspeckle::mc {

/// Coefficients of the transport equation in one layer, in RadianceHarmonics up to degree N. The
/// radiance L obeys
///   cos(theta) dL/dz + i q sin(theta) cos(phi) L + sum_lm loss[l] L_lm Y_lm = source.
struct LayerLosses {
  /// loss[l] = mu_a + mu_s (1 - p_l), l = 0 .. N, with p_l the moments of the phase function.
  std::vector<double> loss;
  /// Extinction of the beam: loss N + 1, so that light of the forward peak, which the kept moments
  /// do not resolve, is treated as unscattered (the delta-M method [wiscombe1977]).
  double beam;
  double thickness;
};

/// A solution of the transport equation that decays along one axis: exp(-s / length) times the sum
/// over l of coefficients[l - azimuth] Y_l,azimuth about that axis.
struct AxialMode {
  int azimuth;
  double length;  ///< decay length
  std::vector<double> coefficients;
};

/// Returns all modes that decay along an axis; they are normalised to sum loss[l] coefficients^2 =
/// 1. Modes that decay in the other direction are their mirror images.
std::vector<AxialMode> axial_modes(const LayerLosses& layer, int order);

/// Modes of a layer at one transverse frequency q, one per column: exp(i q x - decay z) times a
/// function of direction. They are the axial modes about the complex axes whose transverse
/// wavenumber is q (the method of rotated reference frames [markel2004], [liemert2013]).
struct LayerModes {
  LayerModes(const HarmonicRotation& rotation, const RadianceHarmonics& harmonics,
             const std::vector<AxialMode>& axial, Complex q);

  Complex frequency;  ///< q
  Eigen::VectorXcd decay;
  /// Norms v^T (cos(theta) v). Modes of different decay are orthogonal in this product.
  Eigen::VectorXcd norm;
  Rows even, odd;  ///< coefficients in the even and odd functions
  Rows flow;       ///< RadianceHarmonics::flow() of the even coefficients
};

}  // namespace flatspeckle::mc
