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

/// Finds the index of a point of a sweep from its name. The values of axes that are ranges are not
/// stored in memory.
class PointFinder {
 public:
  /// The points must outlive this object.
  explicit PointFinder(const SweepPoints& points);

  /// Returns the index of the point with this name; nullopt if there is none.
  std::optional<std::size_t> find(const std::string& name) const;

 private:
  using Numbers = std::unordered_map<std::string, std::size_t>;

  std::optional<std::size_t> on_grid(const std::string& name) const;
  std::optional<std::size_t> on_axis(std::size_t axis, const std::string& value) const;

  const SweepPoints& points_;
  /// For points that are the rows of a list: index of each row, by its name.
  Numbers rows_;
  /// For points on a grid: index of each value of each axis, by its text; empty for an axis that is
  /// a range.
  std::vector<Numbers> values_;
};

class PointStore;

/// Part of a sweep: shard `number` of `count` shards, which are run separately.
struct SweepShare {
  std::size_t number = 0, count = 1;
};

/// Parses a shard written as i/n. Throws InputError.
SweepShare share_of(const std::string& text);

/// The runs of a shard in scattered order. The runs finished at any time are then typical, and the
/// remaining time can be predicted from their times.
class ScatteredRuns {
 public:
  explicit ScatteredRuns(std::size_t runs, const SweepShare& share = {});

  std::size_t size() const;
  std::size_t operator[](std::size_t number) const;

 private:
  std::size_t runs_, stride_;
  SweepShare share_;
};

/// Names of the keys that do not affect the results of the runs of a sweep.
inline const std::set<std::string> keys_of_the_work{"threads", "resume", "seconds"};

/// One run of a sweep, for the pool (run_pool()) that computes it.
struct SweepRun {
  std::string plan;  ///< description of the method, for the result file
  BatchJob batches;
  StopRule stop;
  /// Writes the result of the run, except its costs.
  std::function<void(ResultFile&, const RunState&)> write;
};

/// A sweep: runs that differ in the values of some keys (points of the sweep), and one combined
/// result. Derived classes define the runs and how their results are combined.
class Sweep : public Call {
 public:
  Subcommand& command() override { return command_; }
  /// Computes the unfinished runs, on all processes that an MPI launcher has started. Then writes
  /// the result or, if runs are missing, prints how to continue. Throws InputError for invalid
  /// keys.
  int run() override;
  /// Reads the keys from a scene file, given as text, instead of the command line. command_line:
  /// the command that makes the result, for its provenance (merge).
  void parse_config(const std::string& config, const std::string& command_line = "");

  const Session& session() const { return *session_; }
  const RunSettings& settings() const { return run_; }
  const SweepPoints& points() const { return points_; }
  const std::optional<SweepShare>& share() const { return share_; }
  /// Sets the path of the result file; replaces the path given in the scene.
  void set_out(const std::string& out) { run_.out = out; }
  /// Returns a scene file that makes the same sweep.
  std::string config() const { return command_.keys().config(keys_of_the_work); }

  /// Returns the number of runs: one or several for each point.
  virtual std::size_t runs() const { return points_.count(); }
  /// Returns the name of a run. The results of the run depend only on this name and
  /// identity_of_points().
  virtual std::string name(std::size_t run) const { return points_.name(run); }
  /// Returns the index of the run with this name; nullopt if there is none. finder: PointFinder for
  /// the points of this sweep.
  virtual std::optional<std::size_t> find(const std::string& name,
                                          const PointFinder& finder) const {
    return finder.find(name);
  }
  /// Returns the run of this index, ready to be computed. Throws InputError.
  virtual SweepRun open(std::size_t run) const = 0;

  /// Returns a text of all inputs of the runs except the values that their names contain. Runs with
  /// equal texts and equal names have equal results.
  virtual std::string identity_of_points() const = 0;
  /// Returns a text of all inputs of the sweep, including its points. Sweeps with equal texts have
  /// equal results.
  virtual std::string identity() const = 0;

  /// Returns the number of points whose runs are all finished.
  virtual std::size_t finished_points(const PointStore& store) const;
  /// Writes the combined result of all finished points; at least one must be finished.
  virtual void write(ResultFile& file, const PointStore& store) const = 0;

 protected:
  explicit Sweep(const std::string& purpose) : command_("sweep", purpose) {}
  Keys& keys() { return command_.keys(); }
  const Keys& keys() const { return command_.keys(); }
  void add_share_key();
  /// Makes the points of the sweep from the keys, and checks all input. Throws InputError.
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

/// Combines the points of a sweep that are stored in these folders into one result, and returns the
/// exit status. make: function that makes the sweep of a scene file, given as text. partial:
/// whether a result without all points is accepted. Throws InputError.
int merge_sweep(const std::function<std::unique_ptr<Sweep>(const std::string& config)>& make,
                const std::vector<std::string>& folders, const std::string& out, bool partial,
                const std::string& command_line);

/// Returns the folder next to the result file `out` in which the points of a sweep are stored until
/// all are finished.
std::string shards_of(const std::string& out);

}  // namespace flatspeckle::apps
