#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "apps/command/command_line.h"
#include "apps/experiments/experiment_family.h"
#include "apps/sweep/sweep_share.h"
#include "apps/sweep/varied_points.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

/// A sweep of any subcommand that makes one result, as it was asked for. Each point is a run of it
/// with some keys at other values, and the same seed.
class ExperimentSweep {
 public:
  /// Throws InputError for the name of what cannot be swept.
  explicit ExperimentSweep(const std::string& of);

  Subcommand& command() { return command_; }
  /// Once its keys are filled. False if there is nothing to run (--print-config). Throws InputError
  /// for whatever is wrong; of very many points, only some are looked at in full.
  bool read();
  /// From a resolved configuration, for a result that is made otherwise: by this command line.
  void parse_config(const std::string& config, const std::string& command_line = "");

  /// A run of its own. Throws InputError.
  std::unique_ptr<Experiment> experiment(std::size_t point) const;

  const Session& session() const { return *session_; }
  const std::string& of() const { return of_; }
  const RunSettings& settings() const { return run_; }
  const SweepPoints& points() const { return points_; }
  const SweepShare& share() const { return share_; }
  bool is_share() const { return has_share_; }
  const std::string& out() const { return out_; }
  /// Where the result goes, if not where the scene says.
  void set_out(const std::string& out) { out_ = out; }
  /// The row of the key that an axis sets.
  const Key& key(const SweepAxis& axis) const { return *command_.keys().find(key_of(axis)); }

  /// What all numbers of points depend on but for their names.
  std::string identity_of_points() const;
  /// Of the sweep as a whole.
  std::string identity() const;
  /// A scene file that makes the same sweep.
  std::string config() const { return command_.keys().config(); }

 private:
  void check();
  void check_points();
  std::vector<std::size_t> points_to_check() const;
  std::unique_ptr<Experiment> checked(std::size_t point,
                                      const std::vector<const Keys*>& joined) const;
  void note_given();

  std::string of_, share_text_, out_, inputs_;
  ExperimentFamily family_;
  std::unique_ptr<Experiment> base_;
  RunSettings run_;
  VaryValues vary_;
  SweepPoints points_;
  SweepShare share_;
  bool has_share_ = false;
  Subcommand command_;
  std::optional<Session> session_;
};

}  // namespace flatspeckle::apps
