#include "flatland/scene/layer_table.h"

#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle {

namespace {

/// A column and the member of a scene that it gives.
struct Column {
  const char* name;
  std::optional<double> SceneSpec::*member;
};
const std::vector<Column> densities = {{"optical_depth", &SceneSpec::optical_depth},
                                       {"mean_free_path", &SceneSpec::mean_free_path},
                                       {"density", &SceneSpec::density}};
const std::vector<Column> scatterer_columns = {{"g", &SceneSpec::g},
                                               {"albedo", &SceneSpec::albedo},
                                               {"radius", &SceneSpec::radius},
                                               {"phase_shift", &SceneSpec::phase_shift}};

std::vector<std::string> all_columns() {
  std::vector<std::string> names = {"thickness", "index_re", "index_im", "diffusion", "flow"};
  for (const auto* columns : {&densities, &scatterer_columns})
    for (const Column& column : *columns) names.emplace_back(column.name);
  return names;
}

}  // namespace

LayerTable::LayerTable(const Keys& keys, const SceneSpec& spec)
    : path_(keys.read(spec.layers)), table_(read_csv(path_, all_columns())) {
  constexpr std::size_t most = 1000;
  if (table_.rows() == 0 || table_.rows() > most)
    throw InputError("layers", path_, "must hold 1 to " + std::to_string(most) + " layers");
  if (!table_.has("thickness")) throw InputError(path_ + ": column thickness is missing");
  for (const double thickness : table_.column("thickness"))
    if (!(thickness > 0)) throw InputError(path_ + ", thickness", thickness, "must be positive");
  const auto given = std::ranges::count_if(
      densities, [&](const Column& column) { return table_.has(column.name); });
  if (given != 1)
    throw InputError(path_ +
                     ": give exactly one of the columns optical_depth, mean_free_path, "
                     "density");
  if (table_.has("index_im") && !table_.has("index_re"))
    throw InputError(path_ + ": column index_re is missing beside index_im");
  refuse_twice(keys, spec);
}

/// What a column gives in each layer, and a key for all.
void LayerTable::refuse_twice(const Keys& keys, const SceneSpec& spec) const {
  const auto refuse = [&](const std::string& column, const auto& member) {
    if (table_.has(column) && keys.given(member))
      throw InputError("layers", path_,
                       "has a column " + column + "; leave out the key " + keys.name(member));
  };
  for (const Column& column : scatterer_columns) refuse(column.name, spec.*column.member);
  refuse("index_re", spec.index);
}

double LayerTable::depth() const {
  const auto column = table_.column("thickness");
  return std::accumulate(column.begin(), column.end(), 0.0);
}

/// Of the layer as a slab of its own, all of whose keys must be of use.
Material LayerTable::material(const SceneSpec& spec, std::size_t layer) const {
  SceneSpec own;
  static_cast<ScattererValues&>(own) = spec;
  own.domain = "slab";
  own.depth = table_.column("thickness")[layer];
  const auto take = [&](const Column& column) {
    if (table_.has(column.name)) own.*column.member = table_.column(column.name)[layer];
  };
  for (const Column& column : densities) take(column);
  for (const Column& column : scatterer_columns) take(column);
  if (table_.has("index_re"))
    own.index =
        number_text(Complex(table_.column("index_re")[layer],
                            table_.has("index_im") ? table_.column("index_im")[layer] : 0.0));
  const Scene scene = make_scene(own);
  const auto share = [&](const char* name) {
    return table_.has(name) ? table_.column(name)[layer] : 1.0;
  };
  const MaterialMotion motion{share("diffusion"), share("flow")};
  if (motion.diffusion < 0) throw InputError("diffusion", motion.diffusion, "must not be negative");
  return {scene.scatterer, scene.medium, motion};
}

std::shared_ptr<const Layers> LayerTable::layers(const SceneSpec& spec) const {
  std::vector<Material> materials;
  for (std::size_t layer = 0; layer < table_.rows(); ++layer) try {
      materials.push_back(material(spec, layer));
    } catch (const InputError& error) {
      throw InputError(path_ + ", layer " + std::to_string(layer + 1) + ": " + error.what());
    }
  const auto thicknesses = table_.column("thickness");
  return std::make_shared<const Layers>(
      std::move(materials), std::vector<double>(thicknesses.begin(), thicknesses.end()));
}

}  // namespace flatspeckle
