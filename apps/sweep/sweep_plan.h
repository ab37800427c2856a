#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/command/command_line.h"
#include "apps/results/estimation.h"
#include "apps/sweep/sweep_points.h"
#include "apps/sweep/sweep_share.h"
#include "apps/sweep/varied_points.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

/// Keys that change no number of any run of a sweep.
inline const std::set<std::string> keys_of_the_work{"threads", "resume", "seconds"};

/// A sweep as it was asked for. Its runs are its points by each of its methods.
class SweepPlan {
 public:
  SweepPlan();

  Subcommand& command() { return command_; }
  /// Once its keys are filled. False if there is nothing to run (--print-config). Throws InputError
  /// for whatever is wrong, with any of the points too.
  bool read();
  /// From a resolved configuration, for a result that is made otherwise: by this command line.
  void parse_config(const std::string& config, const std::string& command_line = "");

  SceneSpec base;
  RunSettings settings;
  MethodSettings methods;
  SweepPoints points;
  std::vector<std::string> method_words;  ///< of mc, wave, transport
  std::optional<SweepShare> share;

  const Session& session() const { return *session_; }
  std::size_t runs() const { return method_words.size() * points.count(); }
  std::size_t run(std::size_t method, std::size_t point) const {
    return method * points.count() + point;
  }
  std::size_t point_of(std::size_t run) const { return run % points.count(); }
  const std::string& method(std::size_t run) const { return method_words[run / points.count()]; }
  Scene scene(std::size_t run) const;
  Estimation estimation(std::size_t run, const Scene& scene) const;
  StopRule stop(std::size_t run) const;
  /// A name for the files of a run, and all that its numbers depend on: equal texts, equal numbers.
  std::string name(std::size_t run) const;
  std::string identity(std::size_t run) const;
  /// Of the sweep as a whole.
  std::string identity() const;

 private:
  void check();
  void check_points();
  void each_run(const std::function<void(std::size_t run, const Keyed<SceneSpec>&)>& use) const;
  void with_point(std::size_t run, const std::function<void(const Keyed<SceneSpec>&)>& use) const;
  Scene scene_of(const Keyed<SceneSpec>& point) const;

  SweepLists lists_;
  std::string method_ = "auto", share_, of_;
  VaryValues vary_;               ///< of another subcommand (sweep_experiments.h)
  std::vector<double> q_depths_;  ///< empty once the tilts are made of it
  mc::ReversedPaths reversed_ = mc::ReversedPaths::automatic;
  StopRule mc_stop_, wave_stop_;
  Subcommand command_;
  std::optional<Session> session_;
};

}  // namespace flatspeckle::apps
