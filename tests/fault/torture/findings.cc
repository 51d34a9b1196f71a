#include "tests/fault/torture/findings.h"

#include <cstdio>

namespace ballpiston::torture {
namespace {

constexpr size_t kReported = 20;

void PrintRow(const std::string& section, const std::string& what, const std::string& value) {
  std::printf("| %-32s | %-52s | %19s |\n", section.c_str(), what.c_str(), value.c_str());
}

}  // namespace

Findings::~Findings() {
  for (const auto& [what, count] : counts_) PrintRow(section_, what, absl::StrCat(count));
  for (const auto& [what, value] : notes_) PrintRow(section_, what, value);
}

void Findings::Count(const std::string& what, int64_t by) {
  const std::lock_guard lock(mutex_);
  counts_[what] += by;
}

void Findings::Note(const std::string& what, const std::string& value) {
  const std::lock_guard lock(mutex_);
  notes_[what] = value;
}

void Findings::Wrong(const std::string& what) {
  const std::lock_guard lock(mutex_);
  wrong_.push_back(what);
}

int64_t Findings::count(const std::string& what) const {
  const std::lock_guard lock(mutex_);
  const auto found = counts_.find(what);
  return found == counts_.end() ? 0 : found->second;
}

std::string Findings::Report() {
  const std::lock_guard lock(mutex_);
  counts_["promises broken"] = static_cast<int64_t>(wrong_.size());
  std::string text;
  for (size_t i = 0; i < wrong_.size() && i < kReported; ++i)
    absl::StrAppend(&text, wrong_[i], "\n");
  if (wrong_.size() > kReported) absl::StrAppend(&text, "and ", wrong_.size() - kReported, " more");
  return text;
}

}  // namespace ballpiston::torture
