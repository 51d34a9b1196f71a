// A device that flies many lanes at once (flight.h): a GPU, or a stand-in for it in tests.
//
// An error of a function means that the device cannot be used any more, or has not enough memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/gpu/flight.h"

namespace ballpiston {

// Lanes of one geometry. Not thread-safe; several batches of a device may be used at the same time.
class FlightBatch {
 public:
  virtual ~FlightBatch() = default;

  virtual size_t lanes() const = 0;

  // Begins to fly every lane for up to `bursts` bursts. A lane without an orbit takes the next of
  // the starts, if one is left. At most 2 lanes() starts, whose lifetime need not exceed the call.
  virtual absl::Status Launch(std::span<const FlightLane> starts, uint32_t bursts) = 0;

  struct Landing {
    size_t taken = 0;                            // of the starts
    std::span<const FlightReport> reports = {};  // in any order; valid until the next Launch
  };
  // Waits until all lanes have flown. Once after each Launch.
  virtual absl::StatusOr<Landing> Land() = 0;
};

// Thread-safe.
class FlightDevice {
 public:
  virtual ~FlightDevice() = default;

  virtual std::string name() const = 0;
  // As many lanes as keep the device busy.
  virtual size_t lanes() const = 0;
  virtual absl::StatusOr<std::unique_ptr<FlightBatch>> MakeBatch(const FlightProgram& program,
                                                                 size_t lanes) = 0;
};

// The first CUDA device. UNIMPLEMENTED if the program was built without CUDA, UNAVAILABLE if there
// is no device or no driver.
absl::StatusOr<std::unique_ptr<FlightDevice>> OpenCuda();

}  // namespace ballpiston
