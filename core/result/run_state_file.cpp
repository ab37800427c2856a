#include "core/result/run_state_file.h"

#include <cmath>
#include <utility>

#include "core/error.h"

namespace flatspeckle {

namespace {

Trace finite_rows(const Trace& trace) {
  Trace finite;
  for (std::size_t row = 0; row < trace.relative_error.size(); ++row) {
    if (!std::isfinite(trace.relative_error[row])) continue;
    finite.wall_s.push_back(trace.wall_s[row]);
    finite.cpu_s.push_back(trace.cpu_s[row]);
    finite.samples.push_back(trace.samples[row]);
    finite.relative_error.push_back(trace.relative_error[row]);
  }
  return finite;
}

}  // namespace

void write_trace(ResultFile& file, const std::string& group, const Trace& trace) {
  const Trace rows = finite_rows(trace);
  const std::string checkpoint = group + "/checkpoint";
  file.numbered_scale(checkpoint, rows.wall_s.size(), "number of the checkpoint");
  const std::vector<Axis> checkpoints{checkpoint};
  file.dataset(group + "/wall_s", rows.wall_s, checkpoints, "s", "elapsed time");
  file.dataset(group + "/cpu_s", rows.cpu_s, checkpoints, "s", "processor time, all threads");
  file.dataset(group + "/samples", rows.samples, checkpoints, "1", "samples");
  file.dataset(group + "/relative_error", rows.relative_error, checkpoints, "1",
               "RMS standard error relative to the RMS magnitude");
}

Trace read_trace(const ResultReader& file, const std::string& group) {
  Trace trace{file.dataset<double>(group + "/wall_s"), file.dataset<double>(group + "/cpu_s"),
              file.dataset<double>(group + "/samples"),
              file.dataset<double>(group + "/relative_error")};
  const std::size_t rows = trace.wall_s.size();
  if (trace.cpu_s.size() != rows || trace.samples.size() != rows ||
      trace.relative_error.size() != rows)
    throw InputError(file.path().string() + ": " + group + ": columns of different lengths");
  constexpr double most = 1e18;  // an integer holds it
  for (const double samples : trace.samples)
    if (!(samples >= 0 && samples < most))
      throw InputError(file.path().string() + ": " + group + "/samples", samples,
                       "must be a number of samples");
  return trace;
}

void write_state(ResultFile& file, const std::string& group, const RunState& state) {
  const GroupedSums::State sums = state.sums.state();
  const std::size_t groups = sums.samples.size();
  file.attribute(group, "batches", sums.batches);
  file.attribute(group, "wall_s", state.wall_s);
  file.attribute(group, "cpu_s", state.cpu_s);
  file.dataset(group + "/group_samples", sums.samples, {groups}, "1", "samples of each group");
  file.dataset(group + "/group_sums", sums.sums, {groups, state.sums.size()}, "",
               "sums of each group");
  write_trace(file, group + "/trace", state.trace);
}

RunState read_state(const ResultReader& file, const std::string& group, std::size_t size) {
  RunState state{GroupedSums(size), read_trace(file, group + "/trace"),
                 file.attribute<double>(group, "wall_s"), file.attribute<double>(group, "cpu_s")};
  state.sums.restore({file.attribute<std::uint64_t>(group, "batches"),
                      file.dataset<double>(group + "/group_samples"),
                      file.dataset<Complex>(group + "/group_sums")});
  return state;
}

}  // namespace flatspeckle
