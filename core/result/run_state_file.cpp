#include "core/result/run_state_file.h"

#include <cmath>
#include <filesystem>
#include <utility>

#include "core/error.h"
#include "core/result/result_group.h"

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

const DatasetTable trace_table{
    "trace",
    {{"trace/checkpoint", Data::numbers, "", "1", "number of the checkpoint"},
     {"trace/wall_s", Data::real, "trace/checkpoint", "s", "elapsed time"},
     {"trace/cpu_s", Data::real, "trace/checkpoint", "s", "processor time, all threads"},
     {"trace/samples", Data::real, "trace/checkpoint", "1", "samples"},
     {"trace/relative_error", Data::real, "trace/checkpoint", "1",
      "RMS standard error relative to the RMS magnitude"}}};

const DatasetTable state_table{
    .name = "state",
    .rows = {{"group_samples", Data::real, "GROUPS", "1", "samples of each group"},
             {"group_sums", Data::complex, "GROUPS SUMS", "", "sums of each group"}},
    .attributes = {{"", "batches", "uint64", "what is done"},
                   {"", "wall_s", "float64", "elapsed time so far"},
                   {"", "cpu_s", "float64", "processor time so far"}},
    .roles = {{"GROUPS", {"no scale"}}, {"SUMS", {"no scale"}}}};

void write_trace(ResultFile& file, const std::string& group, const Trace& trace) {
  const Trace rows = finite_rows(trace);
  const ResultGroup parent(file, trace_table, std::filesystem::path(group).parent_path().string());
  parent.number("trace/checkpoint", rows.wall_s.size());
  parent.put("trace/wall_s", rows.wall_s);
  parent.put("trace/cpu_s", rows.cpu_s);
  parent.put("trace/samples", rows.samples);
  parent.put("trace/relative_error", rows.relative_error);
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
  const ResultGroup out(file, state_table, group);
  out.attribute("batches", sums.batches);
  out.attribute("wall_s", state.wall_s);
  out.attribute("cpu_s", state.cpu_s);
  file.bind("GROUPS", {sums.samples.size()});
  file.bind("SUMS", {state.sums.size()});
  out.put("group_samples", sums.samples);
  out.put("group_sums", sums.sums);
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
