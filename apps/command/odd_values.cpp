#include "apps/command/odd_values.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"
#include "core/result/result_reader.h"

namespace flatspeckle::apps {

namespace {

/// Whether the refractive indices are probably excesses n - 1: all real and imaginary parts are
/// below 0.5. The latter excludes metals, whose imaginary part is large.
bool resembles_excess(const std::vector<Complex>& indices) {
  constexpr double least = 0.5;
  return !indices.empty() && std::ranges::all_of(indices, [](const Complex& index) {
    return index.real() < least && std::abs(index.imag()) < least;
  });
}

std::vector<Complex> indices_of(const Table& table) {
  std::vector<Complex> indices;
  if (!table.has("index_re")) return indices;
  for (std::size_t row = 0; row < table.rows(); ++row)
    indices.emplace_back(table.column("index_re")[row],
                         table.has("index_im") ? table.column("index_im")[row] : 0);
  return indices;
}

void note_index(const Key& key, const std::vector<Complex>& indices) {
  if (resembles_excess(indices))
    std::cerr << "note: " << key.name() << " = " << key.shown() << ": the index is below 0.5"
              << (indices.size() > 1 ? " everywhere" : "")
              << "; this key is the index n, not n - 1\n";
}

void note_excess(const Key& key) {
  constexpr double most = 0.9;
  const auto excess = ResultReader(key.shown()).dataset<double>("excess");
  if (!excess.empty() && std::ranges::min(excess) > most)
    std::cerr << "note: " << key.name() << " = " << key.shown()
              << ": the excess is above 0.9 everywhere; this key is n - 1, not n\n";
}

void note_key(const Key& key) {
  const std::string& name = key.name();
  if (name == "count" && key.shown() == "0") std::cerr << "note: count = 0: no scatterers\n";
  if ((name == "index" || name == "particle_index") && !key.is_list())
    note_index(key, {parse_complex(name, key.shown())});
  if (name == "index_grid") note_excess(key);
  const bool may_be_table = name == "placement" || name == "index_table" || name == "layers";
  if (!may_be_table || !std::filesystem::is_regular_file(key.shown())) return;
  const Table table = read_csv(key.shown());
  note_index(key, indices_of(table));
  if (table.rows() == 0) std::cerr << "note: placement = " << key.shown() << ": no scatterers\n";
}

}  // namespace

void note_odd_values(const Keys& keys) {
  std::set<std::string> noted;
  for (const Key& key : keys.rows())
    if (key.given() && noted.insert(key.name()).second) note_key(key);
}

}  // namespace flatspeckle::apps
