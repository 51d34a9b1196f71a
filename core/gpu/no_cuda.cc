// Instead of cuda_flights.cu in a program that is built without CUDA.
#include "core/gpu/flight_device.h"

namespace ballpiston {

absl::StatusOr<std::unique_ptr<FlightDevice>> OpenCuda() {
  return absl::UnimplementedError("the program was built without CUDA (BALLPISTON_CUDA)");
}

}  // namespace ballpiston
