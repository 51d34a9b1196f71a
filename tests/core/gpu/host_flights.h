// A stand-in for a device: flies the lanes on the processor, and fails when a test wants it.
#pragma once

#include "core/gpu/flight_device.h"
#include "tests/support/preamble.h"

namespace ballpiston {

struct HostFaults {
  // The number of the call that fails, from 0, of all batches together.
  std::optional<int> make = {}, launch = {}, land = {};
  // Every so many launches each lane reports a collision that is none.
  std::optional<int> false_alarm = {};
};

class HostDevice : public FlightDevice {
 public:
  explicit HostDevice(size_t lanes, HostFaults faults = {}) : lanes_(lanes), faults_(faults) {}

  std::string name() const override { return "host"; }
  size_t lanes() const override { return lanes_; }

  absl::StatusOr<std::unique_ptr<FlightBatch>> MakeBatch(const FlightProgram& program,
                                                         size_t lanes) override {
    if (faults_.make == makes_++) return absl::ResourceExhaustedError("memory full");
    return std::make_unique<Batch>(*this, program, lanes);
  }

 private:
  class Batch : public FlightBatch {
   public:
    Batch(HostDevice& device, const FlightProgram& program, size_t lanes)
        : device_(device), program_(program), lanes_(lanes) {
      for (FlightLane& lane : lanes_) lane.orbit = kNoOrbit;
    }

    size_t lanes() const override { return lanes_.size(); }

    absl::Status Launch(std::span<const FlightLane> starts, uint32_t bursts) override {
      const int launch = device_.launches_++;
      if (device_.faults_.launch == launch) return absl::UnavailableError("no launch");
      starts_.assign(starts.begin(), starts.end());
      taken_ = 0;
      reports_.clear();
      const auto report = [&](const FlightReport& found) { reports_.push_back(found); };
      const auto next = [&](FlightLane& lane) {
        if (taken_ == starts_.size()) return false;
        lane = starts_[taken_++];
        return true;
      };
      const std::optional<int> alarm = device_.faults_.false_alarm;
      const bool alarms = alarm && launch % *alarm == 0;
      for (FlightLane& lane : lanes_) {
        if (alarms && lane.orbit != kNoOrbit) report(FalseAlarm(lane));
        FlyLane(program_, bursts, lane, next, report);
      }
      return absl::OkStatus();
    }

    absl::StatusOr<Landing> Land() override {
      if (device_.faults_.land == device_.landings_++) return absl::UnavailableError("device lost");
      return Landing{taken_, reports_};
    }

   private:
    FlightReport FalseAlarm(FlightLane& lane) const {
      FlightReport report = {lane, 0, 0, FlightNews::kMayHaveMet};
      FlightBall ball = lane.ball;
      Fly(program_, ball);
      report.path_after = ball.path;
      lane.orbit = kNoOrbit;
      return report;
    }

    HostDevice& device_;
    const FlightProgram program_;
    std::vector<FlightLane> lanes_, starts_;
    std::vector<FlightReport> reports_;
    size_t taken_ = 0;
  };

  const size_t lanes_;
  const HostFaults faults_;
  std::atomic<int> makes_ = 0, launches_ = 0, landings_ = 0;
};

}  // namespace ballpiston
