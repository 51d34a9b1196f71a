// The program of one target under libFuzzer: of the target BALLPISTON_FUZZ_TARGET.
//
//   NAME_fuzz --write_seeds=FOLDER_OF_SEEDS CORPUS   writes the seeds into CORPUS, and ends
//   NAME_fuzz [LIBFUZZER_FLAG...] CORPUS             libFuzzer's own command line
#include <cstring>

#include "google/protobuf/stubs/logging.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/mutation.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

namespace ballpiston::fuzz {
namespace {

constexpr char kWriteSeeds[] = "--write_seeds=";

const FuzzTarget& Target() {
  static const FuzzTarget& target = TargetOf(BALLPISTON_FUZZ_TARGET);
  return target;
}

// Protobuf must not log an error for each of a million inputs.
const google::protobuf::LogSilencer silence;

void WriteSeeds(const std::string& folder, const std::string& corpus) {
  int number = 0;
  for (const std::string& seed : SeedsOf(Target(), folder)) {
    std::ofstream(corpus + "/seed" + std::to_string(number++), std::ios::binary) << seed;
  }
}

size_t MutateInput(uint8_t* data, size_t size, size_t max_size, unsigned seed) {
  const FuzzTarget& target = Target();
  Dice dice(seed);
  if (target.message == nullptr || dice.OneIn(4)) return LLVMFuzzerMutate(data, size, max_size);
  std::string bytes(reinterpret_cast<const char*>(data), size);
  if (!MutateFields(dice, *target.message, bytes) || bytes.size() > max_size) {
    return LLVMFuzzerMutate(data, size, max_size);
  }
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}

}  // namespace
}  // namespace ballpiston::fuzz

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const size_t length = std::strlen(ballpiston::fuzz::kWriteSeeds);
  if (*argc != 3 || std::strncmp((*argv)[1], ballpiston::fuzz::kWriteSeeds, length) != 0) return 0;
  ballpiston::fuzz::WriteSeeds((*argv)[1] + length, (*argv)[2]);
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  ballpiston::fuzz::Target().check({reinterpret_cast<const char*>(data), size});
  return 0;
}

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned seed) {
  return ballpiston::fuzz::MutateInput(data, size, max_size, seed);
}
