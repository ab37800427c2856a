#include "flatland/media/index_field.h"

#include <algorithm>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle {

IndexTable::IndexTable(const std::string& path) : path_(path) {
  const Table table = read_key_table("index_table", path, {"wavelength", "index_re", "index_im"});
  const auto wavelength = table.column("wavelength"), real = table.column("index_re"),
             imaginary = table.column("index_im");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!(wavelength[row] > 0) || (row > 0 && wavelength[row] <= wavelength[row - 1]))
      throw InputError("index_table", path, "must have positive, increasing wavelengths");
    index_.emplace_back(real[row], imaginary[row]);
    if (const auto fault = index_fault(index_.back()); !fault.empty())
      throw InputError("index_table", path,
                       "at wavelength " + number_text(wavelength[row]) + ": the index " + fault);
  }
  wavelength_.assign(wavelength.begin(), wavelength.end());
}

Complex IndexTable::at(double wavelength) const {
  if (!(wavelength >= wavelength_.front() && wavelength <= wavelength_.back()))
    throw InputError("index_table", path_,
                     "must cover the wavelength " + number_text(wavelength) +
                         "; the table extends from " + number_text(wavelength_.front()) + " to " +
                         number_text(wavelength_.back()));
  const auto above = std::ranges::upper_bound(wavelength_, wavelength);
  if (above == wavelength_.end()) return index_.back();
  const auto i = static_cast<std::size_t>(above - wavelength_.begin());
  const double share = (wavelength - wavelength_[i - 1]) / (wavelength_[i] - wavelength_[i - 1]);
  return (1 - share) * index_[i - 1] + share * index_[i];
}

std::string IndexField::describe() const {
  switch (kind) {
    case Kind::linear:
      return "n^2 linear";
    case Kind::parabolic:
      return "parabolic guide";
    case Kind::blobs:
      return std::to_string(blobs.size()) + " Gaussian blobs of the index";
    case Kind::ultrasound:
      return "standing sound wave";
    case Kind::grid:
      return "index sampled on a grid";
    case Kind::mean_field:
      return "effective index of the scatterers";
    case Kind::homogeneous:
      break;
  }
  return "homogeneous";
}

}  // namespace flatspeckle
