#pragma once

#include <string>
#include <vector>

namespace flatspeckle {

class ResultFile;

/// Kind of a dataset: an axis (`scale`, or `numbers` for an axis with the values 0, 1, ...),
/// values, estimates (whose standard errors are in a dataset NAME_error), or invariants (whose
/// limits are in a dataset NAME_limit).
enum class Data {
  scale,
  numbers,
  real,
  complex,
  count,
  text,
  estimate,
  complex_estimate,
  invariant
};

/// Returns the name of the type in docs/format.md: float64, complex, uint64 or texts.
std::string type_name(Data data);
bool has_error(Data data);

/// Metadata of a dataset. Its axes are names of datasets (scales), separated by spaces; a scale is
/// searched in the group of the dataset and then in the root. The unit "1" means that the values
/// are dimensionless, and an empty unit that they have different units.
///
/// If an axis or a unit is a word in capitals (a role), it stands for names that depend on the
/// scene and are set by ResultFile::bind().
struct DatasetRow {
  std::string path;
  Data data;
  std::string axes, unit, long_name;
};

/// Metadata of an attribute. object: the dataset or group to which the attribute belongs; empty for
/// the root. type: bool, int64, uint64, float64, text or texts (docs/format.md).
struct AttributeRow {
  std::string object, name, type, meaning;
};

/// A word in capitals that is used as an axis or unit (see DatasetRow), and its possible meanings.
struct Role {
  std::string word;
  std::vector<std::string> meanings;
};

/// Datasets and attributes that one kind of result may contain. Each table is defined next to the
/// code that computes the values, and is printed in docs/format.md.
struct DatasetTable {
  std::string name;
  std::vector<DatasetRow> rows;
  std::vector<AttributeRow> attributes = {};
  std::vector<Role> roles = {};
};

bool has_row(const DatasetTable& table, const std::string& path);
/// Returns the metadata of the dataset `path` in the table. Throws std::logic_error if the table
/// does not contain it.
const DatasetRow& row_of(const DatasetTable& table, const std::string& path);

}  // namespace flatspeckle
