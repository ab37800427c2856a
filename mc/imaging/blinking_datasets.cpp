#include "mc/imaging/blinking_datasets.h"

#include <algorithm>
#include <cmath>

#include "core/result/result_group.h"
#include "mc/imaging/recovery/recovery_datasets.h"
#include "mc/imaging/unmixing/unmixing_datasets.h"

namespace flatspeckle::mc {

const DatasetTable blinking_table{
    .name = "blinking",
    .rows = {{"blinking_frame", Data::numbers, "", "1", "number of the frame of a medium"},
             {"source", Data::numbers, "", "1", "number of the source"},
             {"frames", Data::real, "blinking_frame camera_place", "1",
              "of the first medium, in units of the mean of the light of all"},
             {"point_brightness", Data::real, "blinking_frame point", "1",
              "of each point in the first medium's frames, over its own brightness"},
             {"pair_excitation", Data::real, "pair", "1",
              "C_I of the light that excites two points (speckle)"},
             {"frame_contrast", Data::estimate, "", "1",
              "of single frames before the camera: root of the mean square"},
             {"expected_frame_contrast", Data::real, "", "1",
              "of Gaussian speckle of points as bright as they were drawn"},
             {"singular_value", Data::real, "repeat blinking_frame", "1",
              "of the frames over their mean, the camera's noise white where it is known, largest "
              "first"},
             {"noise_level", Data::real, "repeat", "1", "singular values above it are sources"},
             {"source_count", Data::count, "repeat", "1", "sources that the singular values tell"},
             {"factor_residual", Data::real, "repeat", "1",
              "rms of what the factors leave, over the light's"},
             {"source_pattern", Data::real, "source camera_place", "1",
              "of each source alone in the first medium, mean 1"},
             {"source_x", Data::real, "repeat source", "length",
              "of the sources that are placed to each other, from the first; not mirrored"},
             {"source_brightness", Data::real, "repeat source", "1",
              "mean over the frames, relative; 0 where the source has no place"},
             {"pattern_match", Data::real, "repeat point", "1",
              "correlation of each point's speckle with the pattern most like it"},
             {"sources_share", Data::real, "repeat", "1",
              "points that have a source within a grain, not mirrored"},
             {"sources_success", Data::estimate, "", "1", "media in which all points have"}}};

FrameContrast frame_contrast(const std::vector<ImagedMedium>& media) {
  const auto mean = [&](double Blinked::*square) {
    return root_of(mean_over(media, 0, [=](const ImagedMedium& m) { return m.blinked.*square; }));
  };
  return {mean(&Blinked::square), mean(&Blinked::expected_square).value};
}

MeanOverMedia sources_success(const std::vector<ImagedMedium>& media) {
  return share_of(media, [](const ImagedMedium& m) { return m.blinked.score.found == 1; });
}

namespace {

void write_first(const ResultGroup& root, const Blinked& first, std::size_t points) {
  std::vector<double> values;
  for (const auto& frame : first.frames) values.insert(values.end(), frame.begin(), frame.end());
  root.put("frames", values);
  root.put("point_brightness", std::span(first.brightness).first(first.frames.size() * points));
}

/// Values of each medium's placed sources, zeros where it has fewer.
void write_places(const ResultGroup& root, const std::vector<ImagedMedium>& media,
                  std::size_t sources, double length_of_pixel) {
  const auto of_object = [&](double scale, std::vector<double> LineObject::*member) {
    return of_each(media, sources, [=](const ImagedMedium& m) {
      auto values = m.blinked.found.object().*member;
      for (double& value : values) value *= scale;
      return values;
    });
  };
  root.put("source_x", of_object(length_of_pixel, &LineObject::x));
  root.put("source_brightness", of_object(1, &LineObject::brightness));
}

void write_sources(const ResultGroup& root, const LineScene& line,
                   const std::vector<ImagedMedium>& media) {
  std::size_t most = 0;
  for (const ImagedMedium& m : media) most = std::max(most, m.blinked.found.places.x.size());
  const auto of_medium = [&](auto value) {
    return column(media, [value](const ImagedMedium& m) { return value(m.blinked); });
  };
  root.put("singular_value",
           of_each(media, media.front().blinked.found.count.singular_values.size(),
                   [](const ImagedMedium& m) { return m.blinked.found.count.singular_values; }));
  root.put("noise_level", of_medium([](const Blinked& b) { return b.found.count.threshold; }));
  root.put("source_count", of_medium([](const Blinked& b) { return b.found.count.sources; }));
  root.put("factor_residual", of_medium([](const Blinked& b) { return b.found.factors.residual; }));
  root.put("sources_share", of_medium([](const Blinked& b) { return b.score.found; }));
  root.put("pattern_match", of_each(media, line.object.x.size(),
                                    [](const ImagedMedium& m) { return m.blinked.pattern_match; }));
  const MeanOverMedia rate = sources_success(media);
  root.put("sources_success", rate.value, rate.error);
  if (most == 0) return;
  root.number("source", most);
  write_places(root, media, most, 1 / magnification(line));
  auto pattern = row_by_row(media.front().blinked.found.factors.pattern.transpose());
  pattern.resize(most * line.camera.pixels);
  root.put("source_pattern", pattern);
}

}  // namespace

void write_blinking(ResultFile& file, const LineScene& line, const ImagingTask& task,
                    const std::vector<ImagedMedium>& media) {
  const ResultGroup root(file, blinking_table);
  root.number("blinking_frame", task.blinking.frames);
  write_first(root, media.front().blinked, line.object.x.size());
  const FrameContrast contrast = frame_contrast(media);
  root.put("frame_contrast", contrast.found.value, contrast.found.error);
  root.put("expected_frame_contrast", contrast.expected);
  if (!task.blinking.correlation.empty()) root.put("pair_excitation", task.blinking.correlation);
  if (task.blinking.unmixes) write_sources(root, line, media);
}

}  // namespace flatspeckle::mc
