#include "grin/media/fields/scene_field.h"

#include <algorithm>
#include <cmath>

#include "core/keys/kinds.h"

namespace flatspeckle::grin {

namespace {

bool is_medium(const IndexFieldKinds& kinds, const std::string& word) {
  bool is = false;
  with_kind(kinds, word, [&](const auto& kind) { is = kind.is_medium; });
  return is;
}

/// Whether one of the summed fields is a medium, to whose index the other fields are added. Throws
/// InputError if a kind of field is repeated or two fields are media.
bool has_medium(const IndexFieldValues& values) {
  std::string medium;
  const auto& words = values.field;
  for (auto word = words.begin(); word != words.end(); ++word) {
    if (std::find(words.begin(), word, *word) != word)
      throw InputError("field", *word, "must not be given twice");
    if (!is_medium(values.kinds, *word)) continue;
    if (!medium.empty())
      throw InputError("field", medium + " " + *word, "must have at most one medium in a sum");
    medium = *word;
  }
  return !medium.empty();
}

/// Sums index fields and combines their properties (FieldFacts).
class Adder {
 public:
  template <class F>
  void operator()(F field) {
    const FieldFacts known = facts(field);
    if (known.scale > 0)
      scene_.scale = scene_.scale > 0 ? std::min(scene_.scale, known.scale) : known.scale;
    scene_.strength += known.strength;
    scene_.places.insert(scene_.places.end(), known.places.begin(), known.places.end());
    if (known.rim) scene_.rim = known.rim;
    if (known.grid) scene_.grid = known.grid;
    if (!known.rim) outside_.add(field);
    if (known.excess_beyond_rim != 0) outside_.add(Homogeneous{known.excess_beyond_rim});
    sum_.add(std::move(field));
  }
  SceneField sum() && {
    scene_.field = std::move(sum_);
    scene_.outside = std::move(outside_);
    return std::move(scene_);
  }

 private:
  SceneField scene_{{.strength = 0}, {}, {}};
  AnySum sum_, outside_;
};

}  // namespace

void add_keys(Keys& keys, IndexFieldValues& values) {
  keys.group("Index field");
  keys.add("field", values.field, "Kind of the index field; the fields of several kinds are summed")
      .one_of(kind_words(values.kinds));
  each_kind(values.kinds, [&](auto& kind) {
    keys.group(std::string("Index field: ") + kind.word, kind.word);
    add_keys(keys, kind);
  });
}

SceneField make_scene_field(const Keys& keys, const IndexFieldValues& values, const FieldUse& use) {
  const auto& words = keys.required(values.field);
  const bool in_medium = has_medium(values);
  if (words.size() == 1) {
    SceneField scene;
    with_kind(values.kinds, words.front(), [&](const auto& kind) {
      auto field = make_field(keys, kind, use);
      const FieldFacts known = facts(field);
      scene = {known, std::move(field), Homogeneous{known.excess_beyond_rim}};
    });
    return scene;
  }
  Adder add;
  FieldUse added = use;
  added.is_added = true;
  if (!in_medium) add(make_field(keys, std::get<HomogeneousValues>(values.kinds), use));
  for (const std::string& word : words)
    with_kind(values.kinds, word, [&](const auto& kind) { add(make_field(keys, kind, added)); });
  return std::move(add).sum();
}

double index_at(const SceneField& scene, const Vec3& x) {
  if (scene.grid && scene.grid->distance(x) > 0) return 0;
  const auto at = [&](const auto& field) { return index(field, x); };
  const bool is_outside = scene.rim && scene.rim->distance(x) > 0;
  const double n = is_outside ? std::visit(at, scene.outside) : std::visit(at, scene.field);
  return n > 0 && std::isfinite(n) ? n : 0;
}

}  // namespace flatspeckle::grin
