#include "apps/results/datasets.h"

#include <iostream>

#include "apps/command/subcommands.h"
#include "apps/results/all_tables.h"
#include "core/result/provenance.h"
#include "core/result/run_state_file.h"
#include "flatland/media/density_map.h"
#include "flatland/media/layers.h"
#include "flatland/media/structure_factor.h"
#include "flatland/scene/scene_datasets.h"
#include "grin/design/scene/design_datasets.h"
#include "grin/render/energy_datasets.h"
#include "grin/render/map_datasets.h"
#include "grin/render/render_datasets.h"
#include "grin/scene/trace_datasets.h"
#include "mc/changes/brownian.h"
#include "mc/changes/frequency_shifts.h"
#include "mc/estimators/flux.h"
#include "mc/estimators/gradient.h"
#include "mc/estimators/reflection_theory.h"
#include "mc/fit/fit_datasets.h"
#include "mc/fit/plan/plan_datasets.h"
#include "mc/imaging/blinking_datasets.h"
#include "mc/imaging/imaging_datasets.h"
#include "mc/imaging/picture_datasets.h"
#include "mc/jobs/contrast.h"
#include "mc/recovery/recovery_datasets.h"
#include "mc/slab/refinement.h"
#include "mc/speckle/field_datasets.h"
#include "mc/theory/moments_datasets.h"
#include "mc/unmixing/unmixing_datasets.h"
#include "wave_solver/clusters/cluster_file.h"
#include "wave_solver/clusters/cluster_solution.h"
#include "wave_solver/graded/graded_fields.h"
#include "wave_solver/maps/map_datasets.h"
#include "wave_solver/solutions/spectrum.h"

namespace flatspeckle::apps {

namespace {

/// A cell of a table; upright lines would end it.
std::string cell(const std::string& text) {
  std::string cell;
  for (const char letter : text)
    cell += letter == '|' ? std::string("\\|") : std::string(1, letter);
  return cell;
}

std::string code(const std::string& text) {
  return text.empty() ? "" : '`' + text + '`';
}

std::string axes_of(const DatasetRow& row) {
  if (row.data == Data::scale) return "scale";
  if (row.data == Data::numbers) return "0, 1, ...";
  return row.axes.empty() ? "scalar" : code(row.axes);
}

void print(const DatasetTable& table) {
  std::cout << "<!-- datasets: " << table.name << " -->\n";
  if (!table.rows.empty())
    std::cout << "| dataset | type | axes | units | long name |\n|---|---|---|---|---|\n";
  for (const DatasetRow& row : table.rows)
    std::cout << "| " << code(row.path) << (has_error(row.data) ? " ±" : "") << " | "
              << type_name(row.data) << " | " << axes_of(row) << " | " << code(row.unit) << " | "
              << cell(row.long_name) << " |\n";
  if (!table.rows.empty() && !table.attributes.empty()) std::cout << '\n';
  if (!table.attributes.empty())
    std::cout << "| attribute | of | type | meaning |\n|---|---|---|---|\n";
  for (const AttributeRow& row : table.attributes)
    std::cout << "| " << code(row.name) << " | " << code(row.object) << " | " << row.type << " | "
              << cell(row.meaning) << " |\n";
  std::cout << "<!-- end -->\n";
}

void print_roles(const std::vector<const DatasetTable*>& tables) {
  std::cout << "<!-- datasets: roles -->\n| word | stands for |\n|---|---|\n";
  for (const DatasetTable* table : tables)
    for (const Role& role : table->roles) {
      std::cout << "| " << code(role.word) << " | ";
      for (const std::string& meaning : role.meanings)
        std::cout << (&meaning == &role.meanings.front() ? "" : " or ") << code(meaning);
      std::cout << " |\n";
    }
  std::cout << "<!-- end -->\n";
}

}  // namespace

std::vector<const DatasetTable*> all_tables() {
  std::vector<const DatasetTable*> tables = {&provenance_table,
                                             &scene_table,
                                             &layers_table,
                                             &density_table,
                                             &axes_table,
                                             &beams_table,
                                             &trace_table,
                                             &mc::mean_table,
                                             &mc::intensity_table,
                                             &mc::full_table,
                                             &mc::pairs_table,
                                             &mc::moves_table,
                                             &mc::reflection_theory_table,
                                             &mc::gradient_table,
                                             &mc::delays_table,
                                             &mc::contrast_table,
                                             &mc::frequency_table,
                                             &mc::numerical_table,
                                             &validate_table,
                                             &own_places_table,
                                             &wave::solution_table,
                                             &wave::spectrum_table,
                                             &wave::cluster_table,
                                             &wave::cluster_solution_table,
                                             &wave::graded_table,
                                             &wave::map_table,
                                             &mc::flux_table,
                                             &mc::field_table,
                                             &mc::imaging_table,
                                             &mc::picture_table,
                                             &mc::blinking_table,
                                             &mc::recovery_table,
                                             &mc::unmixing_table,
                                             &mc::fit_table,
                                             &mc::plan_table,
                                             &sweep_axes_table,
                                             &sweep_table,
                                             &stacked_table,
                                             &optimum_table,
                                             &placement_table,
                                             &structure_factor_table,
                                             &grin::rays_table,
                                             &grin::trials_table,
                                             &grin::camera_table,
                                             &grin::area_table,
                                             &grin::radial_table,
                                             &grin::directional_table,
                                             &grin::polar_table,
                                             &grin::render_table,
                                             &grin::energy_table,
                                             &grin::box_map_table,
                                             &grin::ring_map_table,
                                             &grin::design::design_table};
#ifdef FLATSPECKLE_BENCH
  for (const DatasetTable* table : bench_tables()) tables.push_back(table);
#endif
  tables.push_back(&state_table);
  return tables;
}

int datasets(const Arguments& arguments) {
  Subcommand command("datasets", "Tables of what result files hold, for docs/format.md");
  if (!command.parse(arguments)) return ExitStatus::done;
  const auto tables = all_tables();
  print_roles(tables);
  for (const DatasetTable* table : tables) print(*table);
  return ExitStatus::done;
}

}  // namespace flatspeckle::apps
