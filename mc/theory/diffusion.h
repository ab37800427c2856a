#pragma once

#include <vector>

#include "flatland/media/domain.h"
#include "flatland/media/medium.h"

namespace flatspeckle::mc {

/// Returns the field correlation C_E of light transmitted through a slab for the tilt wavenumber q,
/// by diffusion theory (conventions, C20; [feng1988], [freund1988], [berkovits1994]). The
/// surroundings have the index of the slab. The first source lies one transport mean free path
/// deep; the extrapolation length is 0.818 (in 3D 0.7104) transport mean free paths. The result is
/// the limit for thick slabs and small q, and no reference for thin slabs.
double diffusion_field_correlation(const BulkMedium& medium, double thickness, double q);

/// Returns diffusion_field_correlation() with an arbitrary term `loss` added to kappa^2 of C20. For
/// a tilt `loss` is q^2; for a difference of frequencies it is complex.
Complex diffusion_loss_correlation(const BulkMedium& medium, double thickness, Complex loss);

/// Returns the extrapolation length of diffusion theory: the distance outside a face at which the
/// diffuse intensity, extrapolated linearly, is 0.
double extrapolation_length(const BulkMedium& medium);

/// Returns the |q| at which C_I falls to 1/2, where C_I is the square of
/// diffusion_field_correlation().
double diffusion_range(const BulkMedium& medium, double thickness);

/// Returns the mean number of scatterings of light in the slowest diffusion mode of a box or slab,
/// before it leaves the medium or is absorbed.
double scatterings_of_slowest_mode(const BulkMedium& medium, const Domain& domain);

/// Returns the field correlation C_E of light scattered once in a slab without attenuation (C21),
/// for the tilt wavenumber q and matched views. light and views are angles. All views are assumed
/// equally bright; their contributions are summed before the modulus is taken (C19).
double single_scattering_correlation(double light, const std::vector<double>& views,
                                     double thickness, double q);

}  // namespace flatspeckle::mc
