#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_reader.h"
#include "core/run/runner.h"

namespace flatspeckle {

extern const DatasetTable trace_table, state_table;

/// Into a group (empty: the root). Rows without a finite error (fewer than two groups of batches)
/// are left out.
void write_trace(ResultFile& file, const std::string& group, const Trace& trace);

/// The trace that write_trace wrote. Throws InputError.
Trace read_trace(const ResultReader& file, const std::string& group);

/// A run that can go on: the sums bit for bit, the times, and the trace as write_trace leaves it.
void write_state(ResultFile& file, const std::string& group, const RunState& state);

/// The run that write_state wrote, for batches of `size` sums. Throws InputError if the group is
/// not such a run or is one of another size.
RunState read_state(const ResultReader& file, const std::string& group, std::size_t size);

/// The same as bytes, with the whole trace, for a journal.
std::vector<std::byte> bytes_of(const RunState& state);
/// Throws InputError where the bytes are no run of batches of `size` sums.
RunState state_of(std::span<const std::byte> record, std::size_t size);

}  // namespace flatspeckle
