#include "apps/sweep_output.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "apps/moments_output.h"
#include "apps/sweep_grid.h"
#include "core/result/run_state_file.h"
#include "mc/theory/diffusion.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::apps {

namespace {

using Axes = std::vector<Axis>;

/// Diffusion theory is that of transmitted light.
bool transmission_only(const CovarianceRequest& request) {
  return std::all_of(request.views.begin(), request.views.end(),
                     [](const View& view) { return std::cos(view.angle) > 0; });
}

Axes with(Axes axes, const std::string& last) {
  axes.emplace_back(last);
  return axes;
}

/// Writes the result of a sweep, over the points that are finished.
class SweepWriter {
 public:
  SweepWriter(ResultFile& file, const SweepPlan& plan, const SweepResults& results)
      : file_(file), plan_(plan), results_(results), points_(finished_points(plan, results)) {
    for (std::size_t point : points_) {
      scenes_.push_back(plan.scene(point));
      if (scenes_.size() > 1) scenes_.back().request = {};  // the same at all points, and large
    }
  }

  void write() {
    write_domain(file_, scenes_.front());
    const bool whole = points_.size() == plan_.points.points.size();
    grid_ = write_sweep_grid(file_, plan_, scenes_, plan_.points.is_list || !whole);
    write_axes(file_, scenes_.front().request);
    write_theory();
    const bool both = plan_.method_words.size() > 1;
    for (std::size_t method = 0; method < plan_.method_words.size(); ++method)
      write_method(method, both ? plan_.method_words[method] + '/' : "");
    if (both) write_deviation();
  }

 private:
  const PointResult& result(std::size_t method, std::size_t i) const {
    return *results_[plan_.run(method, points_[i])];
  }

  std::vector<double> per_point(const std::function<double(const Scene&)>& value) const {
    std::vector<double> values;
    std::transform(scenes_.begin(), scenes_.end(), std::back_inserter(values), value);
    return values;
  }
  std::vector<double> per_point(std::size_t method,
                                const std::function<double(const PointResult&)>& value) const {
    std::vector<double> values;
    for (std::size_t i = 0; i < points_.size(); ++i) values.push_back(value(result(method, i)));
    return values;
  }

  void write_theory() {
    const auto& request = scenes_.front().request;
    const double depth = scenes_.front().domain.depth;
    write_single_scattering(request, depth);
    if (!transmission_only(request)) return;
    std::vector<double> curves;
    for (const Scene& scene : scenes_)
      for (double q : request.tilt_q)
        curves.push_back(mc::diffusion_field_correlation(scene.medium, depth, q));
    file_.dataset("diffusion_theory", curves, with(grid_, "tilt"), "1", "C_E in diffusion theory");
    file_.dataset("diffusion_range", per_point([&](const Scene& scene) {
                    return mc::diffusion_range(scene.medium, depth) * depth;
                  }),
                  grid_, "1", "q L at C_I = 1/2 in diffusion theory");
  }

  void write_single_scattering(const CovarianceRequest& request, double depth) {
    std::vector<double> views, curve;
    for (std::size_t v = 0; v < request.reference_views; ++v)
      views.push_back(request.views[v].angle);
    for (double q : request.tilt_q)
      curve.push_back(
          mc::single_scattering_correlation(request.lights.front().angle, views, depth, q));
    file_.dataset("single_scattering", curve, {"tilt"}, "1",
                  "C_E of single scattering in a slab without attenuation");
    const auto range =
        mc::memory_effect_range(request.tilt_q, std::vector<Complex>(curve.begin(), curve.end()));
    file_.dataset("single_scattering_range", std::vector{range.value * depth}, {}, "1",
                  "q L at C_I = 1/2 by single scattering");
    file_.attribute("single_scattering_range", "censored",
                    static_cast<std::uint64_t>(range.censored));
  }

  void write_method(std::size_t method, const std::string& prefix) {
    write_curves(method, prefix);
    write_ranges(method, prefix);
    write_costs(method, prefix);
    write_traces(method, prefix + "trace");
  }

  void write_curves(std::size_t method, const std::string& prefix) {
    const auto curve = [&](const char* name, auto member, const char* long_name) {
      std::vector<double> values;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const auto& own = result(method, i).*member;
        values.insert(values.end(), own.begin(), own.end());
      }
      file_.dataset(prefix + name, values, with(grid_, "tilt"), "1", long_name);
    };
    curve("field_correlation", &PointResult::correlation, "field correlation C_E");
    curve("field_correlation_error", &PointResult::correlation_error,
          "standard error: field correlation C_E");
  }

  /// One number per point.
  void write_member(std::size_t method, const std::string& name, double PointResult::*member,
                    const char* units, const char* long_name) {
    file_.dataset(name, per_point(method, std::mem_fn(member)), grid_, units, long_name);
  }

  void write_ranges(std::size_t method, const std::string& prefix) {
    write_member(method, prefix + "memory_effect_range", &PointResult::range, "1",
                 "q L at C_I = 1/2");
    write_member(method, prefix + "memory_effect_range_error", &PointResult::range_error, "1",
                 "standard error: q L at C_I = 1/2");
    std::vector<std::uint64_t> censored, steps;
    const Scene& scene = scenes_.front();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const PointResult& point = result(method, i);
      censored.push_back(point.range_censored);
      steps.push_back(steps_below(scene.request.tilt_q, range_in_q(scene, point)));
    }
    file_.dataset(prefix + "range_censored", censored, grid_, "1",
                  "0: range found; 1: C_I stays above 1/2, a lower bound; 2: it is below at the "
                  "first step, an upper bound");
    file_.dataset(prefix + "range_steps", steps, grid_, "1",
                  "tilts between 0 and the range: fewer than 4 are too few to trust its error");
    write_angles(method, prefix);
  }

  void write_costs(std::size_t method, const std::string& prefix) {
    write_member(method, prefix + "relative_error", &PointResult::relative_error, "1",
                 "RMS standard error of the covariances relative to their RMS magnitude");
    write_member(method, prefix + "samples", &PointResult::samples, "1", "samples");
    write_member(method, prefix + "cpu_s", &PointResult::cpu_s, "s", "processor time, all threads");
    write_member(method, prefix + "wall_s", &PointResult::wall_s, "s",
                 "time from the first batch to the last, other points' included");
    if (const auto target = plan_.stop(plan_.run(method, 0)).target_error)
      file_.attribute(prefix.empty() ? "/" : plan_.method_words[method], "target_error", *target);
  }

  /// The ranges as rotations of the light, to the side on which they were read off.
  void write_angles(std::size_t method, const std::string& prefix) {
    const Scene& scene = scenes_.front();
    const auto& q = scene.request.tilt_q;
    const bool positive = std::any_of(q.begin(), q.end(), [](double each) { return each > 0; });
    const double light = scene.request.lights.front().angle;
    const double per_range = 1 / (scene.domain.depth * scene.k);
    std::vector<double> angles, errors;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const PointResult& point = result(method, i);
      const double sine = std::sin(light) + (positive ? 1 : -1) * point.range * per_range;
      const double turned = std::asin(std::clamp(sine, -1.0, 1.0));
      angles.push_back(std::abs(turned - light));
      errors.push_back(point.range_error * per_range / std::cos(turned));
    }
    file_.dataset(prefix + "memory_effect_angle", angles, grid_, "rad",
                  "rotation of the light at C_I = 1/2");
    file_.dataset(prefix + "memory_effect_angle_error", errors, grid_, "rad",
                  "standard error: rotation of the light at C_I = 1/2");
  }

  void write_traces(std::size_t method, const std::string& group) {
    std::vector<std::uint64_t> point;
    Trace all;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Trace& own = result(method, i).trace;
      point.insert(point.end(), own.samples.size(), i);
      for (auto column : {&Trace::wall_s, &Trace::cpu_s, &Trace::samples, &Trace::relative_error})
        (all.*column).insert((all.*column).end(), (own.*column).begin(), (own.*column).end());
    }
    write_trace(file_, group, all);
    file_.dataset(group + "/of_point", point, {group + "/checkpoint"}, "1",
                  "number of the point, in the order of the grid");
  }

  void write_deviation() {
    std::vector<double> all;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto own = deviation(result(0, i), result(1, i));
      all.insert(all.end(), own.begin(), own.end());
    }
    file_.dataset("deviation", all, with(grid_, "tilt"), "1",
                  "mc less wave, in combined standard errors");
  }

  ResultFile& file_;
  const SweepPlan& plan_;
  const SweepResults& results_;
  std::vector<std::size_t> points_;
  std::vector<Scene> scenes_;
  Axes grid_;
};

}  // namespace

std::vector<std::size_t> finished_points(const SweepPlan& plan, const SweepResults& results) {
  std::vector<std::size_t> points;
  for (std::size_t point = 0; point < plan.points.points.size(); ++point) {
    bool all = true;
    for (std::size_t method = 0; method < plan.method_words.size(); ++method)
      all = all && results[plan.run(method, point)];
    if (all) points.push_back(point);
  }
  return points;
}

void write_sweep(ResultFile& file, const SweepPlan& plan, const SweepResults& results) {
  SweepWriter(file, plan, results).write();
}

}  // namespace flatspeckle::apps
