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
  std::function<void(const std::string& path)> write;  ///< a small valid one
  std::vector<Stored> stored;                          ///< what it reads of it
  /// Reads one and goes on with what it holds for a while.
  void (*read)(const std::string& path);
  bool is_sealed = false;  ///< the program reads it only where its seal holds
};

/// Run states, structure factors, grids of the index and of the density.
const std::vector<ResultKind>& result_kinds();

}  // namespace flatspeckle::fuzz
