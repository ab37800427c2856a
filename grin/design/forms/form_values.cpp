#include "grin/design/forms/form_values.h"

namespace flatspeckle::grin::design {

namespace {

constexpr std::int64_t most_nodes = 257;

/// Of a box whose nodes are not given the first level, with too few, is left out.
std::vector<std::int64_t> levels_of(const Keys& keys, const FormValues& values) {
  auto nodes = keys.required(values.nodes);
  if (values.design == "box" && nodes == FormValues().nodes) nodes.erase(nodes.begin());
  return nodes;
}

/// Each level must halve the spacing.
int first_nodes(const std::vector<std::int64_t>& nodes, int least) {
  if (nodes.front() < least)
    throw InputError("nodes", nodes.front(), "must be at least " + std::to_string(least));
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (nodes[i] != 2 * nodes[i - 1] - 1)
      throw InputError("nodes", nodes[i],
                       "after " + std::to_string(nodes[i - 1]) + " must be " +
                           std::to_string(2 * nodes[i - 1] - 1) +
                           ": each level halves the spacing");
  return static_cast<int>(nodes.front());
}

/// Of a ball, a profile or a box; what a box starts from is 1 at its faces.
void bound(const Keys& keys, const FormValues& values, FormStart& start) {
  start.least_index = keys.read(values.least_index);
  start.most_index = keys.read(values.most_index);
  const double least = start.least_index - 1, most = start.most_index - 1;
  const double excess = keys.read(values.start_excess);
  if (least > 0) throw InputError("least_index", least + 1, "must be at most 1, as at the rim");
  if (most < 0) throw InputError("most_index", most + 1, "must be at least 1, as at the rim");
  if (!(excess >= least && excess <= most))
    throw InputError("start_excess", excess,
                     "crosses the bounds: least_index and most_index leave " +
                         std::to_string(least) + " to " + std::to_string(most));
  start.coefficients.assign(shape_of(start.form).size(), excess);
  bounds_of(start.form, start.least_index, start.most_index).hold(start.coefficients);
}

FormStart make_guide(const Keys& keys, const FormValues& values, double radius) {
  const int count = static_cast<int>(keys.read(values.coefficients));
  if (count != 0 && count < 4)
    throw InputError("coefficients", count, "must be at least 4, or 0: the exponent alone");
  const GuideForm guide{{keys.read(values.index) - 1, keys.required(values.delta), radius}, count};
  const double start = count == 0 ? guide.core.exponent : 0;
  return {guide, 1, 1, std::vector<double>(guide.shape().size(), start), 0, 0};
}

}  // namespace

void add_keys(Keys& keys, FormValues& values) {
  keys.group("Designed field");
  keys.add(
          "design", values.design,
          "n = 1 + (1 - r^2/R^2) s: s a cubic spline in space (ball), or of r (radial); n = 1 + a "
          "spline in a cube, 0 at its faces (box); n^2 = n0^2 (1 - 2 delta p), p = q + q (1 - q) s "
          "or a power of q = (rho/radius)^2 (guide)")
      .one_of({"ball", "radial", "box", "guide"});
  keys.add("radius", values.radius,
           "Of the ball, whose rim stays at n = 1, half the side of the box, of the guide's core; "
           "about the origin")
      .positive()
      .unit("length");
  keys.add("nodes", values.nodes,
           "Of the spline along each axis, of one level after another, each of half the spacing "
           "(box: "
           "from 9)")
      .from(2, most_nodes)
      .only_of("ball, box");
  keys.add("coefficients", values.coefficients,
           "Of s; of a guide 0: p is a power, whose exponent is sought")
      .from(0, 1000)
      .only_of("radial, guide");
  keys.add("start_excess", values.start_excess, "s at the start (box: n - 1), everywhere")
      .only_of("ball, radial, box");
  keys.add("least_index", values.least_index, "Bound of the index")
      .positive()
      .only_of("ball, radial, box");
  keys.add("most_index", values.most_index, "Bound of the index")
      .positive_to(100)
      .only_of("ball, radial, box");
  keys.add("index", values.index, "n0 on the axis").positive_to(100).only_of("guide");
  keys.add("delta", values.delta, "Of the guide: n^2 at the radius is n0^2 (1 - 2 delta)")
      .positive_to(0.45)
      .only_of("guide");
}

FormStart make_form(const Keys& keys, const FormValues& values) {
  const double radius = keys.read(values.radius);
  const std::string& design = keys.read(values.design);
  if (design == "guide") return make_guide(keys, values, radius);
  FormStart start;
  if (design == "radial") {
    const int count = static_cast<int>(keys.read(values.coefficients));
    if (count < 4) throw InputError("coefficients", count, "must be at least 4");
    start.form = RadialForm{Vec3::Zero(), radius, 4, count};
    start.levels = count > 4 ? 2 : 1;
  } else {
    const auto nodes = levels_of(keys, values);
    if (design == "ball")
      start.form = BallForm{Vec3::Zero(), radius, first_nodes(nodes, 2)};
    else
      start.form = BoxForm{Vec3::Zero(), radius, first_nodes(nodes, 7)};
    start.levels = static_cast<int>(nodes.size());
    start.finest = static_cast<double>(nodes.back());
  }
  bound(keys, values, start);
  return start;
}

}  // namespace flatspeckle::grin::design
