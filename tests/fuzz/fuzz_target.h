// A fuzz target: a kind of input from outside, the code that reads it, and the properties that must
// hold for the result.
//
// Each of the files below ends in a table of its targets. The program fuzzer (libfuzzer.cc) runs
// one with libFuzzer. fuzz_test (seeds_test.cc) runs the seeds of all, and some thousands of
// changed ones, with any compiler.
//
// A check is a function of its input alone, quick (below 50 us for nearly every input), and never
// computes a block.
#pragma once

#include "google/protobuf/message.h"
#include "google/protobuf/text_format.h"
#include "tests/support/dice.h"
#include "tests/support/preamble.h"

namespace ballpiston::fuzz {

struct FuzzTarget {
  std::string name;                                    // also of the folder of its seeds
  void (*check)(const std::string& input);             // throws as Require does
  const google::protobuf::Message* message = nullptr;  // the input's message; null: text
  std::vector<std::string> (*made_seeds)() = nullptr;  // besides the files
};

// A check of the message that the input spells. It holds for any other input.
template <typename Message, void (*check)(const Message& message, const std::string& bytes)>
FuzzTarget OfMessage(const std::string& name, std::vector<std::string> (*made_seeds)() = nullptr) {
  const auto check_bytes = [](const std::string& bytes) {
    Message message;
    if (message.ParseFromString(bytes)) check(message, bytes);
  };
  return {name, check_bytes, &Message::default_instance(), made_seeds};
}

std::vector<FuzzTarget> RequestTargets();     // requests.cc
std::vector<FuzzTarget> StoredTargets();      // stored_records.cc
std::vector<FuzzTarget> ServerTextTargets();  // server_texts.cc
std::vector<FuzzTarget> ClientTargets();      // client_texts.cc

// All of them.
inline const std::vector<FuzzTarget>& Targets() {
  static std::vector<FuzzTarget> all;
  if (!all.empty()) return all;
  for (const auto& some :
       {RequestTargets(), StoredTargets(), ServerTextTargets(), ClientTargets()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

// Throws std::logic_error unless `is_so`.
inline void Require(bool is_so, const char* what) {
  if (!is_so) throw std::logic_error(what);
}

// Selects one input in n for slow checks. The selection depends only on the input.
inline bool IsOneIn(size_t n, const std::string& input) {
  return Dice(std::hash<std::string>()(input)).OneIn(n);
}

// The seeds: the files of FOLDER/NAME, and those that the target makes itself. Files *.textproto
// are converted to the bytes of their message. Throws if a .textproto file is not a text of this
// message, or if a file is empty or cannot be read.
inline std::vector<std::string> SeedsOf(const FuzzTarget& target, const std::string& folder) {
  const std::filesystem::path of_target = folder + "/" + target.name;
  std::set<std::filesystem::path> paths;
  if (exists(of_target)) {
    for (const auto& entry : std::filesystem::directory_iterator(of_target)) paths.insert(entry);
  }
  std::vector<std::string> seeds;
  for (const std::filesystem::path& path : paths) {
    seeds.push_back(Contents(path));
    if (seeds.back().empty()) throw std::runtime_error("cannot read " + path.string());
    if (path.extension() != ".textproto") continue;
    const std::unique_ptr<google::protobuf::Message> message(target.message->New());
    if (!google::protobuf::TextFormat::ParseFromString(seeds.back(), message.get())) {
      throw std::runtime_error(path.string() + " is not a text of a " + message->GetTypeName());
    }
    seeds.back() = message->SerializeAsString();
  }
  if (target.made_seeds == nullptr) return seeds;
  for (std::string& seed : target.made_seeds()) seeds.push_back(std::move(seed));
  return seeds;
}

}  // namespace ballpiston::fuzz
