#include "apps/results/datasets.h"

#include <iostream>

#include "apps/command/subcommands.h"
#include "apps/results/view_power.h"

// The tables are declared here, instead of including the headers of the code that fills them, so
// that this file does not depend on that code.
namespace flatspeckle {

extern const DatasetTable provenance_table, scene_table, layers_table, density_table, axes_table,
    beams_table, trace_table, structure_factor_table, state_table;

namespace wave {
extern const DatasetTable solution_table, space_solution_table, spectrum_table, cluster_table,
    cluster_solution_table, graded_table, map_table, matrix_table, scattering_matrix_table;
}

namespace mc {
extern const DatasetTable diffusion_table, mean_table, intensity_table, full_table, pairs_table,
    moves_table, reflection_theory_table, gradient_table, delays_table, contrast_table,
    frequency_table, numerical_table, flux_table, distance_table, flow_table, field_table, imaging_table, picture_table,
    blinking_table, simulated_picture_table, recovery_table, recovered_picture_table,
    contrast_map_table, separation_table, fit_table, plan_table;
}

namespace grin {
extern const DatasetTable rays_table, trials_table, camera_table, area_table, radial_table,
    directional_table, polar_table, render_table, energy_table, box_map_table, ring_map_table;

namespace design {
extern const DatasetTable design_table;
}
}  // namespace grin

}  // namespace flatspeckle

namespace flatspeckle::apps {

namespace {

/// Returns a text for a cell of a Markdown table, with | escaped.
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

/// Returns the sign by which docs/format.md marks datasets with standard errors or limits.
const char* mark(Data data) {
  return has_error(data) ? " ±" : data == Data::invariant ? " ≤" : "";
}

void print(const DatasetTable& table) {
  std::cout << "<!-- datasets: " << table.name << " -->\n";
  if (!table.rows.empty())
    std::cout << "| dataset | type | axes | units | long name |\n|---|---|---|---|---|\n";
  for (const DatasetRow& row : table.rows)
    std::cout << "| " << code(row.path) << mark(row.data) << " | " << type_name(row.data) << " | "
              << axes_of(row) << " | " << code(row.unit) << " | " << cell(row.long_name) << " |\n";
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
                                             &mc::diffusion_table,
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
                                             &power_table,
                                             &validate_table,
                                             &own_places_table,
                                             &wave::solution_table,
                                             &wave::space_solution_table,
                                             &wave::spectrum_table,
                                             &wave::cluster_table,
                                             &wave::cluster_solution_table,
                                             &wave::graded_table,
                                             &wave::map_table,
                                             &wave::scattering_matrix_table,
                                             &wave::matrix_table,
                                             &mc::flux_table,
                                             &mc::distance_table,
                                             &mc::flow_table,
                                             &mc::field_table,
                                             &mc::imaging_table,
                                             &mc::picture_table,
                                             &mc::blinking_table,
                                             &mc::simulated_picture_table,
                                             &mc::recovery_table,
                                             &mc::recovered_picture_table,
                                             &mc::separation_table,
                                             &mc::contrast_map_table,
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

namespace {

int print_tables(const Subcommand&, NoKeys&) {
  const auto tables = all_tables();
  print_roles(tables);
  for (const DatasetTable* table : tables) print(*table);
  return ExitStatus::done;
}

}  // namespace

std::unique_ptr<Call> datasets(const std::string&) {
  return call_with<NoKeys>(
      "datasets", "Lists the datasets of result files, as tables for docs/format.md", print_tables);
}

}  // namespace flatspeckle::apps
