#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "mc/paths/speckle/camera_sides.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// Sums the far fields of ends of paths over the pixels of a camera, for many lights at once: a
/// product of the matrix of the ends' factors under each light with that of their fields in each
/// pixel. For many lights this is faster than CameraSum, and the medium may vary or have faces.
class CameraProducts {
 public:
  /// lights, changes: each end has `lights` factors after each of the changes (each_end()).
  CameraProducts(const PathWalks& walks, const FarCamera& camera, std::size_t lights,
                 std::size_t changes);

  /// Adds an end after a change. factors: those of all lights. out: fields [change][light][pixel].
  void add(const PathEnd& end, std::span<const Complex> factors, std::size_t change,
           std::span<Complex> out);
  /// Adds the ends that wait.
  void finish(std::span<Complex> out);

 private:
  /// Ends that wait to be added together.
  struct Block {
    std::size_t ends = 0;
    std::vector<Complex> factors, pixels;  ///< [end][light] and [end][pixel]
  };
  void flush(std::size_t change, std::span<Complex> out);

  EndpointFactors& pixels(int wave);

  const PathWalks& walks_;
  std::vector<Endpoint> endpoints_;
  /// Factors of the pixels for each number of reflections at faces, as far as needed.
  std::vector<std::unique_ptr<EndpointFactors>> pixels_;
  std::size_t lights_;
  std::vector<Block> blocks_;  ///< of each change
};

}  // namespace flatspeckle::mc
