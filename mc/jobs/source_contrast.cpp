#include "mc/jobs/source_contrast.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/numbers/constants.h"
#include "core/numbers/gauss.h"

namespace flatspeckle::mc {

SourceLine SourceLine::gaussian(double width) {
  return {Shape::gaussian, width};
}

SourceLine SourceLine::lorentzian(double width) {
  return {Shape::lorentzian, width};
}

SourceLine SourceLine::table(const std::vector<double>& frequencies,
                             const std::vector<double>& power) {
  const double half = *std::ranges::max_element(power) / 2;
  double area = 0, least = frequencies.back() - frequencies.front();
  std::vector<double> crossings;
  for (std::size_t i = 0; i + 1 < power.size(); ++i) {
    const double step = frequencies[i + 1] - frequencies[i];
    area += step * (power[i] + power[i + 1]) / 2;
    least = std::min(least, step);
    if (power[i] >= half) crossings.push_back(frequencies[i]);
    if ((power[i] < half) != (power[i + 1] < half))
      crossings.push_back(frequencies[i] + step * (half - power[i]) / (power[i + 1] - power[i]));
  }
  if (power.back() >= half) crossings.push_back(frequencies.back());
  SourceLine line(Shape::table, crossings.back() - crossings.front());
  line.scale_ = least;
  line.frequency_ = frequencies;
  for (const double value : power) line.power_.push_back(value / area);
  return line;
}

namespace {

/// Returns the integral of s(y) s(y + x) over y for a piecewise linear s.
double overlap(const std::vector<double>& y, const std::vector<double>& s, double x) {
  const auto at = [&](double place) {
    if (place <= y.front() || place >= y.back()) {
      if (place == y.front()) return s.front();
      return place == y.back() ? s.back() : 0;
    }
    const auto i = static_cast<std::size_t>(std::ranges::upper_bound(y, place) - y.begin());
    return s[i - 1] + (s[i] - s[i - 1]) * (place - y[i - 1]) / (y[i] - y[i - 1]);
  };
  std::vector<double> ends;
  for (const double node : y)
    for (const double end : {node, node - x})
      if (end >= y.front() && end + x <= y.back()) ends.push_back(end);
  std::ranges::sort(ends);
  double sum = 0;
  static const QuadratureRule rule = gauss_legendre(2);  // exact for products of linear functions
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      const double step = ends[i + 1] - ends[i], place = ends[i] + step * rule.node[n];
      sum += step * rule.weight[n] * at(place) * at(place + x);
    }
  return sum;
}

}  // namespace

double SourceLine::operator()(double x) const {
  switch (shape_) {
    case Shape::gaussian: {
      // The variance of A is twice that of s.
      const double exponent = 2 * std::numbers::ln2 * std::pow(x / width_, 2);
      return std::sqrt(8 * std::numbers::ln2 / std::numbers::pi) / width_ * std::exp(-exponent);
    }
    case Shape::lorentzian:
      // The half width of A is the full width of s.
      return 2 / std::numbers::pi * width_ / (width_ * width_ + x * x);
    case Shape::table:
      break;
  }
  return 2 * overlap(frequency_, power_, x);
}

namespace {

/// Places and weights of a quadrature of A(x) f(x) over [0, last]. The sum of the weights is the
/// integral of A.
struct LineQuadrature {
  std::vector<double> place, weight;
};

/// Integrates in the square root of x, in which the logarithm of a DecayCurve is a polynomial
/// between its roots.
LineQuadrature line_quadrature(const SourceLine& line, const DecayCurve& curve) {
  constexpr double step = 1.3, first = 0.2;
  const double last = std::sqrt(curve.last());
  std::vector<double> ends = curve.roots();
  for (double end = std::sqrt(first * line.scale()); end < last; end *= step) ends.push_back(end);
  std::ranges::sort(ends);
  static const QuadratureRule rule = gauss_legendre(6);
  LineQuadrature found;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      const double width = ends[i + 1] - ends[i], root = ends[i] + width * rule.node[n];
      found.place.push_back(root * root);
      found.weight.push_back(width * rule.weight[n] * 2 * root * line(root * root));
    }
  return found;
}

LineContrast contrast(const LineQuadrature& line, const DecayCurve& curve) {
  const DecayCurve coarse = curve.coarser();
  double value = 0, coarse_value = 0, beyond = 1;
  for (std::size_t i = 0; i < line.place.size(); ++i) {
    value += line.weight[i] * curve(line.place[i]);
    coarse_value += line.weight[i] * coarse(line.place[i]);
    beyond -= line.weight[i];
  }
  // With twice the steps cubic interpolation has about 16 times the error; half of the difference
  // is on the safe side.
  const double interpolation = std::abs(value - coarse_value) / 2,
               truncation = std::max(beyond, 0.0) * curve(curve.last()) / 2;
  return {value + truncation, interpolation + truncation, truncation};
}

}  // namespace

LineContrast line_contrast(const SourceLine& line, const DecayCurve& curve) {
  return contrast(line_quadrature(line, curve), curve);
}

void add_keys(Keys& keys, LineValues& values) {
  keys.add("linewidths", values.linewidths,
           "Also estimate the contrast of the speckle of sources with these widths of their "
           "spectrum (FWHM), written like frequency_shifts, which must cover the decay of C_I or "
           "the width")
      .only_of(
          "frequency_shifts with covariance = intensity and line_shape = gaussian or lorentzian");
  keys.add("line_shape", values.line_shape, "Spectrum of the sources; table: line_table")
      .one_of({"gaussian", "lorentzian", "table"})
      .only_of("frequency_shifts with linewidths or line_table");
  keys.add("line_table", values.line_table,
           "CSV with the spectrum of a source: a column power, and shift (relative to the "
           "frequency of the light), frequency (Hz) or wavelength_nm (in vacuum)")
      .file()
      .only_of("line_shape = table");
}

namespace {

/// Returns the relative frequencies and the power per relative frequency of a table, in ascending
/// order.
std::vector<std::pair<double, double>> spectrum(const std::string& path, const Table& table,
                                                const std::optional<double>& optical) {
  const bool relative = table.has("shift"), nanometres = table.has("wavelength_nm");
  if (relative + nanometres + table.has("frequency") != 1)
    throw InputError("line_table", path,
                     "must have exactly one of the columns shift, frequency, wavelength_nm");
  if (!relative && !optical)
    throw InputError("line_table", path,
                     "requires medium_index and length_unit, or a column shift of frequencies "
                     "relative to that of the light");
  const auto place = table.column(relative ? "shift" : nanometres ? "wavelength_nm" : "frequency");
  const auto power = table.column("power");
  std::vector<std::pair<double, double>> line;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    if (relative) line.emplace_back(place[i], power[i]);
    if (!relative && !nanometres) line.emplace_back(place[i] / *optical, power[i]);
    if (!nanometres) continue;
    const double share = light_speed / *optical / (1e-9 * place[i]);  // own frequency / optical
    line.emplace_back(share - 1, power[i] / (share * share));
  }
  std::ranges::sort(line);
  return line;
}

SourceLine table_line(const std::string& path, const std::optional<double>& optical) {
  constexpr std::size_t most_rows = 2000;
  const auto refuse = [&](const std::string& what) { throw InputError("line_table", path, what); };
  const Table table =
      read_key_table("line_table", path, {"shift", "frequency", "wavelength_nm", "power"});
  if (table.rows() < 2 || table.rows() > most_rows)
    refuse("must have 2 to " + std::to_string(most_rows) + " rows");
  std::vector<double> frequencies, power;
  for (const auto& [frequency, value] : spectrum(path, table, optical)) {
    frequencies.push_back(frequency);
    power.push_back(value);
  }
  if (std::ranges::adjacent_find(frequencies) != frequencies.end())
    refuse("has the same frequency twice");
  if (!std::isfinite(frequencies.back())) refuse("column wavelength_nm must be positive");
  if (*std::ranges::min_element(power) < 0 || *std::ranges::max_element(power) == 0)
    refuse("column power must not be negative, and not 0 everywhere");
  return SourceLine::table(frequencies, power);
}

}  // namespace

std::vector<SourceLine> source_lines(const Keys& keys, const LineValues& values,
                                     const std::optional<double>& optical) {
  const bool is_table = values.line_shape == "table";
  if (!is_table && values.linewidths.empty()) return {};
  if (keys.read(values.line_shape); is_table)
    return {table_line(keys.required(values.line_table), optical)};
  std::vector<SourceLine> lines;
  for (const double width : relative_frequencies("linewidths", keys.read(values.linewidths),
                                                 optical, FrequencyKind::width)) {
    if (!(width > 0 && width < 1))
      throw InputError("linewidths", width, "must be above 0 and below the frequency of the light");
    lines.push_back(values.line_shape == "gaussian" ? SourceLine::gaussian(width)
                                                    : SourceLine::lorentzian(width));
  }
  return lines;
}

SourceContrast source_contrast(const CovarianceRequest& request, const PathJob& job,
                               const GroupedSums& sums, const std::vector<double>& shifts,
                               const std::vector<SourceLine>& lines) {
  const std::size_t channels = request.entries.size();
  const std::vector<double> side = one_side(shifts);
  const auto curve = [&](std::span<const Complex> all, std::size_t channel) {
    return DecayCurve(side, squared_correlation(all, channels, channel));
  };
  const DecayCurve steps(side, std::vector<double>(side.size()));
  std::vector<LineQuadrature> quadratures;
  for (const SourceLine& line : lines) quadratures.push_back(line_quadrature(line, steps));
  SourceContrast found;
  found.squares = jackknife(sums, [&](double samples, std::span<const Complex> total) {
    const std::vector<Complex> all = job.all(samples, total);
    std::vector<Complex> values;
    for (const LineQuadrature& line : quadratures)
      for (std::size_t c = 0; c < channels; ++c)
        values.emplace_back(contrast(line, curve(all, c)).value);
    return values;
  });
  const std::vector<Complex> all = job.all(sums.total_samples(), sums.total());
  for (std::size_t i = 0; i < found.squares.value.size(); ++i) {
    const LineContrast own = contrast(quadratures[i / channels], curve(all, i % channels));
    found.squares.error[i] = std::hypot(found.squares.error[i], own.error);
    if (own.value > 0) found.truncation = std::max(found.truncation, own.truncation / own.value);
  }
  return found;
}

}  // namespace flatspeckle::mc
