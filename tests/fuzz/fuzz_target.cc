#include "tests/fuzz/fuzz_target.h"

#include "google/protobuf/text_format.h"
#include "tests/fuzz/mutation.h"

namespace ballpiston::fuzz {
namespace {

namespace fs = std::filesystem;

std::string TextOf(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::runtime_error("cannot read " + path.string());
  return text.str();
}

std::string BytesSpelledBy(const fs::path& path, const google::protobuf::Message& kind) {
  const std::unique_ptr<google::protobuf::Message> message(kind.New());
  if (!google::protobuf::TextFormat::ParseFromString(TextOf(path), message.get())) {
    throw std::runtime_error(path.string() + " does not spell a " + kind.GetTypeName());
  }
  return message->SerializeAsString();
}

}  // namespace

const std::vector<FuzzTarget>& Targets() {
  static std::vector<FuzzTarget> all;
  if (!all.empty()) return all;
  for (const auto& some :
       {RequestTargets(), StoredTargets(), ServerTextTargets(), ClientTargets()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

const FuzzTarget& TargetOf(const std::string& name) {
  for (const FuzzTarget& target : Targets()) {
    if (target.name == name) return target;
  }
  throw std::out_of_range("no fuzz target " + name);
}

void Require(bool is_so, const char* what) {
  if (!is_so) throw std::logic_error(what);
}

bool IsOneIn(size_t n, const std::string& input) {
  return Dice(std::hash<std::string>()(input)).OneIn(n);
}

std::vector<std::string> SeedsOf(const FuzzTarget& target, const std::string& folder) {
  std::vector<fs::path> paths;
  if (fs::exists(fs::path(folder) / target.name)) {
    for (const auto& entry : fs::directory_iterator(fs::path(folder) / target.name)) {
      paths.push_back(entry.path());
    }
  }
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> seeds;
  for (const fs::path& path : paths) {
    const bool spelled = path.extension() == ".textproto";
    seeds.push_back(spelled ? BytesSpelledBy(path, *target.message) : TextOf(path));
  }
  if (target.made_seeds == nullptr) return seeds;
  for (std::string& seed : target.made_seeds()) seeds.push_back(std::move(seed));
  return seeds;
}

}  // namespace ballpiston::fuzz
