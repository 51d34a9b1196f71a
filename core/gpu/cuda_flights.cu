// flight_device.h in CUDA: one orbit a thread. A thread whose orbit ends takes the next start, so
// the lanes of a warp stay full.
//
// The starts of a launch go to the device before it. The reports come back after it: as many as came
// after the previous launch in one copy behind the kernel, and the rest, if there are more, later.
#include <cuda_runtime.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/gpu/flight_device.h"

namespace ballpiston {
namespace {

constexpr unsigned kThreads = 128;  // of a block
// Blocks of a multiprocessor, which bounds the registers of a thread. Measured: docs/speed.md.
constexpr unsigned kBlocksAtOnce = 7;

// Of a launch; on the device.
struct Counts {
  uint32_t taken;  // starts, or more if lanes found none
  uint32_t reports;
};

__global__ void __launch_bounds__(kThreads, kBlocksAtOnce)
    FlyLanes(const __grid_constant__ FlightProgram program, const uint32_t bursts, FlightLane* lanes,
             const uint32_t count, const FlightLane* starts, const uint32_t starts_count,
             FlightReport* reports, Counts* counts) {
  const uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  if (i >= count) return;
  FlightLane lane = lanes[i];
  const auto next = [&](FlightLane& free) {
    const uint32_t start = atomicAdd(&counts->taken, 1u);
    if (start >= starts_count) return false;
    free = starts[start];
    return true;
  };
  const auto report = [&](const FlightReport& found) {
    reports[atomicAdd(&counts->reports, 1u)] = found;
  };
  FlyLane(program, bursts, lane, next, report);
  lanes[i] = lane;
}

absl::Status Checked(cudaError_t error, const char* what) {
  if (error == cudaSuccess) return absl::OkStatus();
  const std::string text = absl::StrCat(what, ": ", cudaGetErrorString(error));
  cudaGetLastError();  // forgets an error that leaves the device usable
  return error == cudaErrorMemoryAllocation ? absl::ResourceExhaustedError(text)
                                            : absl::UnavailableError(text);
}

template <typename T>
class DeviceArray {
 public:
  ~DeviceArray() { cudaFree(data_); }
  cudaError_t Allocate(size_t n) { return cudaMalloc(&data_, n * sizeof(T)); }
  T* data() const { return data_; }

 private:
  T* data_ = nullptr;
};

// Memory of this machine that a copy in a stream can use without waiting.
template <typename T>
class PinnedArray {
 public:
  ~PinnedArray() { cudaFreeHost(data_); }
  cudaError_t Allocate(size_t n) { return cudaMallocHost(&data_, n * sizeof(T)); }
  T* data() const { return data_; }

 private:
  T* data_ = nullptr;
};

class CudaBatch : public FlightBatch {
 public:
  CudaBatch(const FlightProgram& program, size_t lanes) : program_(program), lanes_(lanes) {}

  ~CudaBatch() override {
    if (stream_ == nullptr) return;
    cudaStreamSynchronize(stream_);
    cudaEventDestroy(landed_);
    cudaStreamDestroy(stream_);
  }

  absl::Status Init() {
    const cudaError_t results[] = {
        cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking),
        cudaEventCreateWithFlags(&landed_, cudaEventBlockingSync | cudaEventDisableTiming),
        on_device_.lanes.Allocate(lanes_),
        on_device_.starts.Allocate(MostStarts()),
        on_device_.reports.Allocate(MostReports()),
        on_device_.counts.Allocate(1),
        starts_.Allocate(MostStarts()),
        reports_.Allocate(MostReports()),
        counts_.Allocate(1)};
    for (const cudaError_t result : results) {
      if (result != cudaSuccess) return Checked(result, "memory of the device");
    }
    const size_t bytes = lanes_ * sizeof(FlightLane);  // every orbit becomes kNoOrbit
    return Checked(cudaMemsetAsync(on_device_.lanes.data(), 0xff, bytes, stream_), "memory");
  }

  size_t lanes() const override { return lanes_; }

  absl::Status Launch(std::span<const FlightLane> starts, uint32_t bursts) override {
    offered_ = std::min(starts.size(), MostStarts());
    std::copy_n(starts.begin(), offered_, starts_.data());
    cudaMemcpyAsync(on_device_.starts.data(), starts_.data(), offered_ * sizeof(FlightLane),
                    cudaMemcpyHostToDevice, stream_);
    cudaMemsetAsync(on_device_.counts.data(), 0, sizeof(Counts), stream_);
    const auto blocks = static_cast<unsigned>((lanes_ + kThreads - 1) / kThreads);
    FlyLanes<<<blocks, kThreads, 0, stream_>>>(
        program_, bursts, on_device_.lanes.data(), static_cast<uint32_t>(lanes_),
        on_device_.starts.data(), static_cast<uint32_t>(offered_), on_device_.reports.data(),
        on_device_.counts.data());
    cudaMemcpyAsync(counts_.data(), on_device_.counts.data(), sizeof(Counts),
                    cudaMemcpyDeviceToHost, stream_);
    cudaMemcpyAsync(reports_.data(), on_device_.reports.data(), expected_ * sizeof(FlightReport),
                    cudaMemcpyDeviceToHost, stream_);
    cudaEventRecord(landed_, stream_);
    return Checked(cudaGetLastError(), "launch");
  }

  absl::StatusOr<Landing> Land() override {
    const absl::Status landed = Checked(cudaEventSynchronize(landed_), "flights");
    if (!landed.ok()) return landed;
    const size_t count = counts_.data()->reports;
    if (count > expected_) {
      cudaMemcpyAsync(reports_.data() + expected_, on_device_.reports.data() + expected_,
                      (count - expected_) * sizeof(FlightReport), cudaMemcpyDeviceToHost, stream_);
      const absl::Status copied = Checked(cudaStreamSynchronize(stream_), "reports");
      if (!copied.ok()) return copied;
    }
    expected_ = std::min(count + count / 8, MostReports());
    return Landing{std::min<size_t>(counts_.data()->taken, offered_), {reports_.data(), count}};
  }

 private:
  size_t MostStarts() const { return 2 * lanes_; }
  size_t MostReports() const { return lanes_ + MostStarts(); }

  const FlightProgram program_;
  const size_t lanes_;
  cudaStream_t stream_ = nullptr;
  cudaEvent_t landed_ = nullptr;
  struct {
    DeviceArray<FlightLane> lanes, starts;
    DeviceArray<FlightReport> reports;
    DeviceArray<Counts> counts;
  } on_device_;
  PinnedArray<FlightLane> starts_;
  PinnedArray<FlightReport> reports_;
  PinnedArray<Counts> counts_;
  size_t offered_ = 0;   // starts of the last launch
  size_t expected_ = 0;  // reports of a launch
};

class CudaDevice : public FlightDevice {
 public:
  CudaDevice(std::string name, size_t lanes) : name_(std::move(name)), lanes_(lanes) {}

  std::string name() const override { return name_; }
  size_t lanes() const override { return lanes_; }

  absl::StatusOr<std::unique_ptr<FlightBatch>> MakeBatch(const FlightProgram& program,
                                                         size_t lanes) override {
    auto batch = std::make_unique<CudaBatch>(program, (lanes + kThreads - 1) / kThreads * kThreads);
    const absl::Status status = batch->Init();
    if (!status.ok()) return status;
    return batch;
  }

 private:
  const std::string name_;
  const size_t lanes_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<FlightDevice>> OpenCuda() {
  cudaDeviceProp found{};
  int blocks = 0;
  cudaError_t error = cudaGetDeviceProperties(&found, 0);
  if (error == cudaSuccess) error = cudaSetDeviceFlags(cudaDeviceScheduleBlockingSync);
  if (error == cudaSuccess) {
    error = cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, FlyLanes, kThreads, 0);
  }
  if (error != cudaSuccess) return Checked(error, "no CUDA device");
  const auto multiprocessors = static_cast<size_t>(found.multiProcessorCount);
  return std::make_unique<CudaDevice>(found.name,
                                      multiprocessors * static_cast<size_t>(blocks) * kThreads);
}

}  // namespace ballpiston
