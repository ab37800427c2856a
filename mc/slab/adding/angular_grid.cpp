#include "mc/slab/adding/angular_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flatspeckle::mc {

namespace {

constexpr double right_angle = std::numbers::pi / 2;
/// Ratio of the distances of the two ends of a panel from a focus. A ratio of 3 was not more
/// accurate.
constexpr double growth = 5;

/// Splits the interval [from, to] until no part is longer than 5 times its distance from any focus,
/// or 5 times the width of that focus if this is larger. Appends the upper ends of the parts to
/// `ends`.
void split(double from, double to, const std::vector<Focus>& foci, std::vector<double>& ends) {
  for (const Focus& focus : foci) {
    const bool above = focus.angle <= from;
    const double near = above ? from - focus.angle : focus.angle - to,
                 far = above ? to - focus.angle : focus.angle - from;
    if (far - near <= 1.25 * (growth - 1) * std::max(near, focus.width)) continue;
    const double cut = focus.angle + (above ? far : -far) / growth;
    split(from, cut, foci, ends);
    return split(cut, to, foci, ends);
  }
  ends.push_back(to);
}

/// Returns the foci that are so narrow that they require shorter panels. Foci close to an end of
/// the quadrant are moved to that end; foci close to each other are merged.
std::vector<Focus> sharp(std::vector<Focus> foci) {
  std::sort(foci.begin(), foci.end(), [](auto& a, auto& b) { return a.angle < b.angle; });
  std::vector<Focus> kept;
  for (Focus focus : foci) {
    if ((growth - 1) * focus.width > right_angle) continue;
    if (focus.angle < focus.width) focus.angle = 0;
    if (right_angle - focus.angle < focus.width / 100) focus.angle = right_angle;
    if (!kept.empty() && focus.angle - kept.back().angle < kept.back().width / 2) {
      kept.back().width = std::min(kept.back().width, focus.width);
      continue;
    }
    kept.push_back(focus);
  }
  return kept;
}

std::vector<double> panel_ends(const std::vector<Focus>& all) {
  const auto foci = sharp(all);
  std::vector<double> cuts{0};
  for (const Focus& focus : foci)
    if (focus.angle > 0 && focus.angle < right_angle) cuts.push_back(focus.angle);
  cuts.push_back(right_angle);
  std::vector<double> ends{0};
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) split(cuts[i], cuts[i + 1], foci, ends);
  return ends;
}

/// Returns the values of the Lagrange polynomials of the nodes `node` in [0, 1] at the points `at`,
/// [node][point], by the barycentric formula.
Matrix lagrange(const std::vector<double>& node, const std::vector<double>& at) {
  const auto n = static_cast<Eigen::Index>(node.size()), m = static_cast<Eigen::Index>(at.size());
  Matrix values(n, m);
  std::vector<double> sums(at.size());
  for (Eigen::Index j = 0; j < n; ++j) {
    double weight = 1;
    for (Eigen::Index i = 0; i < n; ++i)
      if (i != j) weight /= 4 * (node[j] - node[i]);
    for (Eigen::Index i = 0; i < m; ++i) {
      const double distance = at[i] - node[j];
      values(j, i) = weight / (distance == 0 ? 1e-300 : distance);
      sums[i] += values(j, i);
    }
  }
  for (Eigen::Index i = 0; i < m; ++i) values.col(i) /= sums[i];
  return values;
}

std::vector<double> mapped(const std::vector<double>& unit, double from, double to) {
  std::vector<double> values;
  for (const double u : unit) values.push_back(from + u * (to - from));
  return values;
}

}  // namespace

AngularGrid::AngularGrid(const std::vector<Focus>& foci, int order, double fine)
    : order_(order),
      nodes_(gauss_legendre(order)),
      last_nodes_(gauss_jacobi(order)),
      inner_(gauss_legendre(std::max(order + 6, 14))),
      exact_(gauss_legendre(order + 1)) {
  const auto ends = panel_ends(foci);
  const auto size = static_cast<Eigen::Index>(ends.size() - 1) * order;
  for (Eigen::VectorXd* values : {&angle_, &cosine_, &weight_}) values->resize(size);
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) add_panel(ends[i], ends[i + 1], fine);
}

bool AngularGrid::is_last(const Panel& panel) const {
  return panel.to >= right_angle;
}

const QuadratureRule& AngularGrid::nodes_of(const Panel& panel) const {
  return is_last(panel) ? last_nodes_ : nodes_;
}

/// Adds a panel, with its nodes and subpanels. A point u of [0, 1] is mapped to theta = from + u
/// width, or on the last panel to theta = pi/2 - u^2 width.
void AngularGrid::add_panel(double from, double to, double fine) {
  const double width = to - from;
  panels_.push_back({from, to, static_cast<Eigen::Index>(panels_.size()) * order_});
  const Panel& panel = panels_.back();
  const bool last = is_last(panel);
  const QuadratureRule& rule = nodes_of(panel);
  for (int j = 0; j < order_; ++j) {
    const double u = rule.node[j],
                 complement = last ? width * u * u : right_angle - from - u * width;
    angle_[panel.first + j] = right_angle - complement;
    cosine_[panel.first + j] = std::sin(complement);
    weight_[panel.first + j] = (last ? 2 : 1) * width * rule.weight[j];
  }
  const int parts = std::max(1, static_cast<int>(std::ceil((last ? 2 : 1) * width / fine)));
  for (int part = 0; part < parts; ++part) {
    const auto at = mapped(inner_.node, static_cast<double>(part) / parts,
                           static_cast<double>(part + 1) / parts);
    Subpanel subpanel{panel.first, Eigen::VectorXd(at.size()), lagrange(rule.node, at)};
    for (std::size_t i = 0; i < at.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      subpanel.angle[column] = last ? to - width * at[i] * at[i] : from + width * at[i];
      subpanel.weighted_basis.col(column) *=
          width / parts * inner_.weight[i] * (last ? 2 * at[i] : 1);
    }
    subpanels_.push_back(std::move(subpanel));
  }
}

Eigen::VectorXd AngularGrid::interval_integrals(double from, double to) const {
  Eigen::VectorXd found = Eigen::VectorXd::Zero(size());
  for (const Panel& panel : panels_) {
    const double low = std::max(from, panel.from), high = std::min(to, panel.to);
    if (low >= high) continue;
    const double width = panel.to - panel.from;
    const bool last = is_last(panel);
    const auto unit = [&](double angle) {
      return last ? std::sqrt((right_angle - angle) / width) : (angle - panel.from) / width;
    };
    const double start = unit(last ? high : low), end = unit(last ? low : high);
    const auto at = mapped(exact_.node, start, end);
    const Matrix values = lagrange(nodes_of(panel).node, at);
    for (std::size_t i = 0; i < at.size(); ++i)
      found.segment(panel.first, order_) += width * (end - start) * exact_.weight[i] *
                                            (last ? 2 * at[i] : 1) *
                                            values.col(static_cast<Eigen::Index>(i));
  }
  return found;
}

}  // namespace flatspeckle::mc
