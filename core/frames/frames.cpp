#include "core/frames/frames.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "core/error.h"
#include "core/frames/frame_formats.h"
#include "core/keys/csv.h"
#include "core/keys/table_text.h"
#include "core/keys/written_number.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"

namespace flatspeckle {

namespace {

/// Returns the first bytes of a file.
std::string signature(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(8, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

enum class Format { png, tiff, npy, pfm, exr, hdr, hdf5, other, text };

Format format_of(const std::filesystem::path& path) {
  const std::string bytes = signature(path);
  const auto begins = [&](const std::string& with) { return bytes.starts_with(with); };
  if (begins("\x89PNG")) return Format::png;
  using namespace std::string_literals;
  for (const std::string& tiff : {"II*\0"s, "MM\0*"s, "II+\0"s, "MM\0+"s})
    if (begins(tiff)) return Format::tiff;
  if (begins("\x93NUMPY")) return Format::npy;
  for (const std::string& pfm : {"Pf\n"s, "PF\n"s, "Pf "s, "PF "s})
    if (begins(pfm)) return Format::pfm;
  if (begins("\x76\x2f\x31\x01")) return Format::exr;
  if (begins("\x89HDF")) return Format::hdf5;
  if (begins("#?RADIAN") || begins("#?RGBE")) return Format::hdr;
  if (begins("\xff\xd8\xff")) return Format::other;  // JPEG
  return Format::text;
}

/// Returns the dataset that holds the frames: the one with this name, or the only one with two or
/// three axes.
std::string dataset_of(const ResultReader& file, const std::string& name) {
  if (!name.empty()) {
    if (!file.has(name)) throw std::runtime_error("has no dataset " + name);
    return name;
  }
  std::vector<std::string> fit;
  for (const std::string& dataset : file.datasets())
    if (const std::size_t axes = file.shape(dataset).size();
        file.stored_values(dataset) == StoredValues::real && (axes == 2 || axes == 3))
      fit.push_back(dataset);
  if (fit.size() == 1) return fit.front();
  throw std::runtime_error(
      fit.empty() ? "has no dataset with two axes (rows, columns) or three (frames, rows, columns)"
                  : "has several datasets; name one by frame_dataset");
}

Frames read_hdf5(const std::filesystem::path& path, const std::string& name) {
  const ResultReader file(path);
  const std::string dataset = dataset_of(file, name);
  const auto shape = file.shape(dataset);
  if (shape.size() != 2 && shape.size() != 3)
    throw std::runtime_error(dataset +
                             " must have two axes (rows, columns) or three (frames, "
                             "rows, columns)");
  return {shape[shape.size() - 2], shape.back(), file.dataset<double>(dataset), 0};
}

bool has_names(const std::filesystem::path& path) {
  const TableText text(path, false);
  const auto fields = text.fields(text.lines().front());
  return std::ranges::any_of(fields, [](const std::string& field) {
    return !field.empty() && !written_number(field, KeyUnit()).has_value();
  });
}

void append(std::vector<double>& values, std::span<const double> more) {
  values.insert(values.end(), more.begin(), more.end());
}

/// Returns the rows of a table of numbers as one frame.
Frames picture_of(const std::filesystem::path& path) {
  const auto rows = read_rows(path);
  Frames frames{rows.size(), rows.front().size(), {}, 0};
  for (const auto& row : rows) append(frames.values, row);
  return frames;
}

/// Returns the columns of a table, with or without names, as frames of one row.
Frames lines_of(const std::string& key, const std::filesystem::path& path, bool named) {
  if (named) {
    const Table table = read_key_table(key, path);
    Frames frames{1, table.rows(), {}, 0, table.names()};
    for (const std::string& name : table.names()) append(frames.values, table.column(name));
    return frames;
  }
  const Frames rows = picture_of(path);
  Frames frames{1, rows.rows, {}, 0};
  for (std::size_t column = 0; column < rows.columns; ++column)
    for (std::size_t row = 0; row < rows.rows; ++row)
      frames.values.push_back(rows.values[row * rows.columns + column]);
  return frames;
}

Frames read_text(const std::string& key, const std::filesystem::path& path,
                 const std::string& axes) {
  if (TableText(path, false).lines().empty()) throw std::runtime_error("has no lines");
  const bool named = has_names(path);
  if (axes == "unknown" && !named)
    throw std::runtime_error(
        "is a table without column names: give frame_axes = picture (rows and columns of one "
        "frame) or frame_axes = columns (each column is one line of pixels)");
  if (axes != "picture") return lines_of(key, path, named);
  if (named) throw std::runtime_error("has column names; a picture is a table of numbers alone");
  return picture_of(path);
}

Frames read(const std::string& key, const std::filesystem::path& path, const FrameFormat& how) {
  switch (format_of(path)) {
    case Format::png:
      return read_png(path, how.allows_display);
    case Format::tiff:
      return read_tiff(path);
    case Format::npy:
      return read_npy(file_bytes(path));
    case Format::pfm:
      return read_pfm(file_bytes(path));
    case Format::exr:
      return read_exr(file_bytes(path));
    case Format::hdr:
      return read_hdr(file_bytes(path));
    case Format::other:
      throw std::runtime_error(std::string("is in a format that is not read: ") +
                               accepted_pictures);
    case Format::hdf5:
      return guarded_read(path, [&] { return read_hdf5(path, how.dataset); });
    case Format::text:
      break;
  }
  return read_text(key, path, how.axes);
}

}  // namespace

bool is_text_frames(const std::filesystem::path& path) {
  return format_of(path) == Format::text;
}

void add_frame_keys(Keys& keys, FrameFormat& format) {
  keys.add("frame_dataset", format.dataset,
           "Dataset of an HDF5 file that holds the frames (default: the only one with two or three "
           "axes)")
      .only_of("frames in HDF5 files");
  keys.add("frame_axes", format.axes,
           "How a table of text is read. picture: rows and columns of one frame; columns: each "
           "column is a frame of one line of pixels (default if columns have names)")
      .one_of({"unknown", "picture", "columns"})
      .only_of("frames in CSV files");
}

void read_frame_keys(const Keys& keys, const FrameFormat& format,
                     const std::filesystem::path& path) {
  const Format found = format_of(path);
  if (found == Format::hdf5) keys.read(format.dataset);
  if (found == Format::text) keys.read(format.axes);
}

Frames read_frames(const std::string& key, const std::filesystem::path& path,
                   const FrameFormat& how) {
  Frames frames;
  try {
    frames = read(key, path, how);
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError(key + " = " + path.string() + ": " + error.what());
  }
  if (frames.count() == 0) throw InputError(key, path.string(), "has no pixels");
  if (!std::ranges::all_of(frames.values, [](double value) { return std::isfinite(value); }))
    throw InputError(key, path.string(), "must hold finite numbers");
  return frames;
}

}  // namespace flatspeckle
