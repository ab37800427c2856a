#include "core/result/run_state_file.h"

#include <cmath>
#include <utility>

#include "core/byte_stream.h"
#include "core/error.h"
#include "core/result/result_group.h"

namespace flatspeckle {

namespace {

/// Returns the trace without the rows whose error is infinite or NaN.
Trace finite_rows(const Trace& trace) {
  Trace finite;
  for (std::size_t row = 0; row < trace.relative_error.size(); ++row)
    if (std::isfinite(trace.relative_error[row]))
      for (const auto& [name, values] : trace_columns)
        (finite.*values).push_back((trace.*values)[row]);
  return finite;
}

}  // namespace

const DatasetTable trace_table{
    "trace",
    {{"trace/checkpoint", Data::numbers, "", "1", "number of the checkpoint"},
     {"trace/wall_s", Data::real, "trace/checkpoint", "s", "elapsed time"},
     {"trace/cpu_s", Data::real, "trace/checkpoint", "s", "processor time, all threads"},
     {"trace/samples", Data::real, "trace/checkpoint", "1", "number of samples"},
     {"trace/relative_error", Data::real, "trace/checkpoint", "1",
      "RMS standard error relative to the RMS magnitude"}}};

const DatasetTable state_table{
    .name = "state",
    .rows = {{"group_samples", Data::real, "GROUPS", "1", "number of samples of each group"},
             {"group_sums", Data::complex, "GROUPS SUMS", "", "sums of each group"}},
    .attributes = {{"", "batches", "uint64", "number of merged batches"},
                   {"", "wall_s", "float64", "elapsed time so far"},
                   {"", "cpu_s", "float64", "processor time so far"}},
    .roles = {{"GROUPS", {"no scale"}}, {"SUMS", {"no scale"}}}};

void write_trace(ResultFile& file, const std::string& group, const Trace& trace) {
  const Trace rows = finite_rows(trace);
  const ResultGroup out(file, trace_table, group);
  out.number("trace/checkpoint", rows.wall_s.size());
  for (const auto& [name, values] : trace_columns)
    out.put("trace/" + std::string(name), rows.*values);
}

Trace read_trace(const ResultReader& file, const std::string& group) {
  const std::string place = group + (group.empty() ? "trace/" : "/trace/");
  Trace trace;
  for (const auto& [name, values] : trace_columns) {
    trace.*values = file.dataset<double>(place + name);
    if ((trace.*values).size() != trace.wall_s.size())
      throw InputError(file.path().string() + ": " + place + ": columns of different lengths");
  }
  constexpr double most = 1e18;  // numbers of samples below this fit into a 64-bit integer
  for (const double samples : trace.samples)
    if (!(samples >= 0 && samples < most))
      throw InputError(file.path().string() + ": " + place + "samples", samples,
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
  write_trace(file, group, state.trace);
}

RunState read_state(const ResultReader& file, const std::string& group, std::size_t size) {
  RunState state{GroupedSums(size), read_trace(file, group),
                 file.attribute<double>(group, "wall_s"), file.attribute<double>(group, "cpu_s")};
  state.sums.restore({file.attribute<std::uint64_t>(group, "batches"),
                      file.dataset<double>(group + "/group_samples"),
                      file.dataset<Complex>(group + "/group_sums")});
  return state;
}

std::vector<std::byte> bytes_of(const RunState& state) {
  const GroupedSums::State sums = state.sums.state();
  ByteWriter bytes;
  bytes.put(sums.batches);
  bytes.put(sums.samples);
  bytes.put(sums.sums);
  for (const auto& [name, values] : trace_columns) bytes.put(state.trace.*values);
  bytes.put(state.wall_s);
  bytes.put(state.cpu_s);
  return bytes.take();
}

RunState state_of(std::span<const std::byte> record, std::size_t size) {
  ByteReader bytes(record);
  RunState state{GroupedSums(size), {}};
  GroupedSums::State sums;
  bytes.get(sums.batches);
  bytes.get(sums.samples);
  bytes.get(sums.sums);
  state.sums.restore(std::move(sums));
  for (const auto& [name, values] : trace_columns) bytes.get(state.trace.*values);
  bytes.get(state.wall_s);
  bytes.get(state.cpu_s);
  bytes.require_end();
  return state;
}

}  // namespace flatspeckle
