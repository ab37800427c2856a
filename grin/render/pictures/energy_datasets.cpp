#include "grin/render/pictures/energy_datasets.h"

#include "core/result/result_group.h"

namespace flatspeckle::grin {

const DatasetTable energy_table{
    "energy",
    {{"energy/emitted", Data::estimate, "", "1", "power of the lights, as light paths drew it"},
     {"energy/absorbed_stage", Data::estimate, "", "1", "absorbed in the stage, but for bodies"},
     {"energy/absorbed_body", Data::estimate, "", "1", "absorbed in bodies"},
     {"energy/unscattered", Data::estimate, "", "1", "left the stage without a scattering"},
     {"energy/specular", Data::estimate, "", "1",
      "the same, reflected at the surface of a body without having entered"},
     {"energy/scattered", Data::estimate, "", "1", "left the stage after a scattering or more"},
     {"energy/lost", Data::estimate, "", "1", "in flights that were lost (transport/lost_flights)"},
     {"energy/cut", Data::estimate, "", "1", "of paths that were cut by max_scatterings"}}};

namespace {

/// Fates in the order of their rows.
bool can_be(Fate fate, const RenderScene& scene, const RenderRequest& request) {
  if (fate == Fate::absorbed_body || fate == Fate::specular) return !scene.stage.bodies.empty();
  return fate != Fate::cut || request.max_scatterings > 0;
}

}  // namespace

std::optional<Estimate> energy_result(const RenderJob& job, const GroupedSums& sums) {
  if (!job.has_energy) return std::nullopt;
  return jackknife(sums, [first = job.pictures](double samples, std::span<const Complex> all) {
    return sample_mean(samples, all.subspan(first, EnergyBalance::size));
  });
}

void write_energy(ResultFile& file, const RenderScene& scene, const RenderRequest& request,
                  const Estimate& energy) {
  const ResultGroup root(file, energy_table);
  for (std::size_t fate = 0; fate < EnergyBalance::size; ++fate)
    if (can_be(static_cast<Fate>(fate), scene, request))
      root.put(energy_table.rows[fate].path, part(energy, fate, 1));
}

}  // namespace flatspeckle::grin
