#pragma once

namespace flatspeckle::bench {

/// The text of data/error_references.txt: after lines that start with '#', for each reference a
/// line "name|relative error|how" and a line of "real imaginary" for each entry.
extern const char* const error_reference_table;

}  // namespace flatspeckle::bench
