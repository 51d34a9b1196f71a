// The bytes of a specification in the store.
#pragma once

#include <cstddef>
#include <string>

namespace ballpiston::server {

// Two serialized v1::EnsembleSpec; merged, they are the specification. The grid may be large, so a
// list of jobs reads the rest alone.
struct StoredSpec {
  std::string rest;
  std::string grid = {};

  size_t size() const { return rest.size() + grid.size(); }
  bool operator==(const StoredSpec&) const = default;
};

}  // namespace ballpiston::server
