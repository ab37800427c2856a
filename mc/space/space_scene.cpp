#include "mc/space/space_scene.h"

#include <tuple>
#include <utility>

#include "core/error.h"
#include "grin/media/hg_phase.h"
#include "grin/media/mie_phase.h"
#include "grin/media/rayleigh_phase.h"
#include "grin/media/table_phase.h"
#include "grin/media/two_term_phase.h"
#include "mc/slab/range_refinement.h"
#include "mc/transport/bulk_slope.h"

namespace flatspeckle::mc {

namespace {

/// As functions, with the mean cosine.
template <typename Phase>
void set_phase(BulkMedium& medium, const Phase& phase) {
  medium.space_phase = {[phase](double cosine) { return phase.density(cosine); },
                        [phase](RandomStream& random) { return phase.one_minus_cosine(random); }};
  medium.g = phase.mean_cosine();
}

/// Albedo and phase function of spheres.
void set_spheres(BulkMedium& medium, const Scatterer& scatterer, double k) {
  const double size = k * scatterer.radius;
  constexpr double largest = 500;  // SpaceLaw sees all moments of its phase function
  if (!(size >= grin::MieSphere::smallest && size <= largest))
    throw InputError("radius", scatterer.radius,
                     "2 pi radius / wavelength of spheres must be from 1e-6 to 500");
  const grin::MieSphere sphere(size, scatterer.index);
  if (!(sphere.scattering() > 0))
    throw InputError("index", scatterer.index.real(), "spheres of this index do not scatter");
  const bool lossless = scatterer.index.imag() == 0;
  medium.albedo = lossless ? 1 : sphere.scattering() / sphere.extinction();
  medium.mu_s = medium.albedo * medium.mu_t;
  set_phase(medium, grin::MiePhase(sphere));
}

void set_phase(BulkMedium& medium, const Scatterer& scatterer, const ScattererValues& values) {
  if (scatterer.kind == Scatterer::Kind::hg) return set_phase(medium, grin::HgPhase{scatterer.g});
  if (values.scatterer == PhaseTable::word) {
    const auto& path = std::get<PhaseTable>(values.bulk).phase_table;
    return set_phase(medium, grin::TablePhase(AngleTable(PhaseTable::word, path)));
  }
  if (values.scatterer == Rayleigh::word) return set_phase(medium, grin::RayleighPhase());
  if (values.scatterer != TwoTermHg::word)
    throw InputError(
        "scatterer", values.scatterer,
        "with dimension = 3: hg (g = 0 is isotropic), two_term_hg, phase_table, rayleigh or mie");
  const auto& terms = std::get<TwoTermHg>(values.bulk);
  set_phase(medium, grin::TwoTermPhase{{*terms.g}, {*terms.g_back}, *terms.forward_share});
}

/// Of spheres at fixed extinction.
BulkSlopeOf<SpaceSlope> space_slope(const Scene& scene, const SpaceLaw& law,
                                    BulkParameter parameter) {
  if (parameter != BulkParameter::radius && parameter != BulkParameter::index)
    return bulk_slope_of<SpaceSlope>(scene.medium, law, parameter);
  return scatterer_slope<SpaceSlope>(scene, law, parameter, [&](const Scatterer& scatterer) {
    BulkMedium medium = scene.medium;
    set_spheres(medium, scatterer, scene.k);
    return std::pair(medium, SpaceLaw(medium.space_phase.density));
  });
}

}  // namespace

Scene in_space(Scene slab, const ScattererValues& values) {
  if (slab.domain.kind != Domain::Kind::slab)
    throw InputError("dimension", 3, "needs domain = slab");
  BulkMedium& medium = slab.medium;
  medium.dimension = 3;
  if (slab.scatterer.kind == Scatterer::Kind::mie)
    set_spheres(medium, slab.scatterer, slab.k);
  else
    set_phase(medium, slab.scatterer, values);
  return slab;
}

SpaceSlab space_slab(const Scene& scene, double delay) {
  return {scene.k, scene.medium.mu_t, scene.domain.depth, scene.medium.albedo,
          SpaceLaw(scene.medium.space_phase.density, delay)};
}

Refined space_covariance(const Scene& scene, bool reversed, const Refinement& refinement,
                         const FieldChange& change) {
  const SpaceSlab slab = space_slab(scene, change.delay);
  const SpaceRequest request = space_request(scene.request);
  if (change.shift == 0) return space_covariance(slab, request, reversed, refinement);
  const SpaceSlabOf<Complex> shifted{slab.k,      slab.mu_t, slab.depth,
                                     slab.albedo, slab.law,  {1, change.shift}};
  return space_covariance(shifted, request, reversed, refinement);
}

Refined space_slopes(const Scene& scene, bool reversed, const Refinement& refinement,
                     BulkParameter parameter) {
  const SpaceSlab slab = space_slab(scene);
  const auto slope = space_slope(scene, slab.law, parameter);
  const SpaceSlabOf<Dual<double>> changing{slab.k,     slab.mu_t,
                                           slab.depth, {slab.albedo, slope.albedo},
                                           slope.law,  {{1, -slope.log_mu_t}}};
  return by_parameter(
      space_covariance(changing, space_request(scene.request), reversed, refinement), slope.unit);
}

FieldJob space_covariance_job(const Scene& scene, bool reversed, const Refinement& refinement) {
  const auto solve = [=] {
    return refined_range(scene.request, refinement, [&](const Refinement& finer) {
      return space_covariance(scene, reversed, finer);
    });
  };
  return two_batch_job(scene.request.entries.size(), 1, solve).field;
}

PathJob space_change_job(const Scene& scene, bool reversed, const Refinement& refinement,
                         const std::vector<FieldChange>& changes) {
  return change_job(scene.request.entries.size(), changes, [=](const FieldChange& change) {
    return space_covariance(scene, reversed, refinement, change);
  });
}

GradientJob space_gradient_job(const Scene& scene, bool reversed, const Refinement& refinement) {
  return slope_job(scene, [=](BulkParameter parameter) {
    return space_slopes(scene, reversed, refinement, parameter);
  });
}

}  // namespace flatspeckle::mc
