#include "mc/space/space_scene.h"

#include <tuple>

#include "core/error.h"
#include "grin/media/hg_phase.h"
#include "grin/media/rayleigh_phase.h"
#include "grin/media/table_phase.h"
#include "grin/media/two_term_phase.h"
#include "mc/transport/range_refinement.h"

namespace flatspeckle::mc {

namespace {

/// As functions, with the mean cosine.
template <typename Phase>
void set_phase(BulkMedium& medium, const Phase& phase) {
  medium.space_phase = {[phase](double cosine) { return phase.density(cosine); },
                        [phase](RandomStream& random) { return phase.one_minus_cosine(random); }};
  medium.g = phase.mean_cosine();
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
        "with dimension = 3: hg (g = 0 is isotropic), two_term_hg, phase_table or rayleigh");
  const auto& terms = std::get<TwoTermHg>(values.bulk);
  set_phase(medium, grin::TwoTermPhase{{*terms.g}, {*terms.g_back}, *terms.forward_share});
}

}  // namespace

Scene in_space(Scene slab, const ScattererValues& values) {
  if (slab.domain.kind != Domain::Kind::slab)
    throw InputError("dimension", 3, "needs domain = slab");
  BulkMedium& medium = slab.medium;
  medium.dimension = 3;
  set_phase(medium, slab.scatterer, values);
  return slab;
}

SpaceSlab space_slab(const Scene& scene, double delay) {
  return {scene.k, scene.medium.mu_t, scene.domain.depth, scene.medium.albedo,
          SpaceLaw(scene.medium.space_phase.density, delay)};
}

FieldJob space_covariance_job(const Scene& scene, bool reversed, const Refinement& refinement) {
  const auto solve = [=] {
    const SpaceSlab slab = space_slab(scene);
    const SpaceRequest request = space_request(scene.request);
    return refined_range(scene.request, refinement, [&](const Refinement& finer) {
      return space_covariance(slab, request, reversed, finer);
    });
  };
  return two_batch_job(scene.request.entries.size(), 1, solve).field;
}

PathJob space_delay_job(const Scene& scene, bool reversed, const Refinement& refinement,
                        const std::vector<double>& delays) {
  const auto solve = [=] {
    const SpaceRequest request = space_request(scene.request);
    Refined all = space_covariance(space_slab(scene), request, reversed, refinement);
    for (const double delay : delays)
      all.append(space_covariance(space_slab(scene, delay), request, reversed, refinement));
    return all;
  };
  return two_batch_job(scene.request.entries.size(), 1 + delays.size(), solve);
}

}  // namespace flatspeckle::mc
