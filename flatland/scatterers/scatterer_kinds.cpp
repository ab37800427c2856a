#include "flatland/scatterers/scatterer_kinds.h"

#include <algorithm>

#include "core/contract.h"
#include "core/keys/number_text.h"

namespace flatspeckle {

namespace {

const ScattererKind* const kinds[] = {&point_kind, &soft_kind, &hard_kind, &tm_kind,
                                      &te_kind,    &hg_kind,   &mie_kind};

}  // namespace

const ScattererKind& kind_of(const Scatterer& scatterer) {
  FS_EXPECT(scatterer.kind != Scatterer::Kind::other_bulk);
  return **std::ranges::find(kinds, scatterer.kind, &ScattererKind::kind);
}

std::vector<std::string> scatterer_words() {
  std::vector<std::string> words;
  for (const ScattererKind* kind : kinds) words.emplace_back(kind->word);
  for (const std::string& word : bulk_phase_words()) words.push_back(word);
  return words;
}

Scatterer make_scatterer(const Keys& keys, const ScattererValues& values) {
  keys.read(values.wavelength);
  const std::string& word = keys.read(values.scatterer);
  Scatterer made{.kind = Scatterer::Kind::other_bulk};
  for (const ScattererKind* kind : kinds) {
    if (word != kind->word) continue;
    made.kind = kind->kind;
    kind->read(keys, values, made);
    return made;
  }
  read_albedo(keys, values, made);
  return made;
}

void read_radius(const Keys& keys, const ScattererValues& values, Scatterer& made) {
  made.radius = keys.read(values.radius).value_or(0);
}

void read_radius_and_index(const Keys& keys, const ScattererValues& values, Scatterer& made) {
  read_radius(keys, values, made);
  const auto& index = keys.read(values.index);
  if (!index) return;
  made.index = parse_complex("index", *index);
  if (const auto fault = index_fault(made.index); !fault.empty())
    throw InputError("index", *index, fault);
}

void read_albedo(const Keys& keys, const ScattererValues& values, Scatterer& made) {
  made.albedo = keys.read(values.albedo).value_or(1);
}

}  // namespace flatspeckle
