// A fuzz target: a kind of input from outside, the code that reads it, and the properties that must
// hold for the result.
//
// Each target has a file of its own, which ends in
//   const Registration kStoredSpec({.name = "stored_spec", .check = CheckStoredSpec, ...});
// The same file makes two programs: NAME_fuzz with libFuzzer (libfuzzer.cc), and a part of
// fuzz_test (seeds_test.cc), which runs the seeds and some thousands of changed ones with any
// compiler.
//
// A check is a function of its input alone, quick (below 50 us for nearly every input), and never
// computes a block.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "google/protobuf/message.h"

namespace ballpiston::fuzz {

struct FuzzTarget {
  std::string name;                                    // also of the folder of its seeds
  void (*check)(const std::string& input);             // throws as Require does
  const google::protobuf::Message* message = nullptr;  // the input's message; null: text
  std::vector<std::string> (*made_seeds)() = nullptr;  // besides the files
};

struct Registration {
  explicit Registration(FuzzTarget target);
};

// All targets of this program.
const std::vector<FuzzTarget>& Targets();

// Throws std::logic_error unless `is_so`.
void Require(bool is_so, const char* what);

// Selects one input in n for slow checks. The selection depends only on the input.
bool IsOneIn(size_t n, const std::string& input);

// The seeds: the files of FOLDER/NAME, and those that the target makes itself. Files *.textproto
// are converted to the bytes of their message. Throws if a file cannot be read.
std::vector<std::string> SeedsOf(const FuzzTarget& target, const std::string& folder);

}  // namespace ballpiston::fuzz
