// All targets under libFuzzer. The environment variable FUZZ_TARGET names one.
//
//   fuzzer --list                                prints the targets' names
//   fuzzer --write_seeds=FOLDER_OF_SEEDS CORPUS  writes the target's seeds into CORPUS, and ends
//   fuzzer [LIBFUZZER_FLAG...] CORPUS            libFuzzer's own command line
#include "google/protobuf/stubs/logging.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/mutation.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

namespace ballpiston::fuzz {
namespace {

constexpr std::string_view kWriteSeeds = "--write_seeds=";

const FuzzTarget& Target() {
  static const std::string name = std::getenv("FUZZ_TARGET");
  static const auto target = std::ranges::find(Targets(), name, &FuzzTarget::name);
  if (target == Targets().end()) throw std::out_of_range("no fuzz target " + name);
  return *target;
}

// Protobuf must not log an error for each of a million inputs.
const google::protobuf::LogSilencer silence;

void WriteSeeds(std::string_view folder, const std::string& corpus) {
  int number = 0;
  for (const std::string& seed : SeedsOf(Target(), std::string(folder))) {
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
  const std::string_view first = *argc > 1 ? (*argv)[1] : "";
  if (first == "--list") {
    for (const auto& target : ballpiston::fuzz::Targets()) std::cout << target.name << "\n";
  } else if (std::getenv("FUZZ_TARGET") == nullptr) {
    std::cerr << "set FUZZ_TARGET; see --list\n";
    std::exit(1);
  } else if (*argc == 3 && first.starts_with(ballpiston::fuzz::kWriteSeeds)) {
    ballpiston::fuzz::WriteSeeds(first.substr(first.find('=') + 1), (*argv)[2]);
  } else {
    return 0;
  }
  std::cout.flush();
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
