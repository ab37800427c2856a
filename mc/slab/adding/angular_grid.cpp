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

/// Returns the ends of all panels. critical: critical angles, in increasing order.
std::vector<double> panel_ends(const std::vector<Focus>& all, const std::vector<double>& critical) {
  const auto foci = sharp(all);
  std::vector<double> cuts{0};
  for (const Focus& focus : foci)
    if (focus.angle > 0 && focus.angle < right_angle) cuts.push_back(focus.angle);
  cuts.insert(cuts.end(), critical.begin(), critical.end());
  cuts.push_back(right_angle);
  std::sort(cuts.begin(), cuts.end());
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

std::vector<double> mapped_to(const std::vector<double>& unit, double from, double to) {
  std::vector<double> values;
  for (const double u : unit) values.push_back(from + u * (to - from));
  return values;
}

}  // namespace

namespace {

/// Returns the angle in a medium of index `to` of light that has this angle in a medium of index
/// `from`, at most pi/2.
double angle_in(double to, double from, double angle) {
  return to == from ? angle : std::asin(std::min(1.0, from / to * std::sin(angle)));
}

}  // namespace

AngularGrid::AngularGrid(const std::vector<Focus>& foci, int order, double fine,
                         const GridIndices& indices)
    : own_(indices.own),
      inner_(gauss_legendre(std::max(order + 6, 14))),
      exact_(gauss_legendre(order + 1)) {
  auto edges = indices.smaller;
  edges.push_back({indices.largest, true});
  std::vector<double> critical;  // the angle of each edge in the medium of the largest index
  for (const auto& edge : edges)
    critical.push_back(angle_in(indices.largest, edge.index, right_angle));
  critical.back() = right_angle;
  const auto ends = panel_ends(foci, {critical.begin(), critical.end() - 1});
  // Totally reflected light has no singularity at grazing angles, so that its panel needs fewer
  // nodes.
  constexpr int least = 3;
  const int last_nodes = indices.smaller.empty() ? order : std::max(least, (6 * order + 9) / 10);
  Eigen::Index size = 0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const auto next = std::lower_bound(critical.begin(), critical.end(), ends[i + 1]);
    const auto& edge = edges[static_cast<std::size_t>(next - critical.begin())];
    if (edge.index > own_) break;
    const bool root = *next == ends[i + 1];
    const int nodes = ends[i + 1] == right_angle ? last_nodes : order;
    // Rounding would move this right angle by 1e-8, where the cosine is as small.
    const bool grazes = root && edge.of_layer;
    const double base = grazes ? edge.index : indices.largest,
                 to = grazes ? right_angle : angle_in(base, indices.largest, ends[i + 1]);
    panels_.push_back({base, angle_in(base, indices.largest, ends[i]), to, root, size,
                       root ? gauss_jacobi(nodes) : gauss_legendre(nodes)});
    size += nodes;
  }
  for (Eigen::VectorXd* values : {&angle_, &cosine_, &weight_}) values->resize(size);
  for (const Panel& panel : panels_) add_panel(panel, fine);
}

double AngularGrid::at(const Panel& panel, double u) const {
  return angle_in(own_, panel.base, panel.angle(u));
}

double AngularGrid::cosine_at(const Panel& panel, double u) const {
  if (own_ != panel.base) return std::cos(at(panel, u));
  if (panel.root && panel.to == right_angle) return std::sin(u * u * (panel.to - panel.from));
  return std::sin(right_angle - panel.angle(u));
}

double AngularGrid::derivative(const Panel& panel, double u) const {
  if (own_ == panel.base) return panel.derivative(u);
  return panel.derivative(u) * panel.base * std::cos(panel.angle(u)) / (own_ * cosine_at(panel, u));
}

double AngularGrid::point_at(const Panel& panel, double angle) const {
  const double in_base = angle_in(panel.base, own_, angle), width = panel.to - panel.from;
  return std::clamp(panel.root ? std::sqrt(std::max(0.0, (panel.to - in_base) / width))
                               : (in_base - panel.from) / width,
                    0.0, 1.0);
}

/// Adds the nodes and subpanels of a panel.
void AngularGrid::add_panel(const Panel& panel, double fine) {
  const double width = std::abs(at(panel, 1) - at(panel, 0));
  const bool mapped = panel.base != own_;
  const auto nodes = std::ssize(panel.rule.node);
  for (Eigen::Index j = 0; j < nodes; ++j) {
    const double u = panel.rule.node[static_cast<std::size_t>(j)];
    angle_[panel.first + j] = at(panel, u);
    cosine_[panel.first + j] = cosine_at(panel, u);
    weight_[panel.first + j] =
        (panel.root ? 2 : 1) * width * panel.rule.weight[static_cast<std::size_t>(j)];
  }
  if (mapped) weight_.segment(panel.first, nodes).setZero();
  const int parts = std::max(1, static_cast<int>(std::ceil((panel.root ? 2 : 1) * width / fine)));
  for (int part = 0; part < parts; ++part) {
    const auto points = mapped_to(inner_.node, static_cast<double>(part) / parts,
                                  static_cast<double>(part + 1) / parts);
    Subpanel subpanel{panel.first, Eigen::VectorXd(points.size()),
                      lagrange(panel.rule.node, points)};
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      subpanel.angle[column] = at(panel, points[i]);
      subpanel.weighted_basis.col(column) *=
          derivative(panel, points[i]) / parts * inner_.weight[i];
    }
    // The integrals of the l_j, so that the integral over all directions is exact
    if (mapped) weight_.segment(panel.first, nodes) += subpanel.weighted_basis.rowwise().sum();
    subpanels_.push_back(std::move(subpanel));
  }
}

Eigen::VectorXd AngularGrid::interval_integrals(double from, double to) const {
  Eigen::VectorXd found = Eigen::VectorXd::Zero(size());
  for (const Panel& panel : panels_) {
    const double first = at(panel, 0), last = at(panel, 1),
                 low = std::max(from, std::min(first, last)),
                 high = std::min(to, std::max(first, last));
    if (low >= high) continue;
    const double start = point_at(panel, panel.root ? high : low),
                 end = point_at(panel, panel.root ? low : high);
    const auto points = mapped_to(exact_.node, start, end);
    const Matrix values = lagrange(panel.rule.node, points);
    for (std::size_t i = 0; i < points.size(); ++i)
      found.segment(panel.first, values.rows()) += (end - start) * exact_.weight[i] *
                                                   derivative(panel, points[i]) *
                                                   values.col(static_cast<Eigen::Index>(i));
  }
  return found;
}

}  // namespace flatspeckle::mc
