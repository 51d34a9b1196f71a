// Exceptions of a point's experiment as the status that ends its run.
#pragma once

#include <cstddef>
#include <exception>
#include <new>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {

// Runs `step`, which returns a status, and turns what it throws into a status.
template <typename Step>
absl::Status Guarded(size_t point, Step step) {
  try {
    return step();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat("point ", point, ": out of memory"));
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("point ", point, ": ", error.what()));
  } catch (...) {
    return absl::InternalError(absl::StrCat("point ", point, ": unknown exception"));
  }
}

}  // namespace ballpiston::server
