#include "mc/slab/adding/space_scene.h"

#include "core/error.h"
#include "grin/media/scattering/hg_phase.h"
#include "grin/media/scattering/mie_phase.h"
#include "grin/media/scattering/rayleigh_phase.h"
#include "grin/media/scattering/table_phase.h"
#include "grin/media/scattering/two_term_phase.h"
#include "mc/slab/adding/space.h"

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

Scene SpaceGeometry::with_scatterer(Scene scene, const Scatterer& scatterer) {
  set_spheres(scene.medium, scatterer, scene.k);
  return scene;
}

}  // namespace flatspeckle::mc
