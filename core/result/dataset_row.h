#pragma once

#include <string>
#include <vector>

namespace flatspeckle {

class ResultFile;

/// What a dataset holds: an axis (numbers: one that only counts, 0, 1, ...), values, or estimates,
/// whose standard errors stand beside them under the name with _error, or invariants, whose limits
/// do so under the name with _limit.
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

/// As docs/format.md calls it: float64, complex, uint64, texts.
std::string type_name(Data data);
bool has_error(Data data);

/// All there is to say of a dataset but its values. Axes are the names of scales, with a space
/// between two: of those in the dataset's own group, where the file has them there, or the root.
/// Unit "1" says that the values are numbers; none, that they have several units.
///
/// A word in capitals, as an axis or a unit, is a role: what it stands for depends on the scene and
/// is said by ResultFile::bind.
struct DatasetRow {
  std::string path;
  Data data;
  std::string axes, unit, long_name;
};

/// An attribute of the root (object empty), or of a dataset or group. type as docs/format.md calls
/// it: bool, int64, uint64, float64, text, texts.
struct AttributeRow {
  std::string object, name, type, meaning;
};

/// What a word in capitals may stand for.
struct Role {
  std::string word;
  std::vector<std::string> meanings;
};

/// What one kind of result has in its file. A table stands beside the code that makes the values;
/// docs/format.md shows it under its name.
struct DatasetTable {
  std::string name;
  std::vector<DatasetRow> rows;
  std::vector<AttributeRow> attributes = {};
  std::vector<Role> roles = {};
};

bool has_row(const DatasetTable& table, const std::string& path);
/// Throws std::logic_error where there is none.
const DatasetRow& row_of(const DatasetTable& table, const std::string& path);

}  // namespace flatspeckle
