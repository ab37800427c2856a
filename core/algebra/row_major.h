#pragma once

#include <vector>

#include <Eigen/Core>

namespace flatspeckle {

/// As datasets have it: last axis fastest.
inline std::vector<double> row_major(const Eigen::MatrixXd& values) {
  const Eigen::MatrixXd columns = values.transpose();
  return {columns.data(), columns.data() + columns.size()};
}

}  // namespace flatspeckle
