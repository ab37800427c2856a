#include "grin/media/fields/transducers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/keys/csv.h"
#include "grin/media/fields/focused_sound.h"
#include "grin/media/geometry/frame.h"

namespace flatspeckle::grin {

namespace {

std::vector<Vec3> directions(const Transducer& of, int waves) {
  const Vec3 axis = of.direction.normalized();
  if (!(of.aperture > 0)) return {axis};
  const Frame across = frame_across(axis);
  std::vector<Vec3> found;
  for (const Vec3& d : cap_directions(waves, of.aperture))
    found.push_back(d[0] * across.col(0) + d[1] * across.col(1) + d[2] * axis);
  return found;
}

}  // namespace

Transducers::Transducers(double background, const std::vector<Transducer>& all, int waves)
    : SoundWaves(background) {
  for (const Transducer& one : all)
    largest_wavenumber_ = std::max(largest_wavenumber_, one.wavenumber);
  for (const Transducer& one : all) {
    const auto towards = directions(one, waves);
    const double amplitude = one.amplitude / static_cast<double>(towards.size());
    for (const Vec3& direction : towards) {
      const Vec3 k = one.wavenumber * direction;
      waves_.push_back(
          {k, amplitude, k.dot(one.focus) + one.phase, one.wavenumber / largest_wavenumber_});
    }
  }
}

Transducers Transducers::frozen(double phase) const {
  constexpr double periods = 1 << 20, turn = 2 * std::numbers::pi;
  const double before = std::floor(phase / turn * periods);  // whole periods of the fastest wave
  Transducers sound = *this;
  for (Wave& wave : sound.waves_)
    wave.phase += wave.rate * phase + turn * std::remainder(wave.rate * before, 1);
  return sound;
}

namespace {

constexpr std::size_t row_size = 10;
const std::vector<std::string> columns{"amplitude", "wavenumber", "phase", "x",  "y",
                                       "z",         "dx",         "dy",    "dz", "aperture"};

Transducer transducer(std::span<const double> row) {
  return {row[0],
          positive("wavenumber of a transducer", row[1]),
          row[2],
          {row[3], row[4], row[5]},
          {row[6], row[7], row[8]},
          row[9]};
}

void check(const Transducer& one) {
  if (!(one.direction.norm() > 0))
    throw InputError("direction of a transducer", 0, "must not be 0 0 0");
  if (!(one.aperture >= 0 && one.aperture <= std::numbers::pi))
    throw InputError("aperture of a transducer", one.aperture, "must be from 0 to pi");
}

/// Returns the ten numbers of each transducer, first of those in the key, then of those in the
/// table.
std::vector<double> all_numbers(const Keys& keys, const TransducersValues& values) {
  std::vector<double> rows = keys.read(values.transducer);
  const std::string& path = keys.read(values.transducer_table);
  if (path.empty()) return rows;
  const Table table = read_key_table("transducer_table", path, columns);
  std::vector<std::span<const double>> by_column;
  for (const std::string& name : columns) by_column.push_back(table.column(name));
  for (std::size_t row = 0; row < table.rows(); ++row)
    for (const auto& column : by_column) rows.push_back(column[row]);
  return rows;
}

}  // namespace

void add_keys(Keys& keys, TransducersValues& values) {
  add_index_key(keys, values.index, "without the sound");
  keys.add("transducer", values.transducer,
           "For each transducer: amplitude of the index, wavenumber and phase of the sound, "
           "position of the focus, direction of the sound, half-angle of the aperture (0: a plane "
           "wave)")
      .each_of(row_size, "amplitude wavenumber phase x y z dx dy dz aperture")
      .units("1 1/length rad length length length 1 1 1 rad");
  keys.add("transducer_table", values.transducer_table,
           "CSV with one transducer in each row; its columns are the numbers of the key "
           "transducer, in "
           "that order")
      .file();
  keys.add("transducer_waves", values.transducer_waves,
           "Number of plane waves of each transducer with an aperture")
      .from(1, 100'000);
}

Transducers make_field(const Keys& keys, const TransducersValues& values, const FieldUse& use) {
  const std::vector<double> rows = all_numbers(keys, values);
  if (rows.empty())
    throw InputError("transducer is not given: transducers require one, or a transducer_table");
  std::vector<Transducer> all;
  for (std::size_t i = 0; i < rows.size(); i += row_size) {
    all.push_back(transducer(std::span(rows).subspan(i, row_size)));
    check(all.back());
  }
  return {background(keys, values.index, use), all,
          static_cast<int>(keys.read(values.transducer_waves))};
}

}  // namespace flatspeckle::grin
