#pragma once

#include <string>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// The relative index of cylinders at several wavelengths, linear between them.
class IndexTable {
 public:
  /// Reads a CSV with columns wavelength, rising, and index_re, index_im. Throws InputError on
  /// anything missing or malformed, and for an index that no cylinder may have.
  explicit IndexTable(const std::string& path);

  /// Throws InputError for a wavelength beyond the table.
  Complex at(double wavelength) const;

 private:
  std::string path_;
  std::vector<double> wavelength_;
  std::vector<Complex> index_;
};

}  // namespace flatspeckle
