#include "tests/fuzz/result_kinds.h"

#include <numbers>

#include "core/result/result_file.h"
#include "core/result/result_reader.h"
#include "core/result/run_state_file.h"
#include "core/run/run_merger.h"
#include "flatland/media/medium.h"
#include "grin/media/fields/spline_field.h"
#include "grin/media/scattering/scattering_medium.h"
#include "tests/fuzz/input.h"

namespace flatspeckle::fuzz {

namespace {

constexpr std::size_t sums = 2;

BatchJob job() {
  return {.size = sums, .samples_per_batch = 10, .run = {}, .relative_error = [](const auto& all) {
            return relative_error(jackknife(all, sample_mean));
          }};
}

void add_batch(GroupedSums& to) {
  const double number = static_cast<double>(to.batches());
  to.add(10, std::vector<Complex>{{1 + 1 / (1 + number), 0.5}, {2, number}});
}

void write_run(const std::string& path) {
  RunState state{GroupedSums(sums), {{1, 2}, {1, 2}, {80, 100}, {0.5, 0.4}}, 2, 2};
  for (int batch = 0; batch < 10; ++batch) add_batch(state.sums);
  ResultFile file(path);
  write_state(file, "state", state);
  file.commit();
}

/// Continues the run and saves it again.
void read_run(const std::string& path) {
  RunState state = read_state(ResultReader(path), "state", sums);
  const BatchJob work = job();
  RunMerger merger(work, {.samples = 200, .seconds = {}, .target_error = 0.01}, state);
  while (!merger.ended()) {
    merger.add(std::vector<Complex>{{1, 0.5}, {2, 1}}, 0.1);
    require_finite(merger.cpu_s_left());
  }
  ResultFile file("again.h5");
  write_state(file, "state", state);
}

constexpr DiskSpacing disks{0.1, 0.5};

void write_structure(const std::string& path) {
  ResultFile file(path);
  file.scale("q", std::vector{0.5, 1.0, 2.0}, "1/length", "");
  file.dataset("structure_factor", std::vector{0.8, 0.9, 1.0}, {"q"}, "1", "");
  file.attribute("/", "count", std::uint64_t{10});
  file.attribute("/", "packing_fraction", disks.packing());
  file.attribute("/", "min_gap", 0.0);
  file.attribute("/", "width", 10.0);
  file.attribute("/", "depth", 10.0);
  file.commit();
}

void read_structure(const std::string& path) {
  const StructureFactor table = flatspeckle::read_structure(path, disks);
  for (double q = 0; q < 3; q += 0.1) require_finite(table(q));
}

void write_nodes(const std::string& path, const std::string& dataset) {
  ResultFile file(path);
  constexpr std::size_t side = 4;
  file.dataset(dataset, std::vector(side * side * side, 0.1), {side, side, side}, "1", "");
  for (const char* name : {"origin", "spacing"})
    file.attribute(dataset, name, std::vector{1.0, 1.0, 1.0});
  file.commit();
}

void write_grid(const std::string& path) {
  write_nodes(path, "excess");
}

void read_grid(const std::string& path) {
  const auto field = grin::read_spline_field(path);
  require_finite(field.excess(field.grid().origin));
}

void write_density(const std::string& path) {
  write_nodes(path, "density");
}

void read_density(const std::string& path) {
  const auto density = grin::read_density_grid(path);
  require_finite(density.largest());
  require_finite(density(density.grid().origin + density.grid().spacing / 3));
}

}  // namespace

const std::vector<ResultKind>& result_kinds() {
  static const std::vector<ResultKind> kinds{
      {write_run,
       {{"state/group_samples", ""},
        {"state/group_sums", ""},
        {"state", "batches"},
        {"state", "wall_s"},
        {"state", "cpu_s"},
        {"state/trace/wall_s", ""},
        {"state/trace/cpu_s", ""},
        {"state/trace/samples", ""},
        {"state/trace/relative_error", ""}},
       read_run,
       true},
      {write_structure,
       {{"q", ""},
        {"structure_factor", ""},
        {"/", "count"},
        {"/", "packing_fraction"},
        {"/", "min_gap"},
        {"/", "width"},
        {"/", "depth"}},
       read_structure},
      {write_grid, {{"excess", ""}, {"excess", "origin"}, {"excess", "spacing"}}, read_grid},
      {write_density,
       {{"density", ""}, {"density", "origin"}, {"density", "spacing"}},
       read_density}};
  return kinds;
}

}  // namespace flatspeckle::fuzz
