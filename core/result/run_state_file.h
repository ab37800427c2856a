#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_reader.h"
#include "core/run/runner.h"

namespace flatspeckle {

extern const DatasetTable trace_table, state_table;

/// Writes the trace of a run (its error against run time) into a group, or into the root if `group`
/// is empty. Rows whose error is not finite, because there were too few batches to estimate it, are
/// left out.
void write_trace(ResultFile& file, const std::string& group, const Trace& trace);

/// Reads a trace that write_trace() has written. Throws InputError.
Trace read_trace(const ResultReader& file, const std::string& group);

/// Writes the state from which a run can be resumed: the sums without rounding, the times, and the
/// trace as in write_trace().
void write_state(ResultFile& file, const std::string& group, const RunState& state);

/// Reads a state that write_state() has written. size: number of sums of a batch. Throws InputError
/// if the group does not contain a state, or if the batches of the state have another number of
/// sums.
RunState read_state(const ResultReader& file, const std::string& group, std::size_t size);

/// Converts the state of a run, including all rows of its trace, to bytes that can be stored in a
/// Journal.
std::vector<std::byte> bytes_of(const RunState& state);
/// Converts bytes of bytes_of() back to a state. Throws InputError if the bytes are not a state
/// whose batches have `size` sums.
RunState state_of(std::span<const std::byte> record, std::size_t size);

}  // namespace flatspeckle
