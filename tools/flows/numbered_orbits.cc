#include "tools/flows/numbered_orbits.h"

#include <cstddef>
#include <span>

namespace ballpiston {
namespace {

class SourceOfNumbered : public OrbitSource {
 public:
  SourceOfNumbered(uint64_t count, NumberedOrbits& orbits, const std::stop_token& stop)
      : count_(count), orbits_(orbits), stop_(stop) {}

  size_t Start(std::span<OrbitStart> starts) override {
    size_t n = 0;
    for (; n < starts.size() && next_ < count_; ++n, ++next_) {
      starts[n] = {next_, orbits_.Start(next_)};
    }
    return n;
  }
  void Collide(std::span<OrbitCollision> collisions) override {
    for (auto& [orbit, collision, after] : collisions) after = orbits_.Collide(orbit, collision);
  }
  double TimeLimit() const override { return orbits_.TimeLimit(); }
  OrbitDevice* Device() const override { return orbits_.Device(); }
  bool Pause() override { return stop_.stop_requested(); }

 private:
  uint64_t count_;
  NumberedOrbits& orbits_;
  const std::stop_token& stop_;
  uint64_t next_ = 0;
};

}  // namespace

bool RunOrbits(Engine engine, const PairGeometry& geometry, uint64_t count, NumberedOrbits& orbits,
               const std::stop_token& stop) {
  SourceOfNumbered source(count, orbits, stop);
  return StartOrbits(engine, geometry, source)->Advance();
}

}  // namespace ballpiston
