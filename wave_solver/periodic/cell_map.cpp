#include "wave_solver/periodic/cell_map.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"
#include "wave_solver/periodic/matrix_job.h"

namespace flatspeckle::wave {

namespace {

using Amplitudes = std::vector<Complex>;  // of the light channels of the front, with unit flux

struct MappedLight {
  Amplitudes wave;
  double transmittance;
};

std::vector<MappedLight> mapped_lights(const ScatteringMatrix& found, const CellLights& asked) {
  const std::size_t n = found.channels.size();
  const auto t = found.quarter(false, true);
  const auto normal = std::ranges::min_element(
      found.channels, {}, [](const CellChannel& channel) { return std::abs(channel.sine); });
  const auto a = static_cast<std::size_t>(normal - found.channels.begin());
  const auto transmittance = [&](const Amplitudes& wave) {
    double transmitted = 0, power = 0;
    for (std::size_t b = 0; b < n; ++b) {
      Complex sum = 0;
      for (std::size_t c = 0; c < n; ++c) sum += t[b + n * c] * wave[c];
      transmitted += std::norm(sum);
      power += std::norm(wave[b]);
    }
    return transmitted / power;
  };
  Amplitudes one(n);
  one[a] = 1;
  std::vector<MappedLight> lights = {{one, transmittance(one)}};
  const Eigenchannels all = eigenchannels(t, n);
  for (const std::int64_t number : asked.eigenchannels) {
    const auto m = static_cast<std::size_t>(number);
    lights.push_back({all.waves[m], all.eigenvalues[m]});
  }
  for (const Amplitudes& wave : asked.own) lights.push_back({wave, transmittance(wave)});
  return lights;
}

std::vector<PlaneWave> incident(const ScatteringMatrix& found, const Amplitudes& light) {
  std::vector<PlaneWave> waves;
  for (std::size_t a = 0; a < light.size(); ++a) {
    const auto& [number, sine, cosine] = found.channels[a];
    waves.push_back({{sine, cosine}, light[a] / std::sqrt(cosine), {}});
  }
  return waves;
}

// Repeats the coefficients of all lights for the near copies, in the order of with_copies().
Amplitudes repeated(const Amplitudes& x, std::size_t n, const Copies& copies) {
  Amplitudes all;
  for (std::size_t first = 0; first < x.size(); first += n) {
    const auto append = [&](Complex factor) {
      for (std::size_t i = 0; i < n; ++i) all.push_back(factor * x[first + i]);
    };
    append(1);
    for (int m = 1; m <= copies.count; ++m)
      for (const int side : {-m, m}) append(copies.factor(side));
  }
  return all;
}

}  // namespace

CellLights cell_lights(std::vector<std::int64_t> eigenchannels, const std::string& file,
                       std::size_t channels) {
  const auto require = [](const char* key, std::int64_t number, std::size_t count) {
    if (!(number >= 0 && number < static_cast<std::int64_t>(count)))
      throw InputError(key, number,
                       "must be less than the number of channels, " + std::to_string(count));
  };
  for (const std::int64_t number : eigenchannels) require("map_eigenchannels", number, channels);
  CellLights lights{std::move(eigenchannels), {}};
  if (file.empty()) return lights;
  const std::string columns[] = {"light", "channel", "re", "im"};
  const Table table = read_key_table("map_lights", file, {std::begin(columns), std::end(columns)});
  const auto light = table.column(columns[0]), channel = table.column(columns[1]),
             re = table.column(columns[2]), im = table.column(columns[3]);
  constexpr double most = 1000;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!(light[row] >= 0 && light[row] < most && light[row] == std::floor(light[row])))
      throw InputError("map_lights", file,
                       "column light: " + number_text(light[row]) + " must be 0, 1, ... 999");
    if (channel[row] != std::floor(channel[row]) || std::abs(channel[row]) > 1e9)
      throw InputError("map_lights", file,
                       "column channel: " + number_text(channel[row]) + " must be an integer");
    require("map_lights, column channel", static_cast<std::int64_t>(channel[row]), channels);
    const auto number = static_cast<std::size_t>(light[row]);
    if (lights.own.size() <= number) lights.own.resize(number + 1, Amplitudes(channels));
    lights.own[number][static_cast<std::size_t>(channel[row])] = {re[row], im[row]};
  }
  for (std::size_t i = 0; i < lights.own.size(); ++i)
    if (std::ranges::all_of(lights.own[i], [](Complex a) { return a == 0.0; }))
      throw InputError("map_lights", file, "light " + std::to_string(i) + " has no power");
  return lights;
}

// Bases are large enough for points at the rims of all scatterers.
std::string write_cell_map(ResultFile& file, const Placement& placement, double k,
                           const CellImages& images, const ScatteringMatrix& found,
                           const CellLights& asked, const SolveOptions& options,
                           const MapGrid& grid) {
  std::vector<Vec> rims;
  for (const auto& [centre, scatterer] : placement)
    if (scatterer.is_disk()) rims.push_back(centre + Vec{scatterer.radius, 0});
  const PeriodicCell cell(placement, k, images, options.tolerance, rims);
  const std::size_t n = cell.unknowns();
  std::vector<std::vector<PlaneWave>> lights;
  Amplitudes rhs, amplitudes;
  std::vector<double> transmittance;
  for (const MappedLight& light : mapped_lights(found, asked)) {
    amplitudes.insert(amplitudes.end(), light.wave.begin(), light.wave.end());
    transmittance.push_back(light.transmittance);
    lights.push_back(incident(found, light.wave));
    const auto side = cell.right_hand_side(lights.back());
    rhs.insert(rhs.end(), side.begin(), side.end());
  }
  Amplitudes x;
  if (n > 0) {
    EquationSolver solver(cell.equations(), cell_method(n, options), options.tolerance);
    auto solution = cell.solve(cell.whole(solver), rhs);
    for (std::size_t light = 0; light < lights.size(); ++light) {
      const auto more = cell.image_field(solution, light);
      lights[light].insert(lights[light].end(), more.begin(), more.end());
    }
    x = repeated(solution.x, n, cell.near().copies());
  }
  file.bind("LIGHT", {"map_wave"});
  const ResultGroup root(file, scattering_matrix_table);
  root.number("map_wave", lights.size());
  root.attribute("map_wave", "eigenchannels",
                 static_cast<std::int64_t>(asked.eigenchannels.size()));
  root.put("map_light", amplitudes);
  root.put("map_transmittance", transmittance);
  const TMatrixSystem all = cell.near().with_explicit_copies();
  return write_map(file, {&all, std::move(lights), x}, grid, options.tolerance);
}

}  // namespace flatspeckle::wave
