#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flatspeckle::fuzz {

/// A dataset, or an attribute of an object.
struct Stored {
  std::string object, attribute;
};

/// A kind of HDF5 file that the program reads.
struct ResultKind {
  std::function<void(const std::string& path)> write;  ///< writes a small valid file
  std::vector<Stored> stored;  ///< datasets and attributes that the program reads
  /// Reads a file and uses its contents.
  void (*read)(const std::string& path);
  bool is_checksummed = false;  ///< the program reads it only if its checksum is valid
};

/// Returns the kinds: run states, structure factors, grids of index and density.
const std::vector<ResultKind>& result_kinds();

}  // namespace flatspeckle::fuzz
