#include "mc/paths/speckle/camera_ends.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "mc/paths/estimators/path_endpoints.h"

namespace flatspeckle::mc {

namespace {

class EndScorer : public TallyScorer<ChangeTally> {
 public:
  EndScorer(const PathWalks& walks, const FieldChanges& changes, const RandomStream& random,
            const EndSink& sink)
      : EndScorer(walks, std::make_unique<ChangeDraw>(walks.scene(), changes), random, sink) {}

  void single(Vec x, double weight, FaceWaves waves) override {
    lights_->choose(waves.light);
    lights_->attenuate(x, last_);
    const Complex factor = draw_factor(weight);
    const auto changed = changes_->draw_single(x, random_);
    std::vector<Complex> only(last_.size());
    for (std::size_t s = 0; s < changed.size(); ++s)
      for (std::size_t i = 0; i < last_.size(); ++i) {
        only[i] = product(factor, last_[i] * moved_phase(i, changed[s].first_move));
        PathEnd end(x, -lights_->direction(i), x + changed[s].first_move);
        end.wave = waves.view;
        sink_(end, only, s * last_.size());
        only[i] = 0;
      }
  }
  void multiple(const Path& path) override {
    const Complex factor = draw_factor(path.weight);
    const auto changed = changes_->draw(path, tally(), random_);
    lights_->choose(path.waves.light);
    if (path.new_start) light(path.first, -path.start, first_);
    const bool reversed = walks_.plan().reversed;
    if (reversed) light(path.last, path.arrival, last_);
    for (std::size_t s = 0; s < changed.size(); ++s) {
      const auto& [first_move, last_move, turn] = changed[s];
      const Complex turned = product(factor, turn);
      PathEnd end(path.last, path.arrival, path.last + last_move);
      end.wave = path.waves.view;
      add(end, turned, first_, first_move, s);
      if (!reversed) continue;
      end = {path.first, -path.start, path.first + first_move};
      end.wave = path.waves.view;
      add(end, turned, last_, last_move, s);
    }
  }

 private:
  EndScorer(const PathWalks& walks, std::unique_ptr<ChangeDraw> changes, const RandomStream& random,
            const EndSink& sink)
      : TallyScorer(changes->no_tally()),
        walks_(walks),
        random_(random),
        sink_(sink),
        changes_(std::move(changes)),
        lights_(walks.factors(walks.scene(), light_endpoints(walks.scene()), true)),
        first_(lights_->size()),
        last_(lights_->size()),
        scaled_(lights_->size()) {}

  Complex draw_factor(double weight) {
    return std::polar(std::sqrt(weight), 2 * std::numbers::pi * random_.uniform());
  }
  void light(Vec x, Vec arrival, std::vector<Complex>& field) {
    lights_->attenuate(x, field);
    walks_.towards(x, arrival, lights_->directions(), field);
  }
  /// Returns the factor of plane wave i for a scatterer that has moved.
  Complex moved_phase(std::size_t i, Vec move) const {
    return move == Vec{} ? 1
                         : std::polar(1.0, -walks_.scene().k * dot(lights_->direction(i), move));
  }
  void add(const PathEnd& end, Complex factor, const std::vector<Complex>& lights, Vec move,
           std::size_t change) {
    for (std::size_t i = 0; i < lights.size(); ++i)
      scaled_[i] = product(factor, product(lights[i], moved_phase(i, move)));
    sink_(end, scaled_, change * lights.size());
  }

  const PathWalks& walks_;
  RandomStream random_;
  const EndSink& sink_;
  std::unique_ptr<ChangeDraw> changes_;
  std::unique_ptr<EndpointFactors> lights_;
  std::vector<Complex> first_, last_, scaled_;
};

}  // namespace

void each_end(const PathWalks& walks, std::uint64_t batch, const FieldChanges& changes,
              const RandomStream& random, const EndSink& sink) {
  EndScorer scorer(walks, changes, random, sink);
  walks.batch(batch, scorer);
}

}  // namespace flatspeckle::mc
