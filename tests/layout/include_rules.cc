#include "tests/layout/include_rules.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace ballpiston {
namespace {

using Prefixes = std::vector<std::string_view>;

struct Rule {
  std::string_view folder;
  Prefixes may_include;   // folders of the project, then libraries
  bool operating_system;  // threads, clocks and the headers of POSIX
};

// The first row whose folder contains the file applies.
const std::vector<Rule>& Rules() {
  static const auto* const rules = new std::vector<Rule>{
      {"core/arithmetic/", {"core/arithmetic/", "absl/", "boost/"}, false},
      {"core/geometry/", {"core/arithmetic/", "core/geometry/", "Eigen/", "absl/"}, false},
      {"core/closed_form/",
       {"core/arithmetic/", "core/geometry/", "core/closed_form/", "Eigen/", "absl/"},
       false},
      {"core/sampling/",
       {"core/arithmetic/", "core/geometry/", "core/sampling/", "Eigen/", "absl/", "Random123/"},
       false},
      {"core/billiard/",
       {"core/arithmetic/", "core/geometry/", "core/closed_form/", "core/sampling/",
        "core/billiard/", "Eigen/", "absl/", "hwy/"},
       false},
      {"core/gpu/",
       {"core/arithmetic/", "core/geometry/", "core/closed_form/", "core/sampling/",
        "core/billiard/", "core/gpu/", "Eigen/", "absl/"},
       false},
      {"core/markov/",
       {"core/arithmetic/", "core/geometry/", "core/closed_form/", "core/sampling/", "core/markov/",
        "core/statistics/", "Eigen/", "absl/", "hwy/"},
       false},
      {"core/conductivity/", {"core/arithmetic/", "core/conductivity/", "hwy/"}, false},
      {"core/statistics/", {"core/arithmetic/", "core/statistics/", "Eigen/", "absl/"}, false},
      {"core/gas/",
       {"core/arithmetic/", "core/geometry/", "core/closed_form/", "core/sampling/",
        "core/billiard/", "core/markov/", "core/conductivity/", "core/statistics/", "core/gas/",
        "Eigen/", "absl/", "hwy/"},
       false},
      {"core/ensemble/",
       {"core/arithmetic/", "core/geometry/", "core/sampling/", "core/billiard/",
        "core/statistics/", "core/gas/gas_shape.h", "core/ensemble/", "absl/"},
       false},
      {"core/experiment/",
       {"core/arithmetic/", "core/geometry/", "core/closed_form/", "core/sampling/",
        "core/billiard/", "core/markov/", "core/conductivity/", "core/statistics/", "core/gas/",
        "core/ensemble/", "core/experiment/", "Eigen/", "absl/"},
       false},
      {"core/model_choice/", {"core/", "Eigen/", "absl/"}, false},
      {"core/engine_version.h", {}, false},
      {"core/examples/", {"ballpiston/core/"}, false},  // programs outside the project
      {"server/command_line/", {"server/", "absl/", "CLI/"}, true},
      {"server/status/",
       {"server/status/", "server/mutex.h", "google/", "absl/", "grpc/", "grpcpp/", "prometheus/"},
       true},
      {"server/convert/",
       {"core/", "server/convert/", "ballpiston/v1/", "ballpiston/storage/", "google/", "absl/",
        "grpcpp/support/status.h"},
       true},
      {"server/door/",
       {"server/door/", "server/convert/errors.h", "server/status/",
        "server/store/data_directory.h", "server/store/folder_sync.h", "server/mutex.h",
        "server/sha256.h", "absl/", "grpc/", "grpcpp/", "openssl/"},
       true},
      {"server/store/",
       {"core/model_choice/limit_error.h", "server/store/", "server/convert/", "server/status/",
        "server/host.h", "server/mutex.h", "ballpiston/v1/", "google/", "absl/", "sqlite3.h"},
       true},
      {"server/compute/",
       {"core/", "server/compute/", "server/convert/", "server/store/", "server/status/",
        "server/fatal_signals.h", "server/host.h", "server/machine_memory.h", "server/mutex.h",
        "server/processor_time.h", "ballpiston/storage/", "absl/"},
       true},
      {"server/worker/",
       {"core/", "server/worker/", "server/convert/deterministic_bytes.h",
        "server/convert/fold_record.h", "server/fatal_signals.h", "server/machine_memory.h",
        "server/status/failpoint.h", "server/processor_time.h", "server/compute/lease.h",
        "server/store/folder_sync.h", "ballpiston/storage/", "absl/", "CLI/", "hwy/", "xxhash.h"},
       true},
      {"server/cluster/",
       {"core/", "server/cluster/", "server/compute/", "server/worker/", "server/convert/",
        "server/status/", "server/host.h", "server/mutex.h", "server/periodic_thread.h",
        "ballpiston/storage/", "absl/"},
       true},
      {"server/book/",
       {"core/", "server/book/", "server/compute/", "server/store/", "server/convert/",
        "server/door/", "server/status/", "server/limits.h", "server/host.h", "server/mutex.h",
        "server/sha256.h", "ballpiston/v1/", "ballpiston/storage/", "google/", "absl/"},
       true},
      {"server/sha256.cc", {"server/sha256.h", "openssl/"}, false},
      {"server/",
       {"core/", "server/", "ballpiston/v1/", "ballpiston/storage/", "google/", "absl/", "grpc/",
        "grpcpp/", "sqlite3.h", "prometheus/"},
       true},
      {"client/web/",
       {"client/web/", "client/library/", "client/output/", "ballpiston/v1/", "google/", "absl/",
        "grpcpp/", "httplib.h"},
       true},
      {"client/examples/", {"ballpiston/client/"}, false},
      {"client/output/",
       {"client/library/", "client/output/", "ballpiston/v1/", "ballpiston/file/v1/", "google/",
        "absl/", "zip.h"},
       true},
      {"client/",
       {"client/", "ballpiston/v1/", "google/", "absl/", "grpc/", "grpcpp/", "CLI/"},
       true},
      {"tools/conductivity/",
       {"core/conductivity/conductivity.h", "tools/conductivity/", "Eigen/", "absl/"},
       false},
      {"tools/flows/", {"core/", "tools/flows/", "Eigen/", "boost/", "hwy/"}, false},
      {"tools/method_comparison/",
       {"core/", "server/processor_time.h", "tools/method_comparison/", "tools/flows/", "Eigen/",
        "absl/", "CLI/"},
       true},
      {"tools/stability/",
       {"core/", "tools/stability/", "tools/flows/", "Eigen/", "absl/", "hwy/"},
       true},
      {"tests/support/", {"tests/support/", "absl/", "gtest/", "gmock/"}, true},
      {"tests/core/",
       {"core/", "tools/flows/", "tests/core/", "tests/oracle/", "tests/support/", "Eigen/",
        "absl/", "hwy/", "gtest/", "gmock/"},
       true},
      {"tests/statistical/",
       {"core/", "tools/flows/", "tests/core/", "tests/oracle/", "tests/statistical/",
        "tests/support/", "Eigen/", "absl/", "hwy/", "gtest/", "gmock/"},
       true},
      {"tests/oracle/",
       {"core/", "tools/flows/", "tests/oracle/", "tests/support/", "Eigen/", "absl/", "hwy/",
        "gtest/"},
       true},
      {"tests/benchmark/",
       {"core/", "server/", "tools/flows/", "tests/benchmark/", "tests/oracle/",
        "tests/server/compute/", "tests/server/factory_opener.h", "tests/server/worker/",
        "tests/simulation/", "tests/support/", "absl/", "hwy/", "benchmark/"},
       true},
      {"tests/sanitizer/",
       {"server/mutex.h", "ballpiston/v1/", "absl/", "grpc/", "grpcpp/", "sanitizer/"},
       true},
      {"tests/tools/",
       {"core/", "tools/", "tests/tools/", "tests/core/", "tests/oracle/", "tests/support/",
        "Eigen/", "absl/", "gtest/", "gmock/"},
       true},
      {"tests/client/",
       {"client/", "tests/client/", "tests/support/", "ballpiston/v1/", "ballpiston/file/v1/",
        "google/", "absl/", "grpc/", "zip.h", "grpcpp/", "CLI/", "gtest/", "gmock/"},
       true},
      {"tests/server/worker/",
       {"core/", "server/convert/fold_record.h", "server/worker/lease_record.h", "server/worker/",
        "tests/server/worker/", "tests/support/", "ballpiston/storage/", "absl/", "gtest/",
        "gmock/"},
       true},
      {"tests/",
       {"core/", "server/", "client/", "tests/", "ballpiston/v1/", "ballpiston/storage/", "google/",
        "absl/", "grpc/", "grpcpp/", "sqlite3.h", "openssl/", "prometheus/", "Eigen/", "gtest/",
        "gmock/", "benchmark/", "httplib.h"},
       true},
  };
  return *rules;
}

bool StartsWithAny(std::string_view path, const Prefixes& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](std::string_view prefix) { return path.starts_with(prefix); });
}

// Whether a header of C++ or Abseil has threads or clocks.
bool IsThreadOrClock(std::string_view include) {
  static constexpr std::array<std::string_view, 6> kStandard = {
      "thread", "future", "mutex", "condition_variable", "chrono", "ctime"};
  return std::find(kStandard.begin(), kStandard.end(), include) != kStandard.end() ||
         StartsWithAny(include, {"absl/synchronization/", "absl/time/"});
}

// <vector>, <cmath>, ...
bool IsStandardHeader(std::string_view include) {
  return include.find_first_of("/.") == std::string_view::npos;
}

// <unistd.h>, <sys/stat.h>, <thread>, ...
bool IsOperatingSystemHeader(std::string_view include) {
  if (include == "sqlite3.h") return false;
  return include.find('/') == std::string_view::npos ||
         StartsWithAny(include, {"sys/", "arpa/", "netinet/"});
}

bool IsAllowed(const Rule& rule, std::string_view include) {
  if (IsThreadOrClock(include) && !rule.operating_system) return false;
  return IsStandardHeader(include) || StartsWithAny(include, rule.may_include) ||
         (rule.operating_system && IsOperatingSystemHeader(include));
}

// The core's physics and the API's messages meet in server/convert only.
bool JoinsPhysicsAndMessages(std::string_view path, const std::vector<std::string>& includes) {
  if (!path.starts_with("server/") || path.starts_with("server/convert/")) return false;
  const auto some = [&](std::string_view prefix) {
    return std::any_of(includes.begin(), includes.end(),
                       [&](const std::string& include) { return include.starts_with(prefix); });
  };
  return some("core/") && some("ballpiston/v1/");
}

void SkipBlanks(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
}

// Removes `word` and the blanks before it from the text if the text begins with them.
bool Skip(std::string_view word, std::string_view& text) {
  SkipBlanks(text);
  if (!text.starts_with(word)) return false;
  text.remove_prefix(word.size());
  return true;
}

// The file that the line includes; empty if none.
std::string IncludedBy(std::string_view line) {
  if (!Skip("#", line) || !Skip("include", line)) return "";
  if (!Skip("<", line) && !Skip("\"", line)) return "";
  return std::string(line.substr(0, line.find_first_of(">\"")));
}

}  // namespace

std::vector<std::string> IncludesOf(std::string_view text) {
  std::vector<std::string> found;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    const std::string include = IncludedBy(line);
    if (!include.empty()) found.push_back(include);
  }
  return found;
}

std::vector<std::string> WrongIncludes(std::string_view path, std::string_view text) {
  const std::string file(path);
  const auto rule = std::find_if(Rules().begin(), Rules().end(),
                                 [&](const Rule& row) { return path.starts_with(row.folder); });
  if (rule == Rules().end()) return {file + " lies in a folder without a rule"};

  std::vector<std::string> wrong;
  const std::vector<std::string> includes = IncludesOf(text);
  for (const std::string& include : includes) {
    if (!IsAllowed(*rule, include)) wrong.push_back(file + " may not include " + include);
  }
  if (JoinsPhysicsAndMessages(path, includes)) {
    wrong.push_back(file + " includes core/ and ballpiston/v1/; only server/convert/ may");
  }
  return wrong;
}

}  // namespace ballpiston
