// Orbits whose flights a device computes (flight_device.h). A processor draws the starts, computes
// the collisions and calls the source; so random numbers and elementary functions are the same as
// without a device, and so are the bits, which are those of the lanes (billiard/lane_orbits.cc) on
// a processor with fused multiply-add.
//
// If the device fails, the orbits that are in progress start again from their last collisions in
// the lanes of the processor, to the same bits, and so do all later runs.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>

#include "absl/status/status.h"
#include "core/billiard/lane_frame.h"
#include "core/billiard/orbits.h"
#include "core/gpu/flight_device.h"

namespace ballpiston {

FlightProgram ProgramOf(const PairGeometry& geometry);
FlightBall BallOf(const LaneFrame& frame);  // both in the lanes' units

// Thread-safe.
class OrbitsOnDevice : public OrbitDevice {
 public:
  // `runs` runs at the same time keep the device busy. `on_failure` is called once, by the thread
  // that finds the failure.
  OrbitsOnDevice(std::unique_ptr<FlightDevice> device, size_t runs,
                 std::function<void(const absl::Status&)> on_failure);

  const FlightDevice& device() const { return *device_; }
  bool has_failed() const { return has_failed_; }

  uint64_t orbits() const override { return runs_ * lanes_; }
  std::unique_ptr<EngineRun> Start(const PairGeometry& geometry, OrbitSource& source) override;

 private:
  void Fail(const absl::Status& status);

  const std::unique_ptr<FlightDevice> device_;
  const size_t runs_;
  const size_t lanes_;  // of a run
  const std::function<void(const absl::Status&)> on_failure_;
  std::atomic<bool> has_failed_ = false;
};

}  // namespace ballpiston
