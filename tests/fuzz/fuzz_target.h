// A fuzz target: a kind of bytes that come from outside, what the programs do to read them, and
// what has to hold of whatever they make of it.
//
// Each target has a file of its own, which ends in
//   const Registration kStoredSpec({.name = "stored_spec", .check = CheckStoredSpec, ...});
// The same file makes two programs: NAME_fuzz with libFuzzer (libfuzzer.cc), and a part of
// fuzz_test (seeds_test.cc), which runs the seeds and some thousands of changed ones with any
// compiler.
//
// A check is a function of its input alone, quick (below 50 us for nearly every input), and never
// computes a block.
#ifndef BALLPISTON_TESTS_FUZZ_FUZZ_TARGET_H_
#define BALLPISTON_TESTS_FUZZ_FUZZ_TARGET_H_

#include <cstddef>
#include <string>
#include <vector>

#include "google/protobuf/message.h"

namespace ballpiston::fuzz {

struct FuzzTarget {
  std::string name;                                    // of the folder of its seeds, too
  void (*check)(const std::string& input);             // throws what Require does
  const google::protobuf::Message* message = nullptr;  // whose bytes the input is; null: text
  std::vector<std::string> (*made_seeds)() = nullptr;  // beside those in files
};

struct Registration {
  explicit Registration(FuzzTarget target);
};

// Of this program.
const std::vector<FuzzTarget>& Targets();

// Throws std::logic_error unless it is so.
void Require(bool is_so, const char* what);

// Whether this input is one of the one in n that a slow check is made of: the same ones every time.
bool IsOneIn(size_t n, const std::string& input);

// Inputs to begin with: the files of FOLDER/NAME, those called *.textproto as the bytes of the
// message that they spell, and what the target makes itself. Throws if a file cannot be read.
std::vector<std::string> SeedsOf(const FuzzTarget& target, const std::string& folder);

}  // namespace ballpiston::fuzz

#endif  // BALLPISTON_TESTS_FUZZ_FUZZ_TARGET_H_
