// Properties that several targets share. All functions throw as Require does. Slow checks run for
// one input in sixteen.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/spec.pb.h"
#include "core/ensemble/ensemble_spec.h"
#include "server/rpc/request_check.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {

// The server can send the error: its details fit into gRPC's trailers, have a reason, and the
// client's library returns the same code and reason.
void RequireSendable(const absl::Status& error, const std::string& input);

// Each violation names a field that begins with `prefix`, and has a description.
void RequireNamed(const std::vector<FieldViolation>& violations, const std::string& prefix);

// An accepted specification has points with valid pairs, and converts to the core's form and to
// bytes and back without a change. A rejected one has named violations that can be sent. True if it
// was accepted.
bool RequireJudged(const v1::EnsembleSpec& spec, const std::string& input);

// The size and the token of a page. An accepted page has a size and a start, and a token of this
// start gives the same start. A token is good for no other list. For a rejected page the error can
// be sent.
template <typename Request>
void RequirePage(const Request& request, const std::string& input) {
  constexpr int64_t kFirst = 17;
  server::RequestCheck check;
  const int size = check.PageSize(request.page_size());
  const int64_t start = check.PageStart(request, kFirst);
  if (!check.ok()) return RequireSendable(check.status(), input);
  Require(size >= 1 && size <= 1000, "a page has a size");
  Require(start >= 0, "a page has a start");
  Request next = request;
  next.set_page_token(server::NextPageToken(request, start));
  Require(server::RequestCheck().PageStart(next, kFirst) == start, "a token leads back");
  v1::ListResultsRequest other;
  other.set_parent("ensembleJobs/another");
  other.set_page_token(next.page_token());
  server::RequestCheck of_other;
  of_other.PageStart(other, kFirst);
  Require(!of_other.ok(), "a token is good for its list alone");
}

}  // namespace ballpiston::fuzz
