// Computes several blocks of orbits at once in one engine. When an orbit ends, its lane takes an
// orbit of the next block, so lanes stay full even if a block has few orbits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/ensemble/block_run.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

// `Orbits` is the class of one block's orbits:
//   uint64_t count() const;                                     at least 1
//   PairState Start(uint64_t orbit);                            called once for each orbit
//   AfterContact Meet(uint64_t orbit, const Contact& contact);
//   BlockResult Result() const;                                 called after all orbits have ended
// `Make` makes the orbits of a block: Orbits make(const Block&).
template <typename Orbits, typename Make>
class BlockOrbits : public BlockRun, private OrbitSource {
 public:
  BlockOrbits(Engine engine, const PairGeometry& geometry, double time_limit, Make make,
              BlockQueue& queue)
      : time_limit_(time_limit),
        make_(std::move(make)),
        queue_(queue),
        run_(StartOrbits(engine, geometry, *this)) {}

  bool Advance() override { return run_->Advance(); }

 private:
  struct OpenBlock {
    Block block;
    Orbits orbits;
    uint64_t running;
  };

  // An orbit's number in the engine: the place of its block in open_, then its number in the block.
  static constexpr int kBitsOfOrbit = 32;
  static constexpr uint64_t kOrbitMask = (uint64_t{1} << kBitsOfOrbit) - 1;

  size_t Start(std::span<OrbitStart> starts) override {
    size_t n = 0;
    for (; n < starts.size() && HasNext(); ++n, ++next_) {
      starts[n] = {place_ << kBitsOfOrbit | next_, open_[place_]->orbits.Start(next_)};
    }
    return n;
  }

  bool HasNext() {
    if (next_ < count_) return true;
    const std::optional<Block> block = queue_.Next();
    if (!block) return false;
    for (place_ = 0; place_ < open_.size() && open_[place_] != nullptr;) ++place_;
    if (place_ == open_.size()) open_.emplace_back();
    Orbits orbits = make_(*block);
    count_ = orbits.count();
    open_[place_] = std::make_unique<OpenBlock>(OpenBlock{*block, std::move(orbits), count_});
    next_ = 0;
    return true;
  }

  void Meet(std::span<Meeting> meetings) override {
    for (Meeting& meeting : meetings) {
      const Contact& contact = meeting.contact;
      std::unique_ptr<OpenBlock>& open = open_[meeting.orbit >> kBitsOfOrbit];
      meeting.after = open->orbits.Meet(meeting.orbit & kOrbitMask, contact);
      const bool ends = meeting.after == AfterContact::kEnd || contact.escaped || contact.expired;
      if (ends && --open->running == 0) Deliver(*std::exchange(open, nullptr));
    }
  }

  void Deliver(const OpenBlock& open) { queue_.Done(open.block, open.orbits.Result()); }

  double TimeLimit() const override { return time_limit_; }
  bool Pause() override { return queue_.Pause(); }

  double time_limit_;
  Make make_;
  BlockQueue& queue_;
  std::vector<std::unique_ptr<OpenBlock>> open_;
  size_t place_ = 0;    // in open_, of the block whose orbits are being started
  uint64_t next_ = 0;   // the next orbit of that block
  uint64_t count_ = 0;  // the number of orbits of that block
  std::unique_ptr<OrbitRun> run_;
};

template <typename Make>
std::unique_ptr<BlockRun> RunBlockOrbits(Engine engine, const PairGeometry& geometry,
                                         double time_limit, Make make, BlockQueue& queue) {
  using Orbits = decltype(make(Block()));
  return std::make_unique<BlockOrbits<Orbits, Make>>(engine, geometry, time_limit, std::move(make),
                                                     queue);
}

}  // namespace ballpiston
