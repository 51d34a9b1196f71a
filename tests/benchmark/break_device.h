// A fault of a CUDA device, for gpu_benchmark.
#pragma once

namespace ballpiston {

// Takes the device's memory until the process ends.
void FillDevice();

// From then on all calls of this process to the device fail.
void BreakDevice();

}  // namespace ballpiston
