#include "apps/flatland/solve_keys.h"

#include "apps/flatland/space_solve.h"

namespace flatspeckle::apps {

void add_solve_keys(Keys& keys, SolveKeys& values) {
  add_scatterer_keys(keys, values.spec);
  add_bulk_keys(keys, values.spec);
  add_medium_keys(keys, values.spec);
  add_profile_keys(keys, values.spec);
  add_index_keys(keys, values.spec);
  add_faces_keys(keys, values.spec);
  keys.remove("placement");
  keys.add("placement", values.spec.placement,
           "CSV file with columns x, z [, radius [, index_re, index_im]], in space also y; or "
           "poisson, hard_disk or equilibrium, to draw one; with cluster: CSV file with columns x, "
           "z [, angle]");
  add_view_keys(keys, values.spec);
  add_space_solve_keys(keys, values.spec);
  add_map_keys(keys, values.map);
  add_spectrum_keys(keys, values.spectrum);
  add_solver_keys(keys, values);
  keys.group("Periodic cell");
  keys.add("period", values.period,
           "The placement repeats along x with this period; the result is the scattering matrix "
           "between its channels")
      .positive()
      .unit("length");
  add_period_phase_key(keys, values);
  keys.add(
          "map_eigenchannels", values.map_eigenchannels,
          "Transmission eigenchannels whose fields are mapped, beside light at normal incidence: 0 "
          "is the most open")
      .from(0, 1e6)
      .only_of("period with map");
  keys.add(
          "map_lights", values.map_lights,
          "CSV file with columns light (0, 1, ...), channel (its number in light_sine), re and im: "
          "amplitudes of further lights that are mapped")
      .file()
      .only_of("period with map");
  keys.group("Clusters");
  keys.add("t_matrix_gap", values.t_matrix_gap,
           "Also write the T-matrix of the whole placement, for sources at least this far from the "
           "circle around it")
      .positive()
      .unit("length");
  keys.add("cluster", values.cluster,
           "Result file with a T-matrix: a copy of its cluster is placed at each position of "
           "placement")
      .file();
}

}  // namespace flatspeckle::apps
