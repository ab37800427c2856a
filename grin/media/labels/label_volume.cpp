#include "grin/media/labels/label_volume.h"

#include <cstring>
#include <span>
#include <string>

#include "core/error.h"
#include "core/keys/table_text.h"
#include "grin/media/index/sample_grid.h"
#include "grin/media/labels/mcx_shapes.h"

namespace flatspeckle::grin {

namespace {

/// Returns a label. Throws InputError for a number that is not a label.
std::uint16_t label_of(double value) {
  if (!(value >= 0 && value < LabelVolume::most_labels && value == std::floor(value)))
    throw InputError(
        "label", value,
        "must be a whole number from 0 to " + std::to_string(LabelVolume::most_labels - 1));
  return static_cast<std::uint16_t>(value);
}

LabelVolume read_hdf5(const std::filesystem::path& path) {
  const GridSamples samples = read_samples(path, "labels");
  LabelVolume volume{samples.where.origin, samples.where.spacing, samples.where.nodes};
  volume.labels.reserve(samples.values.size());
  for (const double value : samples.values) volume.labels.push_back(label_of(value));
  return volume;
}

/// The bytes of a NIfTI-1 file; all numbers are little endian.
class NiftiFile {
 public:
  explicit NiftiFile(const std::filesystem::path& path) : bytes_(file_bytes(path)) {
    if (bytes_.size() >= 2 && bytes_[0] == '\x1f' && bytes_[1] == '\x8b')
      throw InputError("is compressed: unpack it with gunzip");
    constexpr std::size_t header = 348;
    if (bytes_.size() < header || number<std::int32_t>(0) != header ||
        std::memcmp(&bytes_[344], "n+1", 4) != 0)
      throw InputError("is not a NIfTI-1 file in one part (.nii, little endian)");
  }

  LabelVolume volume() const {
    const auto axes = number<std::int16_t>(dim);
    LabelVolume volume;
    for (int axis = 0; axis < 7; ++axis) {
      const int count = axis < axes ? number<std::int16_t>(dim + 2 * (axis + 1)) : 1;
      if (axis >= 3 && count != 1)
        throw InputError("dim[" + std::to_string(axis + 1) + "]", count,
                         "must be 1: labels have three axes");
      if (axis < 3) volume.voxels[axis] = count;
      if (axis < 3) volume.spacing[axis] = std::abs(number<float>(pixdim + 4 * (axis + 1)));
    }
    check(volume);
    switch (number<std::int16_t>(datatype)) {
      case 2:
        read<std::uint8_t>(volume);
        break;
      case 4:
        read<std::int16_t>(volume);
        break;
      case 256:
        read<std::int8_t>(volume);
        break;
      case 512:
        read<std::uint16_t>(volume);
        break;
      default:
        throw InputError("datatype", number<std::int16_t>(datatype),
                         "must be 2, 4, 256 or 512: whole numbers of 8 or 16 bits");
    }
    return volume;
  }

 private:
  // Positions of the members of the header.
  static constexpr std::size_t dim = 40, datatype = 70, pixdim = 76, vox_offset = 108;

  template <class Number>
  Number number(std::size_t at) const {
    Number found;
    std::memcpy(&found, &bytes_[at], sizeof found);
    return found;
  }
  /// Reads the labels, of which those along x are neighbours in the file.
  template <class Number>
  void read(LabelVolume& volume) const {
    const auto [nx, ny, nz] = volume.voxels;
    const std::size_t count = static_cast<std::size_t>(nx) * ny * nz;
    const double first = number<float>(vox_offset);
    if (!(first >= 348 && first + static_cast<double>(count * sizeof(Number)) <=
                              static_cast<double>(bytes_.size())))
      throw InputError("is shorter than its header states");
    volume.labels.resize(count);
    auto at = static_cast<std::size_t>(first);
    for (int k = 0; k < nz; ++k)
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i, at += sizeof(Number))
          volume.labels[volume.number(i, j, k)] = label_of(number<Number>(at));
  }

  std::string bytes_;
};

}  // namespace

void check(const LabelVolume& volume) {
  double count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (volume.voxels[axis] < 1)
      throw InputError("voxels along an axis", volume.voxels[axis], "must be at least 1");
    if (!(volume.spacing[axis] > 0 && std::isfinite(volume.spacing[axis])))
      throw InputError("spacing of voxels", volume.spacing[axis], "must be positive");
    count *= volume.voxels[axis];
  }
  if (count > LabelVolume::most_voxels) throw InputError("voxels", count, "must be at most 2^30");
}

LabelVolume read_nifti(const std::filesystem::path& path) {
  return NiftiFile(path).volume();
}

LabelVolume read_labels(const std::filesystem::path& path) {
  const auto kind = path.extension();
  const LabelVolume volume = kind == ".json"                   ? read_mcx_shapes(path)
                             : kind == ".nii" || kind == ".gz" ? read_nifti(path)
                                                               : read_hdf5(path);
  check(volume);
  return volume;
}

}  // namespace flatspeckle::grin
