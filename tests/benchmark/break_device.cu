#include "tests/benchmark/break_device.h"

#include <cuda_runtime.h>

#include <cstddef>

namespace ballpiston {
namespace {

__global__ void Trap() { asm("trap;"); }

}  // namespace

void FillDevice() {
  void* taken = nullptr;
  for (size_t bytes = size_t{1} << 36; bytes >= 4096; bytes /= 2) {
    while (cudaMalloc(&taken, bytes) == cudaSuccess) {
    }
  }
  cudaGetLastError();
}

void BreakDevice() { Trap<<<1, 1>>>(); }

}  // namespace ballpiston
