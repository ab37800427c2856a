#include "core/search/sum_blocks.h"

#include <algorithm>

namespace flatspeckle {

std::vector<GroupedSums> without_blocks(const GroupedSums& sums, std::size_t blocks) {
  blocks = std::min(blocks, sums.groups());
  std::vector<double> samples(blocks);
  std::vector<std::vector<Complex>> totals(blocks, std::vector<Complex>(sums.size()));
  for (std::size_t group = 0; group < sums.groups(); ++group) {
    const auto own = sums.group_sums(group);
    auto& total = totals[group % blocks];
    std::ranges::transform(own, total, total.begin(), std::plus());
    samples[group % blocks] += sums.group_samples(group);
  }
  std::vector<GroupedSums> without(blocks, GroupedSums(sums.size()));
  for (std::size_t left_out = 0; left_out < blocks; ++left_out)
    for (std::size_t block = 0; block < blocks; ++block)
      if (block != left_out) without[left_out].add(samples[block], totals[block]);
  return without;
}

}  // namespace flatspeckle
