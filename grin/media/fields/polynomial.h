#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "grin/media/index/field_kind.h"

namespace flatspeckle::grin {

/// Gradient index of lens design: n = n0 + sum_k a_k rho^(2 k) + sum_k b_k z^k, where rho is the
/// distance from an axis along z and z is counted from a vertex on the axis. It contains the
/// gradient surfaces that lens design programs call 1, 3 and 5. Beyond a plane z = z1, the axial
/// sum may be replaced by a second one, in powers of z - z1, as in the lens of the eye
/// [liou1997].
struct PolynomialIndex {
  static constexpr std::size_t most_terms = 6;
  using Terms = std::array<double, most_terms>;

  Vec3 vertex = Vec3::Zero();
  double vertex_excess = 0;
  Terms radial = {};                                          ///< coefficients of rho^2, rho^4, ...
  Terms axial = {};                                           ///< coefficients of z, z^2, ...
  double break_at = std::numeric_limits<double>::infinity();  ///< z1
  double excess_at_break = 0;                                 ///< n0 + axial sum at z1, minus 1
  Terms beyond = {};                                          ///< coefficients of z - z1, ...

  /// Value and derivatives of a polynomial without constant term.
  struct Sum {
    double value = 0, first = 0, second = 0;
  };
  static Sum sum(const Terms& terms, double u) {
    Sum at;
    for (std::size_t k = most_terms; k-- > 0;) {
      at.second = at.second * u + 2 * at.first;
      at.first = at.first * u + at.value;
      at.value = at.value * u + terms[k];
    }
    return {at.value * u, at.first * u + at.value, at.second * u + 2 * at.first};
  }

  double excess(const Vec3& x) const { return hessian(x).excess; }
  IndexGradient gradient(const Vec3& x) const {
    const IndexHessian at = hessian(x);
    return {at.excess, at.gradient};
  }
  IndexHessian hessian(const Vec3& x) const {
    const Vec3 p = x - vertex, across(p[0], p[1], 0);
    const bool is_beyond = p[2] > break_at;
    const Sum r = sum(radial, across.squaredNorm());
    const Sum z = is_beyond ? sum(beyond, p[2] - break_at) : sum(axial, p[2]);
    Mat3 second = 4 * r.second * across * across.transpose();
    second(0, 0) += 2 * r.first;
    second(1, 1) += 2 * r.first;
    second(2, 2) += z.second;
    return {(is_beyond ? excess_at_break : vertex_excess) + r.value + z.value,
            Vec3(2 * r.first * p[0], 2 * r.first * p[1], z.first), second};
  }
};

/// The scale is the smallest length over which one of the terms changes the index by its own size.
inline FieldFacts facts(const PolynomialIndex& field) {
  double inverse = 0;
  const auto add = [&](double term, double power) {
    if (term != 0) inverse = std::max(inverse, std::pow(std::abs(term), 1 / power));
  };
  bool is_guide = true;
  for (std::size_t k = 0; k < PolynomialIndex::most_terms; ++k) {
    const auto order = static_cast<double>(k + 1);
    add(field.radial[k], 2 * order);
    add(field.axial[k], order);
    add(field.beyond[k], order);
    is_guide &= field.axial[k] == 0 && field.beyond[k] == 0;
  }
  return {.scale = inverse > 0 ? 1 / inverse : 0,
          .symmetry = is_guide ? Symmetry::round_guide : Symmetry::none,
          .centre = field.vertex};
}

struct PolynomialValues {
  using Field = PolynomialIndex;
  static constexpr const char* word = "polynomial";
  static constexpr bool is_medium = true;
  double index = 1;
  std::vector<double> centre{0, 0, 0}, radial_terms{}, axial_terms{}, axial_terms_beyond{};
  std::optional<double> axial_break{};
};

inline void add_keys(Keys& keys, PolynomialValues& values) {
  add_index_key(keys, values.index, "n0 at the vertex");
  add_vector(keys, "centre", values.centre, "Vertex, where rho = z = 0; the axis is along z")
      .unit("length");
  keys.add("radial_terms", values.radial_terms,
           "Coefficients of rho^2, rho^4, ... in the index (at most 6)");
  keys.add("axial_terms", values.axial_terms,
           "Coefficients of z, z^2, ... in the index, z counted from the vertex (at most 6)");
  keys.add("axial_break", values.axial_break,
           "z1 above 0: beyond it, the axial sum is continued by axial_terms_beyond")
      .positive()
      .unit("length");
  keys.add("axial_terms_beyond", values.axial_terms_beyond,
           "Coefficients of z - z1, (z - z1)^2, ... beyond axial_break; the index is continuous "
           "there")
      .only_of("axial_break");
}

inline PolynomialIndex make_field(const Keys& keys, const PolynomialValues& values,
                                  const FieldUse&) {
  const auto terms_of = [&](const std::vector<double>& member) {
    PolynomialIndex::Terms terms{};
    const auto& given = keys.read(member);
    if (given.size() > terms.size())
      throw InputError(keys.name(member) + ": at most 6 coefficients are accepted");
    std::ranges::copy(given, terms.begin());
    return terms;
  };
  PolynomialIndex field{.vertex = vector_of(keys.read(values.centre)),
                        .vertex_excess = keys.read(values.index) - 1,
                        .radial = terms_of(values.radial_terms),
                        .axial = terms_of(values.axial_terms)};
  if (const auto& at = keys.read(values.axial_break)) {
    field.break_at = *at;
    field.excess_at_break = field.vertex_excess + PolynomialIndex::sum(field.axial, *at).value;
    field.beyond = terms_of(values.axial_terms_beyond);
  }
  return field;
}

}  // namespace flatspeckle::grin
