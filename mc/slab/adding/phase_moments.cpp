#include "mc/slab/adding/phase_moments.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/numbers/gauss.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// Gauss nodes on panels that divide [0, pi] finely enough to integrate a function. The weights
/// include the values of the function.
class ResolvedNodes {
 public:
  /// longest: upper bound of the length of a panel.
  ResolvedNodes(const std::function<double(double)>& integrand, double longest)
      : integrand_(integrand), longest_(longest) {
    // The smallest panel resolves the Henyey-Greenstein peak of g = 1 - 1e-11.
    constexpr int halvings = 40;
    std::vector<double> ends{0};
    for (int i = halvings; i >= 1; --i) ends.push_back(std::ldexp(pi, -i));
    for (int i = 2; i <= halvings; ++i) ends.push_back(pi - std::ldexp(pi, -i));
    ends.push_back(pi);
    std::vector<double> sums;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) sums.push_back(gauss(ends[i], ends[i + 1]));
    tolerance_ = 1e-11 * std::accumulate(sums.begin(), sums.end(), 0.0);
    for (std::size_t i = 0; i < sums.size(); ++i) refine(ends[i], ends[i + 1], sums[i], 0);
  }

  const std::vector<double>& angle() const { return angle_; }
  const std::vector<double>& weight() const { return weight_; }

 private:
  static const QuadratureRule& rule() {
    static const QuadratureRule rule = gauss_legendre(16);
    return rule;
  }

  double gauss(double from, double to) const {
    double sum = 0;
    for (std::size_t i = 0; i < rule().node.size(); ++i)
      sum += (to - from) * rule().weight[i] * integrand_(from + (to - from) * rule().node[i]);
    return sum;
  }

  void refine(double from, double to, double sum, int depth) {
    constexpr int deepest = 30;
    const double middle = (from + to) / 2, left = gauss(from, middle), right = gauss(middle, to);
    const bool resolved = !(std::abs(left + right - sum) > tolerance_) || depth == deepest;
    if (!resolved || to - from > longest_) {
      refine(from, middle, left, depth + 1);
      return refine(middle, to, right, depth + 1);
    }
    for (std::size_t i = 0; i < rule().node.size(); ++i) {
      angle_.push_back(from + (to - from) * rule().node[i]);
      weight_.push_back((to - from) * rule().weight[i] * integrand_(angle_.back()));
    }
  }

  const std::function<double(double)>& integrand_;
  double longest_, tolerance_ = 0;
  std::vector<double> angle_, weight_;
};

/// Adds weight cos(l angle), or in space weight P_l(cos(angle)), to each moment l. The recurrence
/// uses the differences of successive degrees, which lose no digits at small angles. For angles
/// above pi / 2, pi - angle is used instead, with the opposite sign for odd l.
void add_functions(int dimension, double angle, double weight, std::vector<double>& moments) {
  const bool is_behind = angle > pi / 2;
  const double sine = std::sin((is_behind ? pi - angle : angle) / 2),
               rest = 2 * sine * sine;  // 1 - cos(angle), or 1 - cos(pi - angle)
  const double odd = is_behind ? -weight : weight;
  double value = 1, difference = 0;
  for (std::size_t l = 0; l < moments.size(); ++l) {
    moments[l] += (l % 2 == 0 ? weight : odd) * value;
    const double n = static_cast<double>(l);
    difference = dimension == 3 ? (n * difference - (2 * n + 1) * rest * value) / (n + 1)
                                : difference - (l == 0 ? 1 : 2) * rest * value;
    value += difference;
  }
}

/// Largest change of the phase l theta within a panel, in radians, for the function cos(l theta) or
/// P_l(cos(theta)) of highest degree l. The Gauss nodes of a panel resolve functions that vary this
/// much.
constexpr double turn_of_panels = 10;

}  // namespace

PhaseMoments::PhaseMoments(FirstMoments source, int most) : source_(std::move(source)) {
  constexpr double rounding = 1e-13;
  auto& list = kept_.list;
  std::size_t size = 0;  // number of moments up to the last one above rounding error
  const auto take = [&](int count) {
    const auto small = [](double moment) { return std::abs(moment) < rounding; };
    list = source_(count);
    size = static_cast<std::size_t>(std::find_if_not(list.rbegin(), list.rend(), small).base() -
                                    list.begin());
  };
  int count = std::min(128, most);
  for (take(count); 2 * size > list.size() && count < most; take(count))
    count = std::min(4 * count, most);
  if (size == static_cast<std::size_t>(most)) {
    keep(most);
  } else {
    list.resize(size);
    set_width();
  }
}

PhaseMoments PhaseMoments::truncated(int count) const {
  PhaseMoments fewer = *this;
  const int size = static_cast<int>(kept_.list.size());
  if (count < size || (count > size && kept_.tail > 0)) fewer.keep(count);
  return fewer;
}

void PhaseMoments::keep(int count) {
  kept_ = {source_(count + 2)};
  auto& list = kept_.list;
  const double first = list[static_cast<std::size_t>(count)], second = list.back();
  list.resize(static_cast<std::size_t>(count));
  kept_.tail = std::max(std::abs(first), std::abs(second));
  kept_.peak = std::max(0.0, std::min(first, second));
  kept_.peak_degree = count + (second < first ? 1 : 0);
  for (std::size_t l = 0; l < list.size(); ++l) list[l] = kept_.less_peak(l, list[l], kept_.peak);
  set_width();
}

void PhaseMoments::set_width() {
  // For Henyey-Greenstein's function of width 1 - g, g^l falls to 1e-13 at l = 30 / width.
  constexpr double moments_per_width = 30;
  const auto& list = kept_.list;
  const auto large = [&](double moment) { return std::abs(moment) > 1e-3 * list.front(); };
  const auto last = std::find_if(list.rbegin(), list.rend(), large).base() - list.begin();
  kept_.width = std::min({pi, moments_per_width / static_cast<double>(list.size()),
                          turn_of_panels / static_cast<double>(last)});
}

double KeptMoments::less_peak(std::size_t l, double moment, double share_of_peak) const {
  if (!is_sharp()) return moment - share_of_peak;
  const double share = static_cast<double>(l) / static_cast<double>(list.size());
  return (moment - share_of_peak) * std::exp(-36 * std::pow(share, 8));
}

int kept_moments(int order) {
  constexpr double most = 8192;
  return static_cast<int>(std::min(most, 2 * std::pow(order, 2.5)));
}

std::vector<double> first_moments(int dimension, const std::function<double(double)>& p,
                                  const std::function<double(double)>& decay, int count) {
  const std::function<double(double)> integrand = [&](double angle) {
    return p(angle) * (dimension == 3 ? std::sin(angle) : 1);
  };
  const ResolvedNodes nodes(integrand, turn_of_panels / count);
  std::vector<double> moments(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < nodes.angle().size(); ++i) {
    const double angle = nodes.angle()[i];
    add_functions(dimension, angle, nodes.weight()[i] * (decay ? decay(angle) : 1), moments);
  }
  const double all = std::accumulate(nodes.weight().begin(), nodes.weight().end(), 0.0);
  for (double& moment : moments) moment /= all;
  return moments;
}

double sphere_integral(const std::function<double(double)>& p) {
  const std::function<double(double)> integrand = [&](double angle) {
    return 2 * pi * p(angle) * std::sin(angle);
  };
  const ResolvedNodes nodes(integrand, pi);
  const auto& weight = nodes.weight();
  return std::accumulate(weight.begin(), weight.end(), 0.0);
}

double peak_width(const std::function<double(double)>& p) {
  double width = pi;
  for (const double from : {0.0, pi})
    for (double near = pi; near > 0; near /= 2)
      if (p(std::abs(from - near)) >= p(from) / 2) {
        width = std::min(width, near);
        break;
      }
  return width;
}

}  // namespace flatspeckle::mc
