#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/results/datasets.h"
#include "apps/results/moments_table.h"
#include "apps/sweep/curve_sweep.h"
#include "apps/sweep/point_store.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"
#include "core/result/result_group.h"
#include "core/result/run_state_file.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/slab/refinement.h"
#include "mc/theory/diffusion.h"
#include "mc/theory/memory_effect.h"
#include "mc/theory/moments_datasets.h"

namespace flatspeckle::apps {

const DatasetTable sweep_axes_table{
    "sweep axes",
    {{"density", Data::scale, "", "PER_SPACE", "scatterers per area, in 3D per volume"},
     {"radius", Data::scale, "", "length", "radius of the cylinders or spheres"},
     {"index", Data::scale, "", "1", "relative index, real part"},
     {"optical_depth", Data::scale, "", "1", "optical depth mu_t L"},
     {"g", Data::scale, "", "1", "mean cosine of scattering"},
     {"albedo", Data::scale, "", "1", "single-scattering albedo"},
     {"point", Data::numbers, "", "1", "number of the point"},
     {"swept_point", Data::numbers, "", "1",
      "number of the point, for results that already contain a dataset point (image)"}}};

const DatasetTable sweep_table{
    .name = "sweep",
    .rows = {{"density", Data::real, "GRID", "PER_SPACE", "scatterers per area, in 3D per volume"},
             {"radius", Data::real, "GRID", "length", "radius of the cylinders or spheres"},
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
              "field correlation C_E, averaged over views"},
             {"memory_effect_range", Data::estimate, "GRID", "1",
              "q L at C_I = 1/2 with matched views; L is the depth"},
             {"memory_effect_angle", Data::estimate, "GRID", "rad",
              "rotation of the light at C_I = 1/2"},
             {"beam_angle", Data::estimate, "GRID", "rad",
              "angle between the beams at C_I = 1/2, if it is not that of the rotation"},
             {"range_censored", Data::count, "GRID", "1",
              "0: range found; 1: C_I stays above 1/2, lower bound; 2: C_I is below 1/2 at the "
              "first step, upper bound"},
             {"range_steps", Data::count, "GRID", "1",
              "number of tilts between 0 and the range; with fewer than 4, the error of the range "
              "is unreliable"},
             {"invariants/power", Data::invariant, "GRID", "1",
              "relative difference between the power scattered into all directions and the power "
              "neither transmitted directly nor absorbed; for Monte Carlo, the relative difference "
              "of the power received by scatterers, if that is larger"},
             {"relative_error", Data::real, "GRID", "1",
              "RMS standard error of the covariances relative to their RMS magnitude; 1e300 if "
              "unknown"},
             {"samples", Data::real, "GRID", "1", "number of samples"},
             {"cpu_s", Data::real, "GRID", "s", "processor time, all threads"},
             {"wall_s", Data::real, "GRID", "s",
              "time from the first batch of the point to the last, including time spent on other "
              "points"},
             {"trace/of_point", Data::count, "trace/checkpoint", "1",
              "number of the point, in the order of the grid"},
             {"deviation", Data::real, "GRID tilt", "1",
              "mc minus wave, in combined standard errors"}},
    .attributes = {{"", "format", "uint64",
                    "version of the layout: 2; files without this attribute have an older layout"},
                   {"", "complete", "bool", "whether all points are finished"},
                   {"", "ranks", "int64", "number of processes (MPI)"},
                   {"", "target_error", "float64", "target error of each point, if any"},
                   {"single_scattering_range", "censored", "uint64", mc::censored_meaning}},
    .roles = {{"GRID", {"density radius index optical_depth g albedo", "point"}},
              {"PER_SPACE", {"1/length^2", "1/length^3"}}}};

namespace {

/// Result of a run at one point of a sweep: its correlation curve, its memory-effect range and its
/// costs.
struct PointResult {
  /// Field correlation C_E [tilt] and its standard errors.
  std::vector<double> correlation, correlation_error;
  std::vector<std::uint64_t> correlation_rare;  ///< see Estimate
  double range = 0, range_error = 0;            ///< memory-effect range: q L at which C_I = 1/2
  std::uint64_t range_rare = 0;                 ///< see Estimate
  std::uint64_t range_censored = 0;             ///< value of mc::Range::Censoring
  Invariant power;  ///< invariant of the power balance; its limit is 0 if it is not checked
  Trace trace;      ///< error as a function of run time
  double relative_error = 0, samples = 0, cpu_s = 0, wall_s = 0;
};

/// Indices and results of the points at which the runs of all methods are finished.
struct CurveResults {
  std::vector<std::size_t> points;
  std::vector<std::vector<PointResult>> by_method;  ///< [method][point]
};

/// A quantity that has a value at each point of the sweep, computed from its scene.
struct Quantity {
  std::string name;
  double (*value)(const Scene&);
};

/// Properties of the scatterers. Each is written as an axis of the result if it is swept.
const Quantity settings[] = {
    {"density", [](const Scene& scene) { return scene.medium.density; }},
    {"radius", [](const Scene& scene) { return scene.scatterer.radius; }},
    {"index", [](const Scene& scene) { return scene.scatterer.index.real(); }}};

/// Properties of the bulk medium. Each is written as an axis of the result if it is swept or equal
/// at all points.
const Quantity bulk[] = {
    {"optical_depth", [](const Scene& scene) { return scene.medium.mu_t * scene.domain.depth; }},
    {"g", [](const Scene& scene) { return scene.medium.g; }},
    {"albedo", [](const Scene& scene) { return scene.medium.albedo; }}};

const Quantity small_parameter = {
    "k_mean_free_path", [](const Scene& scene) { return scene.k * scene.medium.mean_free_path(); }};

const Quantity absorbing_index = {"index_imaginary",
                                  [](const Scene& scene) { return scene.scatterer.index.imag(); }};

bool is_constant(const std::vector<double>& values) {
  return std::equal(values.begin() + 1, values.end(), values.begin());
}

/// Returns the (real parts of the) values of a swept key; empty if the key is not swept.
std::vector<double> swept_values(const CurveSweep& sweep, const std::string& key) {
  std::vector<double> values;
  for (const SweepAxis& axis : sweep.points().axes)
    if (axis.key == key)
      for (const std::string& text : axis.values.texts())
        values.push_back(parse_complex(key, text).real());
  return values;
}

/// Writes the axes of a sweep, and other properties of the medium at each point. Sets GRID, which
/// stands for the axes of all datasets with a value at each point, to the axes of the sweep or, if
/// the points are written as a list, to `point`. scenes: scenes of the points to be written.
void write_sweep_grid(ResultFile& file, const CurveSweep& sweep, const std::vector<Scene>& scenes,
                      bool as_list) {
  file.bind("PER_SPACE", {scenes.front().medium.dimension == 3 ? "1/length^3" : "1/length^2"});
  const ResultGroup axes(file, sweep_axes_table), root(file, sweep_table);
  std::vector<Axis> grid;
  std::vector<Quantity> beside{small_parameter};
  if (as_list) {
    axes.number("point", scenes.size());
    grid.emplace_back("point");
  }
  const auto add = [&](const Quantity& quantity, const std::vector<double>& values, bool is_axis) {
    if (as_list || !is_axis) return beside.push_back(quantity);
    axes.put(quantity.name, values);
    grid.emplace_back(quantity.name);
  };
  for (const Quantity& quantity : settings) {
    const auto swept = swept_values(sweep, quantity.name);
    if (swept.size() < 2) continue;
    add(quantity, swept, true);
    const auto absorbing = column(scenes, absorbing_index.value);
    if (quantity.name == "index" && (!is_constant(absorbing) || absorbing.front() != 0))
      beside.push_back(absorbing_index);
  }
  for (const Quantity& quantity : bulk) {
    const auto swept = swept_values(sweep, quantity.name), values = column(scenes, quantity.value);
    add(quantity, swept.empty() ? std::vector{values.front()} : swept,
        !swept.empty() || is_constant(values));
  }
  file.bind("GRID", grid);
  for (const Quantity& quantity : beside) root.put(quantity.name, column(scenes, quantity.value));
}

template <typename Value>
std::vector<Value> kept_list(const FinishedPoint& finished, const std::string& name) {
  const CollectedDataset* const set = finished.result.find(name);
  if (set == nullptr)
    throw InputError(
        "remove the folder of the sweep's points and start again: a stored point lacks the "
        "dataset " +
        name);
  return std::get<std::vector<Value>>(set->values);
}

/// Returns the memory-effect range of a point as a value of q, in which the tilts of the curve are
/// given.
mc::Range range_in_q(const Scene& scene, const PointResult& point) {
  return {point.range / scene.domain.depth, mc::Range::Censoring(point.range_censored)};
}

/// Returns, for each tilt, the difference of the curves of two methods in units of the combined
/// standard error; 0 if both values are exact, as at tilt 0.
std::vector<double> deviation(const PointResult& mc, const PointResult& wave) {
  constexpr double rounding = 1e-12;
  std::vector<double> deviation;
  for (std::size_t t = 0; t < mc.correlation.size(); ++t) {
    const double difference = mc.correlation[t] - wave.correlation[t];
    const double error = std::hypot(mc.correlation_error[t], wave.correlation_error[t]);
    deviation.push_back(error < rounding ? 0 : difference / error);
  }
  return deviation;
}

using Points = std::vector<PointResult>;

/// Returns the curves of all points, one after the other, as one list.
template <typename Value>
std::vector<Value> of_points(const Points& points, std::vector<Value> PointResult::*curve) {
  std::vector<Value> values;
  for (const PointResult& point : points)
    values.insert(values.end(), (point.*curve).begin(), (point.*curve).end());
  return values;
}

/// Writes the combined result of all finished points of a sweep.
class SweepWriter {
 public:
  SweepWriter(ResultFile& file, const CurveSweep& sweep, const CurveResults& results)
      : file_(file), sweep_(sweep), results_(results.by_method) {
    for (std::size_t point : results.points) {
      scenes_.push_back(sweep.scene(point));
      // removed to save memory; the request is equal at all points
      if (scenes_.size() > 1) scenes_.back().request = {};
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
    if (!request.transmission_only() || scenes_.front().profile) return;
    write_single_scattering(root, request, depth);
    std::vector<double> curves;
    for (const Scene& scene : scenes_)
      for (double q : request.tilt_q) curves.push_back(mc::diffusion_field_correlation(scene, q));
    root.put("diffusion_theory", curves);
    root.put("diffusion_range", column(scenes_, [&](const Scene& scene) {
               return mc::diffusion_range(scene) * depth;
             }));
  }

  static void write_single_scattering(const ResultGroup& root, const CovarianceRequest& request,
                                      double depth) {
    const std::vector<View> views(
        request.views.begin(), request.views.begin() + static_cast<long>(request.reference_views));
    const auto curve = column(request.tilt_q, [&](double q) {
      return mc::single_scattering_correlation(request.lights.front(), views, depth, q,
                                               request.tilt_azimuth);
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
    write_power(out, points);
    out.put("relative_error", column(points, &PointResult::relative_error));
    out.put("samples", column(points, &PointResult::samples));
    out.put("cpu_s", column(points, &PointResult::cpu_s));
    out.put("wall_s", column(points, &PointResult::wall_s));
    if (const auto target = sweep_.stop(sweep_.run_of(method, 0)).target_error)
      out.attribute("target_error", *target);
    if (sweep_.method_words[method] == "transport") mc::write_numerical(file_, group);
    write_traces(out, points, group);
  }

  static void write_power(const ResultGroup& out, const Points& points) {
    std::vector<Invariant> power;
    for (const PointResult& point : points) power.push_back(point.power);
    const auto is_checked = [](const Invariant& each) { return each.limit > 0; };
    if (std::ranges::any_of(power, is_checked)) out.check("invariants/power", power);
  }

  /// Writes the memory-effect ranges as angles by which the light is rotated, in the direction of
  /// the tilts, and as angles between the beams if they differ.
  void write_angles(const ResultGroup& out, const Points& points) const {
    const Scene& scene = scenes_.front();
    const double depth = scene.domain.depth;
    Estimate rotation, between;
    for (const PointResult& point : points) {
      const auto tilt = mc::tilt_of_range(scene.request, scene.outside_k(), point.range / depth);
      const auto add = [&](Estimate& to, double value, double per_q) {
        to.value.emplace_back(value);
        to.error.push_back(per_q * point.range_error / depth);
        to.rare.push_back(point.range_rare);
      };
      add(rotation, tilt.rotation, tilt.rotation_per_q);
      add(between, tilt.between, tilt.between_per_q);
    }
    out.put("memory_effect_angle", rotation);
    if (mc::is_tilted_aside(scene.request)) out.put("beam_angle", between);
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

class SweepTable {
 public:
  SweepTable(const CurveSweep& sweep, const CurveResults& results)
      : sweep_(sweep), results_(results), scene_(sweep.scene(results.points.front())) {}

  void print() const {
    note_few();
    if (results_.points.size() > most_rows) return;
    print_header();
    for (std::size_t i = 0; i < results_.points.size(); ++i) print_row(i);
  }

 private:
  bool both() const { return sweep_.method_words.size() > 1; }
  bool is_rough(const PointResult& result) const {
    return mc::few_steps(scene_.request.tilt_q, range_in_q(scene_, result));
  }

  void note_few() const {
    std::size_t few = 0, all = 0;
    for (const auto& points : results_.by_method) {
      all += points.size();
      few += static_cast<std::size_t>(
          std::ranges::count_if(points, [&](const PointResult& own) { return is_rough(own); }));
    }
    if (few > 0)
      std::fprintf(stderr,
                   "note: %zu of %zu ranges (marked *) are interpolated with fewer than four tilts "
                   "below them; their errors exclude the interpolation error: add tilts\n",
                   few, all);
  }

  void print_header() const {
    for (const SweepAxis& axis : sweep_.points().axes)
      if (axis.values.size() > 1) std::printf("%13s ", axis.key.c_str());
    for (const std::string& method : sweep_.method_words)
      std::printf(" %-24s", both() ? ("range q L, " + method).c_str() : "range q L at C_I = 1/2");
    std::puts(both() ? " deviation of C_E, RMS in standard errors" : "");
  }

  void print_row(std::size_t number) const {
    const SweepPoints& points = sweep_.points();
    for (std::size_t i = 0; i < points.axes.size(); ++i)
      if (points.axes[i].values.size() > 1)
        std::printf("%13s ", points.value(i, results_.points[number]).c_str());
    for (const auto& of_method : results_.by_method) {
      const PointResult& own = of_method[number];
      const std::string text =
          range_text({own.range, mc::Range::Censoring(own.range_censored)}, own.range_error) +
          (is_rough(own) ? " *" : "");
      std::printf(both() ? " %-24s" : " %s", text.c_str());
    }
    if (both()) std::printf(" %.2f", rms_deviation(number));
    std::puts("");
  }

  /// Returns the RMS over all tilts of the deviation between both methods at a point. Tilt 0, at
  /// which both curves are 1, is left out.
  double rms_deviation(std::size_t number) const {
    double sum = 0, count = 0;
    const auto& curves = results_.by_method;
    for (double each : deviation(curves[0][number], curves[1][number])) {
      sum += each * each;
      count += each == 0 ? 0 : 1;
    }
    return count > 0 ? std::sqrt(sum / count) : 0;
  }

  const CurveSweep& sweep_;
  const CurveResults& results_;
  Scene scene_;
};

PointResult curve_of(const FinishedPoint& finished) {
  const auto numbers = [&](const std::string& name) { return kept_list<double>(finished, name); };
  const auto counts = [&](const char* name) { return kept_list<std::uint64_t>(finished, name); };
  const auto range = numbers("memory_effect_range");
  const auto marks = counts("range_marks");
  PointResult point{.correlation = numbers("field_correlation"),
                    .correlation_error = numbers("field_correlation_error"),
                    .correlation_rare = counts("field_correlation_rare"),
                    .range = range.at(0),
                    .range_error = range.at(1),
                    .range_rare = marks.at(0),
                    .range_censored = marks.at(1),
                    .power = {},
                    .trace = {},
                    .relative_error = finished.relative_error,
                    .samples = finished.samples,
                    .cpu_s = finished.cpu_s,
                    .wall_s = finished.wall_s};
  // the stored list is empty if no value is undersampled
  point.correlation_rare.resize(point.correlation.size());
  for (const auto& [name, values] : trace_columns)
    point.trace.*values = numbers(std::string("trace/") + name);
  for (const std::string name : {"invariants/power", "invariants/path_power"}) {
    if (finished.result.find(name) == nullptr) continue;
    const Invariant found{numbers(name).front(), numbers(name + "_limit").front()};
    if (!(point.power.limit > 0) || found.is_worse_than(point.power)) point.power = found;
  }
  return point;
}

}  // namespace

/// The dataset names are those of the final result, except that range and error of the range are
/// stored together in one dataset, and its marks `rare` and `censored` in another.
void write_curve(ResultFile& file, const Scene& scene, const FieldJob& job, const RunState& state) {
  const auto effect = mc::memory_effect(scene.request, state.sums, job.covariance);
  const auto& [found, error, rare] = effect.range;
  const double depth = scene.domain.depth;
  const auto put = [&]<typename Value>(const char* name, const std::vector<Value>& values) {
    file.dataset(name, std::span(values), {values.size()}, "", "");
  };
  put("field_correlation", effect.correlation);
  put("field_correlation_error", effect.correlation_error);
  put("field_correlation_rare", effect.correlation_rare);
  put("memory_effect_range", std::vector{found.value * depth, error * depth});
  put("range_marks", std::vector{rare, static_cast<std::uint64_t>(found.censored)});
  write_trace(file, "", state.trace);
}

void CurveSweep::write(ResultFile& file, const PointStore& store) const {
  CurveResults results{{}, std::vector<std::vector<PointResult>>(method_words.size())};
  for (std::size_t point = 0; point < points_.count(); ++point)
    if (has_all_runs(point, store)) results.points.push_back(point);
  store.for_each([&](std::size_t run, const FinishedPoint& finished) {
    if (has_all_runs(point_of(run), store))
      results.by_method[run / points_.count()].push_back(curve_of(finished));
  });
  SweepTable(*this, results).print();
  ResultGroup(file, sweep_table).attribute("format", std::uint64_t{2});
  SweepWriter(file, *this, results).write();
}

}  // namespace flatspeckle::apps
