#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "apps/command/subcommands.h"
#include "apps/sweep/sweep_points.h"
#include "core/result/result_file.h"
#include "core/run/runner.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

/// The numbers of points by their names. Of ranges it holds nothing.
class PointFinder {
 public:
  /// The points must live as long.
  explicit PointFinder(const SweepPoints& points);

  /// Nothing of a name that is no point's.
  std::optional<std::size_t> find(const std::string& name) const;

 private:
  using Numbers = std::unordered_map<std::string, std::size_t>;

  std::optional<std::size_t> on_grid(const std::string& name) const;
  std::optional<std::size_t> on_axis(std::size_t axis, const std::string& value) const;

  const SweepPoints& points_;
  Numbers rows_;                 ///< of a list, by their names
  std::vector<Numbers> values_;  ///< of each axis of a grid; none of a range
};

class PointStore;

/// Part `number` of `count` parts of a sweep that run apart.
struct SweepShare {
  std::size_t number = 0, count = 1;
};

/// Of i/n. Throws InputError.
SweepShare share_of(const std::string& text);

/// The share's runs of so many, scattered over all, so that what has been done at any time says
/// something about what is left.
class ScatteredRuns {
 public:
  explicit ScatteredRuns(std::size_t runs, const SweepShare& share = {});

  std::size_t size() const;
  std::size_t operator[](std::size_t number) const;

 private:
  std::size_t runs_, stride_;
  SweepShare share_;
};

/// Keys that change no number of any run of a sweep.
inline const std::set<std::string> keys_of_the_work{"threads", "resume", "seconds"};

/// One run of a sweep, which a pool works on.
struct SweepRun {
  std::string plan;  ///< how the numbers are found
  BatchJob batches;
  StopRule stop;
  /// The datasets of its result, all but what it cost.
  std::function<void(ResultFile&, const RunState&)> write;
};

/// A sweep as it was asked for: runs that depend on the values of their points alone, and the one
/// result that they make. Kinds of sweeps say what a run is and how results stand together.
class Sweep : public Call {
 public:
  Subcommand& command() override { return command_; }
  /// Runs what is not yet there, by all processes that a launcher has started together, and ends in
  /// the result, or says how to go on. Throws InputError for whatever is wrong with the keys.
  int run() override;
  /// From a resolved configuration, for a result that is made otherwise: by this command line.
  void parse_config(const std::string& config, const std::string& command_line = "");

  const Session& session() const { return *session_; }
  const RunSettings& settings() const { return run_; }
  const SweepPoints& points() const { return points_; }
  const std::optional<SweepShare>& share() const { return share_; }
  /// Where the result goes, if not where the scene says.
  void set_out(const std::string& out) { run_.out = out; }
  /// A scene file that makes the same sweep.
  std::string config() const { return command_.keys().config(keys_of_the_work); }

  /// One for each point, or several.
  virtual std::size_t runs() const { return points_.count(); }
  /// The name of a run, which with identity_of_points() is all that its numbers depend on.
  virtual std::string name(std::size_t run) const { return points_.name(run); }
  /// The run of this name. finder: of the sweep's points.
  virtual std::optional<std::size_t> find(const std::string& name,
                                          const PointFinder& finder) const {
    return finder.find(name);
  }
  /// Throws InputError.
  virtual SweepRun open(std::size_t run) const = 0;

  /// What the numbers of all runs depend on but for their names: equal texts, equal numbers.
  virtual std::string identity_of_points() const = 0;
  /// Of the sweep as a whole.
  virtual std::string identity() const = 0;

  /// How many points have all their runs.
  virtual std::size_t finished_points(const PointStore& store) const;
  /// The result of the finished points, of which there is one at least.
  virtual void write(ResultFile& file, const PointStore& store) const = 0;

 protected:
  explicit Sweep(const std::string& purpose) : command_("sweep", purpose) {}
  Keys& keys() { return command_.keys(); }
  const Keys& keys() const { return command_.keys(); }
  void add_share_key();
  /// Makes the points of the keys, and refuses all that can be refused. Throws InputError.
  virtual void check() = 0;

  std::string of_;
  RunSettings run_;
  VaryValues vary_;
  SweepPoints points_;

 private:
  void take_points();
  bool read();

  std::string share_text_;
  std::optional<SweepShare> share_;
  Subcommand command_;
  std::optional<Session> session_;
};

/// Puts together what folders hold of a sweep. make: the kind of sweep that a configuration is of.
/// partial: also where points are missing. Returns the exit status. Throws InputError.
int merge_sweep(const std::function<std::unique_ptr<Sweep>(const std::string& config)>& make,
                const std::vector<std::string>& folders, const std::string& out, bool partial,
                const std::string& command_line);

/// The folder beside a sweep's result in which its points gather until all are there.
std::string shards_of(const std::string& out);

}  // namespace flatspeckle::apps
