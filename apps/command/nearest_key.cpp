#include "apps/command/nearest_key.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace flatspeckle::apps {

namespace {

std::size_t letters_apart(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t before = i;  // of a's letters up to i and b's up to j
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = before + (a[i] == b[j] ? 0 : 1);
      before = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, before + 1});
    }
  }
  return row.back();
}

std::string nearest_key(const Keys& keys, const std::string& name) {
  std::size_t least = std::min<std::size_t>(2, (name.size() + 1) / 3) + 1;
  std::string nearest;
  for (const Key& key : keys.rows()) {
    const std::size_t apart = letters_apart(name, key.name());
    if (apart >= least) continue;
    least = apart;
    nearest = key.name();
  }
  return nearest;
}

}  // namespace

std::string did_you_mean(const Keys& keys, const std::string& name) {
  const std::string nearest = nearest_key(keys, name);
  return nearest.empty() ? "" : "; did you mean " + nearest + '?';
}

}  // namespace flatspeckle::apps
