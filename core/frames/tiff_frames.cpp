#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <tiffio.h>
#include <utility>

#include "core/frames/frame_formats.h"

namespace flatspeckle {

namespace {

/// Layout of the pixels of a page.
struct Page {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, samples = 1, kind = SAMPLEFORMAT_UINT, photometric = 0;
};

Page page_of(TIFF* tiff) {
  Page page;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &page.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &page.height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &page.bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &page.samples);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &page.kind);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &page.photometric);
  std::uint16_t planes = PLANARCONFIG_CONTIG;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &planes);
  const bool is_apart = page.samples > 1 && planes != PLANARCONFIG_CONTIG;
  if (page.samples < 1 || page.samples > 4 || is_apart || page.photometric == PHOTOMETRIC_PALETTE)
    throw std::runtime_error("has colours in planes or a palette: convert it to grey");
  if (page.photometric == PHOTOMETRIC_MINISWHITE)
    throw std::runtime_error("is inverted: 0 must be black");
  if (TIFFIsTiled(tiff) != 0) throw std::runtime_error("is tiled, which is not supported");
  return page;
}

template <typename Value>
double value_at(const std::uint8_t* row, std::size_t i) {
  Value value;
  std::memcpy(&value, row + i * sizeof(Value), sizeof(Value));
  return static_cast<double>(value);
}

using ValueAt = double (*)(const std::uint8_t* row, std::size_t i);

ValueAt reader_of(const Page& page) {
  const auto is = [&](int kind, int bits) { return page.kind == kind && page.bits == bits; };
  if (is(SAMPLEFORMAT_UINT, 8)) return value_at<std::uint8_t>;
  if (is(SAMPLEFORMAT_UINT, 16)) return value_at<std::uint16_t>;
  if (is(SAMPLEFORMAT_UINT, 32)) return value_at<std::uint32_t>;
  if (is(SAMPLEFORMAT_INT, 16)) return value_at<std::int16_t>;
  if (is(SAMPLEFORMAT_INT, 32)) return value_at<std::int32_t>;
  if (is(SAMPLEFORMAT_IEEEFP, 32)) return value_at<float>;
  if (is(SAMPLEFORMAT_IEEEFP, 64)) return value_at<double>;
  throw std::runtime_error("must have 8, 16 or 32 bit per pixel, or floating point");
}

/// Returns the largest value of a page: 1 for floating point.
double largest_of(const Page& page) {
  if (page.kind == SAMPLEFORMAT_IEEEFP) return 1;
  return std::exp2(page.kind == SAMPLEFORMAT_UINT ? page.bits : page.bits - 1) - 1;
}

}  // namespace

Frames read_tiff(const std::filesystem::path& path) {
  TIFFSetErrorHandler(nullptr);
  TIFFSetWarningHandler(nullptr);
  const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(TIFFOpen(path.c_str(), "r"), TIFFClose);
  if (!tiff) throw std::runtime_error("is a damaged TIFF file");
  Frames frames;
  do {
    const Page page = page_of(tiff.get());
    const ValueAt value = reader_of(page);
    if (frames.rows == 0) {
      frames.rows = page.height;
      frames.columns = page.width;
      if (page.kind == SAMPLEFORMAT_UINT && page.bits < 32) frames.full_scale = largest_of(page);
    }
    if (page.height != frames.rows || page.width != frames.columns)
      throw std::runtime_error("has pages of different sizes");
    std::vector<double> values;
    std::vector<std::uint8_t> row(static_cast<std::size_t>(TIFFScanlineSize(tiff.get())));
    for (std::uint32_t y = 0; y < page.height; ++y) {
      if (TIFFReadScanline(tiff.get(), row.data(), y) < 0)
        throw std::runtime_error("is a damaged TIFF file");
      for (std::size_t x = 0; x < std::size_t{page.width} * page.samples; ++x)
        values.push_back(value(row.data(), x));
    }
    const auto grey = grey_pixels(std::move(values), page.samples, largest_of(page));
    frames.values.insert(frames.values.end(), grey.begin(), grey.end());
  } while (TIFFReadDirectory(tiff.get()) != 0);
  return frames;
}

}  // namespace flatspeckle
