#include "tests/fault/store/power_cut.h"

#include "tests/support/dice.h"

namespace ballpiston::server {
namespace {

using Kind = DiskOperation::Kind;

constexpr size_t kDiskSectorBytes = 512;

// Whether each operation is safe. Goes backwards: a sync makes all earlier operations of its file
// safe, back to a failed sync of the file.
std::vector<bool> SafeOperations(const std::vector<DiskOperation>& operations, size_t cut) {
  std::vector<bool> safe(operations.size(), false);
  std::map<int, bool> synced;  // by file: whether the next sync succeeded
  bool folder = false;
  for (size_t i = cut; i-- > 0;) {
    const DiskOperation& operation = operations[i];
    const bool is_name = operation.kind == Kind::kCreate || operation.kind == Kind::kDelete;
    if (operation.kind == Kind::kSync) synced[operation.file] = !operation.refused;
    if (operation.folder && !operation.refused) folder = true;
    safe[i] = is_name ? folder : synced[operation.file];
  }
  return safe;
}

// The files that a power cut leaves, built up operation by operation.
class Leftover {
 public:
  explicit Leftover(const DiskFiles& initial) {
    int number = 0;
    for (const auto& [path, contents] : initial) {  // as FaultDisk numbers them
      names_[path] = number;
      contents_[number++] = contents;
    }
  }

  void Apply(const DiskOperation& operation) {
    switch (operation.kind) {
      case Kind::kCreate:
        names_[operation.path] = operation.file;
        break;
      case Kind::kDelete:
        names_.erase(operation.path);
        break;
      case Kind::kTruncate:
        contents_[operation.file].resize(static_cast<size_t>(operation.offset));
        break;
      case Kind::kWrite:
        Write(operation, 0, operation.data.size());
        break;
      case Kind::kSync:
        break;
    }
  }

  // Bytes [from, to) of a write.
  void Write(const DiskOperation& write, size_t from, size_t to) {
    std::string& contents = contents_[write.file];
    const size_t offset = static_cast<size_t>(write.offset) + from;
    contents.resize(std::max(contents.size(), offset + to - from));
    contents.replace(offset, to - from, write.data, from, to - from);
  }

  DiskFiles Files() {
    DiskFiles files;
    for (const auto& [path, number] : names_) files[path] = contents_[number];
    return files;
  }

 private:
  std::map<std::string, int> names_;
  std::map<int, std::string> contents_;
};

void ApplySectors(const DiskOperation& write, bool torn, Dice& dice, Leftover& leftover) {
  for (size_t from = 0; from < write.data.size();) {
    const size_t in_sector = (static_cast<size_t>(write.offset) + from) % kDiskSectorBytes;
    const size_t to = std::min(write.data.size(), from + kDiskSectorBytes - in_sector);
    if (dice.OneIn(2)) {
      const bool half = torn && dice.OneIn(4);
      leftover.Write(write, from, half ? from + (to - from) / 2 : to);
    }
    from = to;
  }
}

void ApplySome(const DiskOperation& operation, bool torn, Dice& dice, Leftover& leftover) {
  if (operation.kind == Kind::kWrite) {
    ApplySectors(operation, torn, dice, leftover);
  } else if (dice.OneIn(2)) {
    leftover.Apply(operation);
  }
}

}  // namespace

DiskFiles AfterPowerCut(const DiskFiles& initial, const std::vector<DiskOperation>& operations,
                        size_t cut, Survival survival, uint64_t seed) {
  const size_t begun = std::min(cut + 1, operations.size());
  const std::vector<bool> safe = SafeOperations(operations, std::min(cut, operations.size()));
  std::vector<size_t> unsafe;
  for (size_t i = 0; i < begun; ++i) {
    const bool counts = operations[i].kind != Kind::kSync && !operations[i].refused;
    if (counts && !safe[i]) unsafe.push_back(i);
  }
  Dice dice(seed * 1'000'003 + cut);
  const size_t moment = unsafe.empty() ? 0 : unsafe[dice.Below(unsafe.size())];

  Leftover leftover(initial);
  for (size_t i = 0; i < begun; ++i) {
    const DiskOperation& operation = operations[i];
    if (operation.refused) continue;
    if (safe[i] || survival == Survival::kEverything) {
      leftover.Apply(operation);
    } else if (survival == Survival::kOldest || survival == Survival::kNewest) {
      if (survival == Survival::kOldest ? i < moment : i >= moment) leftover.Apply(operation);
    } else if (survival != Survival::kNothing) {
      ApplySome(operation, survival == Survival::kTornSectors, dice, leftover);
    }
  }
  return leftover.Files();
}

}  // namespace ballpiston::server
