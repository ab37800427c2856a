#include <algorithm>
#include <cmath>

#include "apps/results/datasets.h"
#include "apps/sweep/curve_result.h"
#include "core/result/result_group.h"
#include "core/result/run_state_file.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/slab/refinement.h"
#include "mc/theory/diffusion.h"
#include "mc/theory/moments_datasets.h"

namespace flatspeckle::apps {

const DatasetTable sweep_table{
    .name = "sweep",
    .rows = {{"density", Data::real, "GRID", "1/length^2", "scatterers per area"},
             {"radius", Data::real, "GRID", "length", "radius of the disks"},
             {"index", Data::real, "GRID", "1", "relative index, real part"},
             {"index_imaginary", Data::real, "GRID", "1", "relative index, imaginary part"},
             {"optical_depth", Data::real, "GRID", "1", "optical depth mu_t L"},
             {"g", Data::real, "GRID", "1", "mean cosine of scattering"},
             {"albedo", Data::real, "GRID", "1", "single-scattering albedo"},
             {"k_mean_free_path", Data::real, "GRID", "1", "wavenumber times mean free path"},
             {"diffusion_theory", Data::real, "GRID tilt", "1", "C_E in diffusion theory"},
             {"diffusion_range", Data::real, "GRID", "1", "q L at C_I = 1/2 in diffusion theory"},
             {"single_scattering", Data::real, "tilt", "1",
              "C_E of single scattering in a slab without attenuation"},
             {"single_scattering_range", Data::real, "", "1",
              "q L at C_I = 1/2 by single scattering"},
             {"field_correlation", Data::estimate, "GRID tilt", "1",
              "field correlation C_E, summed over views"},
             {"memory_effect_range", Data::estimate, "GRID", "1",
              "q L at C_I = 1/2 with matched views, L the depth"},
             {"memory_effect_angle", Data::estimate, "GRID", "rad",
              "rotation of the light at C_I = 1/2"},
             {"range_censored", Data::count, "GRID", "1",
              "0: range found; 1: C_I stays above 1/2, a lower bound; 2: it is below at the first "
              "step, an upper bound"},
             {"range_steps", Data::count, "GRID", "1",
              "tilts between 0 and the range: fewer than 4 are too few to trust its error"},
             {"relative_error", Data::real, "GRID", "1",
              "RMS standard error of the covariances relative to their RMS magnitude"},
             {"samples", Data::real, "GRID", "1", "samples"},
             {"cpu_s", Data::real, "GRID", "s", "processor time, all threads"},
             {"wall_s", Data::real, "GRID", "s",
              "time from the first batch to the last, other points' included"},
             {"trace/of_point", Data::count, "trace/checkpoint", "1",
              "number of the point, in the order of the grid"},
             {"deviation", Data::real, "GRID tilt", "1",
              "mc less wave, in combined standard errors"}},
    .attributes = {{"", "format", "uint64", "2; sweeps without it have an older layout"},
                   {"", "complete", "bool", "0: points are missing"},
                   {"", "ranks", "int64", "processes that worked on it (MPI)"},
                   {"", "target_error", "float64", "that each point was to reach, if any"},
                   {"single_scattering_range", "censored", "uint64", mc::censored_meaning}},
    .roles = {{"GRID", {"density radius index optical_depth g albedo", "point"}}}};

namespace {

using Points = std::vector<PointResult>;

/// The curves of all points, one after the other.
template <typename Value>
std::vector<Value> of_points(const Points& points, std::vector<Value> PointResult::*curve) {
  std::vector<Value> values;
  for (const PointResult& point : points)
    values.insert(values.end(), (point.*curve).begin(), (point.*curve).end());
  return values;
}

/// Writes the result of a sweep, over the points that are finished.
class SweepWriter {
 public:
  SweepWriter(ResultFile& file, const CurveSweep& sweep, const CurveResults& results)
      : file_(file), sweep_(sweep), results_(results.by_method) {
    for (std::size_t point : results.points) {
      scenes_.push_back(sweep.scene(point));
      if (scenes_.size() > 1) scenes_.back().request = {};  // the same at all points, and large
    }
  }

  void write() {
    write_domain(file_, scenes_.front());
    const bool whole = scenes_.size() == sweep_.points().count();
    write_sweep_grid(file_, sweep_, scenes_, sweep_.points().is_list || !whole);
    write_axes(file_, scenes_.front());
    write_theory();
    const bool both = results_.size() > 1;
    for (std::size_t method = 0; method < results_.size(); ++method)
      write_method(method, both ? sweep_.method_words[method] : "");
    if (both) write_deviation();
  }

 private:
  void write_theory() const {
    const ResultGroup root(file_, sweep_table);
    const auto& request = scenes_.front().request;
    const double depth = scenes_.front().domain.depth;
    if (!request.transmission_only()) return;
    write_single_scattering(root, request, depth);
    std::vector<double> curves;
    for (const Scene& scene : scenes_)
      for (double q : request.tilt_q)
        curves.push_back(mc::diffusion_field_correlation(scene.medium, depth, q));
    root.put("diffusion_theory", curves);
    root.put("diffusion_range", column(scenes_, [&](const Scene& scene) {
               return mc::diffusion_range(scene.medium, depth) * depth;
             }));
  }

  static void write_single_scattering(const ResultGroup& root, const CovarianceRequest& request,
                                      double depth) {
    const auto views = request.reference_angles();
    const auto curve = column(request.tilt_q, [&](double q) {
      return mc::single_scattering_correlation(request.lights.front().angle, views, depth, q);
    });
    const auto range =
        mc::memory_effect_range(request.tilt_q, std::vector<Complex>(curve.begin(), curve.end()));
    root.put("single_scattering", curve);
    root.put("single_scattering_range", range.value * depth);
    root.attribute("single_scattering_range", "censored",
                   static_cast<std::uint64_t>(range.censored));
  }

  void write_method(std::size_t method, const std::string& group) const {
    const Points& points = results_[method];
    const Scene& scene = scenes_.front();
    const ResultGroup out(file_, sweep_table, group);
    const auto steps = [&](const PointResult& point) {
      return mc::steps_below(scene.request.tilt_q, range_in_q(scene, point));
    };
    out.put("field_correlation", of_points(points, &PointResult::correlation),
            of_points(points, &PointResult::correlation_error),
            of_points(points, &PointResult::correlation_rare));
    const auto rare = column(points, &PointResult::range_rare);
    out.put("memory_effect_range", column(points, &PointResult::range),
            column(points, &PointResult::range_error), rare);
    out.put("range_censored", column(points, &PointResult::range_censored));
    out.put("range_steps", column(points, steps));
    write_angles(out, points);
    out.put("relative_error", column(points, &PointResult::relative_error));
    out.put("samples", column(points, &PointResult::samples));
    out.put("cpu_s", column(points, &PointResult::cpu_s));
    out.put("wall_s", column(points, &PointResult::wall_s));
    if (const auto target = sweep_.stop(sweep_.run(method, 0)).target_error)
      out.attribute("target_error", *target);
    if (sweep_.method_words[method] == "transport") mc::write_numerical(file_, group);
    write_traces(out, points, group);
  }

  /// The ranges as rotations of the light, to the side on which they were read off.
  void write_angles(const ResultGroup& out, const Points& points) const {
    const Scene& scene = scenes_.front();
    const auto& q = scene.request.tilt_q;
    const bool positive = std::any_of(q.begin(), q.end(), [](double each) { return each > 0; });
    const double light = scene.request.lights.front().angle;
    const double per_range = 1 / (scene.domain.depth * scene.k);
    std::vector<double> angles, errors;
    for (const PointResult& point : points) {
      const double sine = std::sin(light) + (positive ? 1 : -1) * point.range * per_range;
      const double turned = std::asin(std::clamp(sine, -1.0, 1.0));
      angles.push_back(std::abs(turned - light));
      errors.push_back(point.range_error * per_range / std::cos(turned));
    }
    out.put("memory_effect_angle", angles, errors, column(points, &PointResult::range_rare));
  }

  void write_traces(const ResultGroup& out, const Points& points, const std::string& group) const {
    std::vector<std::uint64_t> of_point;
    Trace all;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Trace& own = points[i].trace;
      of_point.insert(of_point.end(), own.samples.size(), i);
      for (const auto& [name, part] : trace_columns)
        (all.*part).insert((all.*part).end(), (own.*part).begin(), (own.*part).end());
    }
    write_trace(file_, group, all);
    out.put("trace/of_point", of_point);
  }

  void write_deviation() const {
    std::vector<double> all;
    for (std::size_t i = 0; i < scenes_.size(); ++i) {
      const auto own = deviation(results_[0][i], results_[1][i]);
      all.insert(all.end(), own.begin(), own.end());
    }
    ResultGroup(file_, sweep_table).put("deviation", all);
  }

  ResultFile& file_;
  const CurveSweep& sweep_;
  std::vector<Scene> scenes_;
  const std::vector<Points>& results_;  ///< [method][point]
};

}  // namespace

void write_sweep(ResultFile& file, const CurveSweep& sweep, const CurveResults& results) {
  SweepWriter(file, sweep, results).write();
}

}  // namespace flatspeckle::apps
