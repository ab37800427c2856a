#pragma once

#include <vector>

#include "flatland/media/domain.h"
#include "flatland/media/medium.h"

namespace flatspeckle::mc {

/// Diffusion theory of C_E for a slab of scatterers between index-matched sides (conventions, C20;
/// Berkovits and Feng 1994): transmitted light, tilt wavenumber q. The first source lies one
/// transport mean free path deep, the extrapolation length is 0.818 (in space 0.7104) transport
/// mean free paths. A limit for thick slabs and small q, not a reference for thin ones.
double diffusion_field_correlation(const BulkMedium& medium, double thickness, double q);

/// The same for any addition to its kappa^2, the square of a tilt's wavenumber among them. Complex:
/// a difference of frequencies.
Complex diffusion_loss_correlation(const BulkMedium& medium, double thickness, Complex loss);

/// By how much diffuse light extends beyond a face.
double extrapolation_length(const BulkMedium& medium);

/// |q| where C_I = C_E^2 of that falls to 1/2.
double diffusion_range(const BulkMedium& medium, double thickness);

/// How often light is scattered on the mean that stays longest: the slowest mode of diffusion
/// between the edges of a box or the faces of a slab, which dies by leaving and by absorption.
double scatterings_of_slowest_mode(const BulkMedium& medium, const Domain& domain);

/// C_E by single scattering in a slab without attenuation (C21), tilt wavenumber q with matched
/// views; the sum over equally bright views is taken before the modulus (C19).
double single_scattering_correlation(double light, const std::vector<double>& views,
                                     double thickness, double q);

}  // namespace flatspeckle::mc
