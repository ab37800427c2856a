#include "flatland/scatterers/scatterer_kinds.h"

#include <algorithm>

#include "core/contract.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"

namespace flatspeckle {

namespace {

const ScattererKind* const kinds[] = {&point_kind,      &soft_kind, &hard_kind, &tm_kind,
                                      &penetrable_kind, &te_kind,   &hg_kind,   &mie_kind};

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
  read_bulk_albedo(keys, values, made);
  return made;
}

void read_radius(const Keys& keys, const ScattererValues& values, Scatterer& made) {
  const auto& radius = keys.read(values.radius);
  const auto& diameter = keys.read(values.diameter);
  if (radius && diameter)
    throw InputError(keys.name(values.diameter), *diameter,
                     "cannot be combined with radius; give one of them");
  made.radius = radius.value_or(diameter.value_or(0) / 2);
}

void require_radius(const ScattererValues& values) {
  if (!values.radius && !values.diameter)
    throw InputError("radius is not given: give radius or diameter");
}

void read_radius_and_index(const Keys& keys, const ScattererValues& values, Scatterer& made) {
  read_radius(keys, values, made);
  const auto& relative = keys.read(values.index);
  const auto& absolute = keys.read(values.particle_index);
  if (!relative && !absolute) return;
  const std::string name = absolute ? "particle_index" : "index",
                    text = absolute ? *absolute : *relative;
  if (relative && absolute)
    throw InputError(name, text, "cannot be combined with index, the relative index; give one");
  if (absolute && !values.medium_index)
    throw InputError(name, text,
                     "requires medium_index; without it give index, the index relative to the "
                     "medium");
  made.index = parse_complex(name, text) / (absolute ? *values.medium_index : 1.0);
  if (const auto fault = index_fault(made.index); !fault.empty())
    throw InputError(name, text, fault);
}

void read_albedo(const Keys& keys, const ScattererValues& values, Scatterer& made) {
  made.albedo = keys.read(values.albedo).value_or(1);
}

void read_bulk_albedo(const Keys& keys, const ScattererValues& values, Scatterer& made) {
  read_albedo(keys, values, made);
  const auto& mu_s = keys.read(values.mu_s);
  const auto& mu_a = keys.read(values.mu_a);
  if (mu_a && !mu_s) throw InputError(keys.name(values.mu_a), *mu_a, "requires mu_s");
  if (!mu_s) return;
  if (values.albedo)
    throw InputError(keys.name(values.albedo), *values.albedo,
                     "follows from mu_s and mu_a; leave it out");
  made.albedo = *mu_s / (*mu_s + mu_a.value_or(0));
}

}  // namespace flatspeckle
