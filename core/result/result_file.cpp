#include "core/result/result_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <functional>
#include <new>
#include <numeric>
#include <stdexcept>
#include <type_traits>
#include <unistd.h>
#include <utility>

#include <hdf5_hl.h>

#include "core/error.h"
#include "core/result/collected_result.h"
#include "core/result/guarded_read.h"
#include "core/result/hdf5_handle.h"

namespace flatspeckle {

namespace {

/// Overload set of functions, for std::visit of a variant.
template <typename... Functions>
struct Either : Functions... {
  using Functions::operator()...;
};
template <typename... Functions>
Either(Functions...) -> Either<Functions...>;

std::size_t product(const std::vector<hsize_t>& extents) {
  return std::accumulate(extents.begin(), extents.end(), std::size_t{1}, std::multiplies<>());
}

/// Values in the memory layout that HDF5 requires: contiguous numbers, or contiguous pointers to
/// texts.
struct Raw {
  Hdf5Handle type;
  std::size_t count, value_bytes;
  const void* first;
  bool are_texts = false;
  std::vector<const char*> texts = {};
};

/// Converts numbers to Raw. Throws std::logic_error, which contains `name`, if a number is not
/// finite.
template <typename Number>
Raw raw(const std::string& name, std::span<const Number> numbers) {
  if (!all_finite(numbers)) throw std::logic_error(name + ": a value is not finite");
  return {hdf5_type<Number>(), numbers.size(), sizeof(Number), numbers.data()};
}
Raw raw(const std::string&, std::span<const std::string> texts) {
  Raw raw{hdf5_type<std::string>(), texts.size(), sizeof(const char*), nullptr, true};
  for (const std::string& text : texts) raw.texts.push_back(text.c_str());
  raw.first = raw.texts.data();
  return raw;
}

Raw raw(const std::string& name, const Values& values) {
  return std::visit([&](const auto& given) { return raw(name, given); }, values);
}

/// Returns the shape of the chunks for a dataset of this shape. The longest axis is halved until a
/// chunk has at most 1 MiB.
std::vector<hsize_t> chunk_shape(std::vector<hsize_t> shape, std::size_t value_bytes) {
  constexpr hsize_t most_bytes = hsize_t{1} << 20;
  while (value_bytes * product(shape) > most_bytes) {
    hsize_t& longest = *std::max_element(shape.begin(), shape.end());
    longest = (longest + 1) / 2;
  }
  return shape;
}

/// Writes one dataset or attribute, `name`, into the HDF5 file of a ResultFile.
class Writer {
 public:
  Writer(const Hdf5Handle* file, const std::string& path, const std::string& name)
      : name_(name), call_("writing " + name + " into " + path + " failed") {
    if (file == nullptr) throw std::logic_error(name + ": written after the file was finished");
    file_ = file->get();
  }

  void group() const {
    if (exists(file_, name_)) return;
    const Hdf5Handle links = intermediate_groups();
    call_.handle(H5Gcreate2(file_, name_.c_str(), links.get(), H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  }

  void attribute(const std::string& attribute, const Attribute& value) const {
    group();
    const Hdf5Handle object = call_.handle(H5Oopen(file_, name_.c_str(), H5P_DEFAULT), H5Oclose);
    if (call_.check(H5Aexists(object.get(), attribute.c_str())) > 0)
      throw std::logic_error(name_ + ": attribute " + attribute + " is written twice");
    const auto list = [&]<typename Item>(const std::vector<Item>& items) {
      write(object.get(), attribute, std::span<const Item>(items), {items.size()});
    };
    const auto scalar = [&]<typename Item>(const Item& item) {
      write(object.get(), attribute, std::span<const Item>(&item, 1), {});
    };
    std::visit(Either{list, scalar}, value);
  }

  /// Creates a dataset for values of the type of `none`, without writing values.
  void begin(const Raw& none, const std::vector<Axis>& axes,
             const std::vector<std::size_t>& chunk) const {
    const auto shape = shape_of(axes);
    attach(create(none.type, shape, storage(none, shape, chunk)), axes);
  }

  void begin_scale(const Raw& none, std::size_t count, std::size_t chunk) const {
    make_scale(create(none.type, {count}, storage(none, {count}, {chunk})));
  }

  /// Writes a block of values of the dataset. The dataset is opened and closed for each block, so
  /// that HDF5 does not keep chunks in its cache, which it could no longer write if the disk became
  /// full.
  void block(const Raw& block, const std::vector<std::size_t>& start,
             const std::vector<std::size_t>& count) const {
    const Hdf5Handle set = call_.handle(H5Dopen2(file_, name_.c_str(), H5P_DEFAULT), H5Dclose);
    const Hdf5Handle there = call_.handle(H5Dget_space(set.get()), H5Sclose);
    std::vector<hsize_t> from(start.begin(), start.end()), extents = extents_of(there);
    from.resize(extents.size());
    std::ranges::copy(count, extents.begin());
    const Hdf5Handle here = call_.handle(dataspace(extents), H5Sclose);
    if (product(extents) != block.count)
      throw std::logic_error(name_ + ": the number of values does not fit the block");
    if (!extents.empty())
      call_.check(H5Sselect_hyperslab(there.get(), H5S_SELECT_SET, from.data(), nullptr,
                                      extents.data(), nullptr));
    call_.check(
        H5Dwrite(set.get(), block.type.get(), here.get(), there.get(), H5P_DEFAULT, block.first));
    call_.check(H5Dflush(set.get()));
  }

  /// Creates and writes a dataset. Throws std::logic_error if the dataset exists.
  Hdf5Handle values(const Raw& raw, const std::vector<hsize_t>& shape) const {
    if (product(shape) != raw.count)
      throw std::logic_error(name_ + ": the number of values does not fit the axes");
    Hdf5Handle set = create(raw.type, shape, storage(raw, shape, {}));
    call_.check(H5Dwrite(set.get(), raw.type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, raw.first));
    return set;
  }

  /// Writes a dataset and attaches the dimension scales of its axes.
  void dataset(const Raw& raw, const std::vector<Axis>& axes) const {
    attach(values(raw, shape_of(axes)), axes);
  }

  void scale(std::span<const double> numbers) const {
    make_scale(values(raw(name_, numbers), {numbers.size()}));
  }

  void describe(const std::string& units, const std::string& long_name) const {
    if (!units.empty()) attribute("units", units);
    if (!long_name.empty()) attribute("long_name", long_name);
  }

 private:
  static std::string last_part(const std::string& name) {
    return name.substr(name.find_last_of('/') + 1);
  }

  static hid_t dataspace(const std::vector<hsize_t>& shape) {
    return shape.empty() ? H5Screate(H5S_SCALAR)
                         : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  }

  Hdf5Handle create(const Hdf5Handle& type, const std::vector<hsize_t>& shape,
                    const Hdf5Handle& layout) const {
    if (exists(file_, name_)) throw std::logic_error(name_ + ": written twice");
    const Hdf5Handle space = call_.handle(dataspace(shape), H5Sclose);
    const Hdf5Handle links = intermediate_groups();
    return call_.handle(H5Dcreate2(file_, name_.c_str(), type.get(), space.get(), links.get(),
                                   layout.get(), H5P_DEFAULT),
                        H5Dclose);
  }

  Hdf5Handle intermediate_groups() const {
    Hdf5Handle links = call_.handle(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    call_.check(H5Pset_create_intermediate_group(links.get(), 1));
    return links;
  }

  /// Returns the storage layout of a dataset. Only large datasets of numbers are compressed: HDF5
  /// stores texts separately from the dataset, where compression has no effect on them.
  Hdf5Handle storage(const Raw& raw, std::vector<hsize_t> shape,
                     const std::vector<std::size_t>& chunk) const {
    constexpr std::size_t small = 4096;
    if (raw.are_texts || product(shape) * raw.value_bytes <= small) return untimed();
    for (std::size_t i = 0; i < chunk.size(); ++i) shape[i] = std::min<hsize_t>(shape[i], chunk[i]);
    return compressed(chunk_shape(shape, raw.value_bytes));
  }

  /// Returns a storage layout without time stamps, so that equal results give equal files.
  Hdf5Handle untimed() const {
    Hdf5Handle layout = call_.handle(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    call_.check(H5Pset_obj_track_times(layout.get(), false));
    return layout;
  }

  Hdf5Handle compressed(const std::vector<hsize_t>& chunk) const {
    Hdf5Handle layout = untimed();
    call_.check(H5Pset_chunk(layout.get(), static_cast<int>(chunk.size()), chunk.data()));
    call_.check(H5Pset_shuffle(layout.get()));
    call_.check(H5Pset_deflate(layout.get(), 1));
    call_.check(H5Pset_fletcher32(layout.get()));
    return layout;
  }

  Hdf5Handle open_scale(const std::string& scale) const {
    if (!exists(file_, scale)) throw std::logic_error(name_ + ": no scale \"" + scale + "\"");
    return call_.handle(H5Dopen2(file_, scale.c_str(), H5P_DEFAULT), H5Dclose);
  }

  std::vector<hsize_t> shape_of(const std::vector<Axis>& axes) const {
    std::vector<hsize_t> shape;
    for (const Axis& axis : axes) shape.push_back(extent(axis));
    return shape;
  }

  std::vector<hsize_t> extents_of(const Hdf5Handle& space) const {
    std::vector<hsize_t> extents(
        static_cast<std::size_t>(call_.check(H5Sget_simple_extent_ndims(space.get()))));
    if (!extents.empty())
      call_.check(H5Sget_simple_extent_dims(space.get(), extents.data(), nullptr));
    return extents;
  }

  hsize_t extent(const Axis& axis) const {
    if (const auto* plain = std::get_if<std::size_t>(&axis)) return *plain;
    const Hdf5Handle scale = open_scale(std::get<std::string>(axis));
    const Hdf5Handle space = call_.handle(H5Dget_space(scale.get()), H5Sclose);
    return static_cast<hsize_t>(call_.check(H5Sget_simple_extent_npoints(space.get())));
  }

  void make_scale(const Hdf5Handle& set) const {
    call_.check(H5DSset_scale(set.get(), last_part(name_).c_str()));
  }

  void attach(const Hdf5Handle& set, const std::vector<Axis>& axes) const {
    for (unsigned i = 0; i < axes.size(); ++i) {
      const auto* const name = std::get_if<std::string>(&axes[i]);
      if (name == nullptr) continue;
      const Hdf5Handle scale = open_scale(*name);
      call_.check(H5DSattach_scale(set.get(), scale.get(), i));
      call_.check(H5DSset_label(set.get(), i, last_part(*name).c_str()));
    }
  }

  template <typename Item>
  void write(hid_t object, const std::string& attribute, std::span<const Item> items,
             const std::vector<hsize_t>& shape) const {
    const Raw values = raw(name_ + ", attribute " + attribute, items);
    const Hdf5Handle space = call_.handle(dataspace(shape), H5Sclose);
    const Hdf5Handle handle = call_.handle(H5Acreate2(object, attribute.c_str(), values.type.get(),
                                                      space.get(), H5P_DEFAULT, H5P_DEFAULT),
                                           H5Aclose);
    if (values.count > 0) call_.check(H5Awrite(handle.get(), values.type.get(), values.first));
  }

  std::string name_;
  Hdf5Calls<IoError> call_;
  hid_t file_ = -1;
};

/// Returns the number of bytes that values need in a file.
std::size_t bytes_of(const Values& values) {
  const auto of_numbers = [](const auto& numbers) { return numbers.size_bytes(); };
  const auto of_texts = [](std::span<const std::string> texts) {
    std::size_t bytes = texts.size() * sizeof(std::uint64_t) * 4;
    for (const std::string& text : texts) bytes += text.size();
    return bytes;
  };
  return std::visit(Either{of_texts, of_numbers}, values);
}

/// Returns a copy of the values. Throws std::logic_error if one is not finite.
CollectedDataset::Held held(const std::string& name, const Values& values) {
  return std::visit(
      [&]<typename Value>(std::span<const Value> given) -> CollectedDataset::Held {
        if constexpr (!std::is_same_v<Value, std::string>)
          if (!all_finite(given)) throw std::logic_error(name + ": a value is not finite");
        return std::vector<Value>(given.begin(), given.end());
      },
      values);
}

/// Exception for a failure of HDF5 with a file in memory, whose only possible cause is a lack of
/// memory.
struct NoMemory : std::bad_alloc {
  explicit NoMemory(const std::string& /*what*/) {}
};

/// Creates an empty HDF5 file in memory. Its bytes are written to the disk by commit() without
/// HDF5, because HDF5 may crash if the disk is full.
std::unique_ptr<Hdf5Handle> file_in_memory() {
  static std::atomic<unsigned> number{0};  // HDF5 distinguishes open files by name
  const Hdf5Calls<NoMemory> call("");
  const Hdf5Handle access = call.handle(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::size_t increment = std::size_t{1} << 20;
  call.check(H5Pset_fapl_core(access.get(), increment, false));
  const std::string name = "result-" + std::to_string(number++);
  return std::make_unique<Hdf5Handle>(
      call.handle(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose));
}

/// Upper bound for the bytes that HDF5 writes in addition to the values of a dataset or attribute.
constexpr std::size_t overhead = std::size_t{1} << 20;

std::unique_ptr<Hdf5Handle> file_on_disk(FileBeside& place) {
  place.reserve(overhead);
  const Hdf5Calls<IoError> call("HDF5 cannot make " + place.name().string());
  return std::make_unique<Hdf5Handle>(call.handle(
      H5Fcreate(place.name().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose));
}

}  // namespace

ResultFile::ResultFile(std::filesystem::path path, Storage storage) : path_(std::move(path)) {
  silence_hdf5();
  if (storage == Storage::disk) beside_ = std::make_unique<FileBeside>(path_);
  file_ = beside_ ? file_on_disk(*beside_) : file_in_memory();
  reserve_space(0);
}

ResultFile::ResultFile(CollectedResult& collected) : collected_(&collected) {}

ResultFile::ResultFile(ResultFile&&) noexcept = default;
ResultFile& ResultFile::operator=(ResultFile&&) noexcept = default;
ResultFile::~ResultFile() = default;

// Reserves space before each write, because HDF5 may crash after a write has failed for lack of
// disk space or memory, at the latest when it closes the file. A file in memory is copied when it
// grows, for which twice its size is needed.
void ResultFile::reserve_space(std::size_t bytes) {
  if (!file_) return;
  if (!beside_) return require_hdf5_memory(2 * bytes);
  hsize_t size = 0;
  const Hdf5Calls<IoError> call("HDF5 cannot write " + path_.string());
  call.check(H5Fget_filesize(file_->get(), &size));
  beside_->reserve(size + bytes + bytes / 64 + overhead);
}

bool ResultFile::has(const std::string& name) const {
  if (collected_ != nullptr)
    return collected_->find(name) != nullptr || collected_->has_group(name);
  return exists(file_->get(), name);
}

const std::vector<Axis>& ResultFile::bound(const std::string& role) const {
  const auto found = roles_.find(role);
  if (found == roles_.end()) throw std::logic_error(role + ": this role is not bound");
  return found->second;
}

void ResultFile::attribute(const std::string& object, const std::string& name,
                           const Attribute& value) {
  if (collected_ != nullptr) {
    collected_->attributes.push_back({object, name, value});
    return;
  }
  reserve_space(0);
  Writer(file_.get(), path_.string(), object).attribute(name, value);
}

void ResultFile::scale(const std::string& name, std::span<const double> values,
                       const std::string& units, const std::string& long_name) {
  if (collected_ != nullptr)
    return collected_->add({name, true, {}, units, long_name, held(name, values)});
  reserve_space(values.size_bytes());
  const Writer writer(file_.get(), path_.string(), name);
  writer.scale(values);
  writer.describe(units, long_name);
}

void ResultFile::scale(const std::string& name, std::size_t count,
                       const std::function<double(std::size_t)>& value, const std::string& units,
                       const std::string& long_name) {
  const std::size_t at_once = collected_ != nullptr ? count : 8192;
  std::vector<double> values;
  const auto make = [&](std::size_t first) {
    values.resize(std::min(at_once, count - first));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(first + i);
  };
  make(0);
  if (count <= at_once) return scale(name, values, units, long_name);
  reserve_space(0);
  const Writer writer(file_.get(), path_.string(), name);
  writer.begin_scale(raw(name, std::span<const double>()), count, at_once);
  writer.describe(units, long_name);
  for (std::size_t first = 0; first < count; first += at_once) {
    make(first);
    write_block(name, std::span<const double>(values), {first}, {values.size()});
  }
}

void ResultFile::dataset(const std::string& name, const Values& values,
                         const std::vector<Axis>& axes, const std::string& units,
                         const std::string& long_name) {
  if (collected_ != nullptr)
    return collected_->add({name, false, axes, units, long_name, held(name, values)});
  reserve_space(bytes_of(values));
  const Writer writer(file_.get(), path_.string(), name);
  writer.dataset(raw(name, values), axes);
  writer.describe(units, long_name);
}

void ResultFile::begin_dataset(const std::string& name, const Values& none,
                               const std::vector<Axis>& axes, const std::vector<std::size_t>& chunk,
                               const std::string& units, const std::string& long_name) {
  if (collected_ != nullptr)
    return collected_->begin({name, false, axes, units, long_name, held(name, none)});
  reserve_space(0);
  const Writer writer(file_.get(), path_.string(), name);
  writer.begin(raw(name, none), axes, chunk);
  writer.describe(units, long_name);
}

void ResultFile::write_block(const std::string& name, const Values& values,
                             const std::vector<std::size_t>& start,
                             const std::vector<std::size_t>& count) {
  if (collected_ != nullptr) return collected_->put_block(name, values, start, count);
  reserve_space(bytes_of(values));
  Writer(file_.get(), path_.string(), name).block(raw(name, values), start, count);
}

bool ResultFile::keeps_invariants() const {
  return std::ranges::all_of(invariants_, [](const auto& each) { return each.second.holds(); });
}

void ResultFile::commit(bool is_checksummed, Durable durable) {
  if (!beside_) {
    auto bytes = image();
    if (is_checksummed) append_checksum(bytes);
    return replace_file(path_, bytes, durable);
  }
  if (!file_) throw std::logic_error(path_.string() + ": finished twice");
  reserve_space(0);
  const Hdf5Calls<IoError> call("HDF5 cannot finish " + path_.string());
  call.check(H5Fflush(file_->get(), H5F_SCOPE_GLOBAL));
  hsize_t size = 0;
  call.check(H5Fget_filesize(file_->get(), &size));
  file_.reset();
  beside_->truncate(size);
  if (is_checksummed) beside_->append(checksum_of_file(beside_->name()));
  beside_->put_in_place(durable);
}

/// Closes the HDF5 file in memory and returns its bytes.
std::vector<std::byte> ResultFile::image() {
  if (!file_) throw std::logic_error(path_.string() + ": finished twice");
  const Hdf5Calls<IoError> call("HDF5 cannot finish " + path_.string());
  call.check(H5Fflush(file_->get(), H5F_SCOPE_GLOBAL));
  std::vector<std::byte> bytes(
      static_cast<std::size_t>(call.check(H5Fget_file_image(file_->get(), nullptr, 0))));
  call.check(H5Fget_file_image(file_->get(), bytes.data(), bytes.size()));
  file_.reset();
  return bytes;
}

void check_result_path(const std::filesystem::path& path) {
  check_writable(path);
  std::error_code none;
  if (const auto size = std::filesystem::file_size(path, none); none || size == 0) return;
  if (access(path.c_str(), R_OK) != 0)
    throw IoError("cannot read the file at " + path.string() + ": " + std::strerror(errno));
  silence_hdf5();
  if (H5Fis_hdf5(path.c_str()) <= 0)
    throw InputError(
        "cannot write " + path.string() +
        ": a file exists there that is not a result of this program; name another file");
}

}  // namespace flatspeckle
