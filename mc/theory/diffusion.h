#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// Returns the extrapolation length of diffusion theory: the distance outside a face at which the
/// diffuse intensity, extrapolated linearly, is 0. It is 0.818 (in 3D 0.7104) transport mean free
/// paths. The surroundings have the index of the medium.
double extrapolation_length(const BulkMedium& medium);

/// Returns the extrapolation length of a scene whose faces reflect (conventions, C52). It follows
/// from two exact moments of the Milne problem, the flux and the second moment, with an outgoing
/// radiance that is linear in the cosine. For isotropic scatterers and indices from 0.8 to 2.5 the
/// error is below 0.5 %. The form with the mean reflectance of diffuse light alone, (1 + K)/(1 - K)
/// [zhu1991], is up to 17 % too long.
double extrapolation_length(const Scene& scene);

extern const DatasetTable diffusion_table;
/// Writes the extrapolation length of a homogeneous slab that scatters or absorbs.
void write_extrapolation_length(ResultFile& file, const Scene& scene);

/// Slab in which light diffuses.
struct DiffusingSlab {
  /// The surroundings have the index of the medium.
  DiffusingSlab(const BulkMedium& medium, double thickness);
  /// Includes the reflection by the faces of the scene.
  DiffusingSlab(const Scene& slab);  // NOLINT(google-explicit-constructor)

  /// Returns what absorption with the coefficient `mu` adds to kappa^2 of C20: dimension mu / l*.
  template <typename Number>
  Number loss(const Number& mu) const {
    return dimension / transport_length * mu;
  }

  double dimension, thickness;
  double mu_s, mu_a, g;
  double transport_length;  ///< transport mean free path l*
  double extrapolation;     ///< extrapolation length z0
};

/// Returns the field correlation C_E of light transmitted through a slab for the tilt wavenumber q,
/// by diffusion theory (conventions, C20; [feng1988], [freund1988], [berkovits1994]). The first
/// source lies one transport mean free path deep. The result is the limit for thick slabs and small
/// q, and no reference for thin slabs.
double diffusion_field_correlation(const DiffusingSlab& slab, double q);

/// Returns diffusion_field_correlation() with an arbitrary term `loss` added to kappa^2 of C20. For
/// a tilt `loss` is q^2; for a difference of frequencies it is complex.
Complex diffusion_loss_correlation(const DiffusingSlab& slab, Complex loss);

/// Returns the magnitude of the correlation of fields transmitted through a slab at wavenumbers k
/// and k (1 + shift), by diffusion theory. The difference of the wavenumbers acts as an absorption
/// i k shift, which is added to mu_a in kappa^2 of C20. The result is the limit for thick slabs.
double diffusion_frequency_correlation(const DiffusingSlab& slab, double k, double shift);

/// Returns the |q| at which C_I falls to 1/2, where C_I is the square of
/// diffusion_field_correlation().
double diffusion_range(const DiffusingSlab& slab);

/// Returns the mean number of scatterings of light in the slowest diffusion mode of a box or slab,
/// before it leaves the medium or is absorbed.
double scatterings_of_slowest_mode(const BulkMedium& medium, const Domain& domain);

/// Returns the field correlation C_E of light scattered once in a slab without attenuation (C21),
/// to first order in the tilt wavenumber q, for matched views. All views are assumed equally
/// bright; their C_E^2 is averaged (C19). tilt_azimuth: direction of q in space (C55).
double single_scattering_correlation(const Light& light, const std::vector<View>& views,
                                     double thickness, double q, double tilt_azimuth = 0);

}  // namespace flatspeckle::mc
