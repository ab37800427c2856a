#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/results/estimation.h"
#include "apps/sweep/sweep.h"

namespace flatspeckle::apps {

/// A sweep of memory-effect curves (correlation over tilt) over lists of values of keys. There is
/// one run for each point and each method.
class CurveSweep : public Sweep {
 public:
  CurveSweep();

  SceneSpec base;
  MethodSettings methods;
  std::vector<std::string> method_words;  ///< methods of the runs: mc, wave or transport

  std::size_t runs() const override { return method_words.size() * points_.count(); }
  std::size_t run_of(std::size_t method, std::size_t point) const {
    return method * points_.count() + point;
  }
  Scene scene(std::size_t run) const;
  StopRule stop(std::size_t run) const;

  std::string name(std::size_t run) const override;
  std::optional<std::size_t> find(const std::string& name,
                                  const PointFinder& finder) const override;
  SweepRun open(std::size_t run) const override;
  std::string identity_of_points() const override;
  std::string identity() const override;
  std::size_t finished_points(const PointStore& store) const override;
  void write(ResultFile& file, const PointStore& store) const override;

 private:
  void check() override;
  void check_points();
  void each_run(const std::function<void(std::size_t run, const Keyed<SceneSpec>&)>& use) const;
  void with_point(std::size_t run, const std::function<void(const Keyed<SceneSpec>&)>& use) const;
  Scene scene_of(const Keyed<SceneSpec>& point) const;
  Estimation estimation(std::size_t run, const Scene& scene) const;
  std::size_t point_of(std::size_t run) const { return run % points_.count(); }
  const std::string& method(std::size_t run) const { return method_words[run / points_.count()]; }
  bool has_all_runs(std::size_t point, const PointStore& store) const;

  SweepLists lists_;
  std::string method_ = "auto";
  /// Values of the key q_depths; cleared when base.tilts is computed from it.
  std::vector<double> q_depths_;
  mc::ReversedPaths reversed_ = mc::ReversedPaths::automatic;
  StopRule mc_stop_, wave_stop_;
};

/// Writes the data of a finished run for the journal of the sweep: its curve, its memory-effect
/// range and the trace of its error. The costs are stored separately.
void write_curve(ResultFile& file, const Scene& scene, const FieldJob& job, const RunState& state);

}  // namespace flatspeckle::apps
