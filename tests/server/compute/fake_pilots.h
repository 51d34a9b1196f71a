// Points that need a pilot before their model is known. Points and pilots are fake experiments.
#pragma once

#include "server/compute/point_opener.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {

inline EnsembleSpec FakePilotSpec() { return FakeSpec(1, 200, 99); }

// A fake experiment whose first estimate has a limit, as that of a pilot.
class FakePilot : public PointExperiment {
 public:
  static constexpr double kLimit = 0.4;

  explicit FakePilot(BeforeBlock before_block = nullptr)
      : FakePilot(FakeExperiments(std::move(before_block))(FakePilotSpec(), 0)) {}

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override {
    return fake_->StartRun(queue);
  }
  uint64_t CountsOfASample() const override { return fake_->CountsOfASample(); }

 private:
  explicit FakePilot(std::unique_ptr<const PointExperiment> fake)
      : PointExperiment(FakePilotSpec(), PointAt(FakePilotSpec(), 0), fake->plan()),
        fake_(std::move(fake)) {
    SetMeasurements(fake_->EmptyResult(),
                    {{.name = "mean",
                      .reading = [this](const BlockResult& m) { return fake_->FirstEstimate(m); },
                      .limit = kLimit}});
  }

  const std::unique_ptr<const PointExperiment> fake_;
};

// The place of a point's pilot; empty if the point needs none.
using PlaceOfPoint = std::function<std::optional<PilotPlace>(const EnsembleSpec&, size_t index)>;

class FakePilotOpener : public PointOpener {
 public:
  explicit FakePilotOpener(PlaceOfPoint place_of, BeforeBlock before_pilots_block = nullptr)
      : place_of_(std::move(place_of)), before_pilots_block_(std::move(before_pilots_block)) {}

  OpenedPoint Open(const EnsembleSpec& spec, size_t index) override {
    const std::optional<PilotPlace> place = place_of_(spec, index);
    std::lock_guard lock(mutex_);
    if (place && !kept_.contains(*place)) return *place;
    return FakeExperiments()(spec, index);
  }

  std::unique_ptr<const PointExperiment> OpenPilot(const PilotPlace&) override {
    std::lock_guard lock(mutex_);
    ++opened_;
    return std::make_unique<const FakePilot>(before_pilots_block_);
  }

  void KeepPilot(const PilotPlace& place, const Pilot& pilot) override {
    std::lock_guard lock(mutex_);
    kept_[place].push_back(pilot);
  }

  int opened() const {
    std::lock_guard lock(mutex_);
    return opened_;
  }

  // The results of each pilot; more than one if it was computed more than once.
  std::map<PilotPlace, std::vector<Pilot>> kept() const {
    std::lock_guard lock(mutex_);
    return kept_;
  }

 private:
  const PlaceOfPoint place_of_;
  const BeforeBlock before_pilots_block_;
  mutable std::mutex mutex_;
  int opened_ = 0;  // pilots that began
  std::map<PilotPlace, std::vector<Pilot>> kept_;
};

}  // namespace ballpiston::server
