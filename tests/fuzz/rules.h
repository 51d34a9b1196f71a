// Properties that several targets share. Functions named Require... throw std::exception if the
// property does not hold. Slow checks run for one input in sixteen.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "client/library/error_text.h"
#include "core/geometry/pair_geometry.h"
#include "google/rpc/status.pb.h"
#include "grpcpp/support/status.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/errors.h"
#include "server/convert/spec.h"
#include "server/rpc/request_check.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/questions/checks.h"
#include "tests/server/spec_message.h"

namespace ballpiston::fuzz {

inline constexpr size_t kOneIn = 16;

// Grids with many points are skipped: each point takes time, and many points show nothing new.
inline bool HasManyPoints(const v1::Grid& grid) {
  int points = 1;
  for (const int size :
       {grid.rho_size(), grid.delta_size(), grid.epsilon_size(), grid.exponent_size(),
        grid.cells_size(), grid.temperature_size(), grid.hot_size(), grid.cold_size()}) {
    points *= std::clamp(size, 1, 100);
  }
  return points > 16;
}

inline void RequirePointsThatMakePairs(const EnsembleSpec& spec) {
  const size_t points = PointCount(spec);
  Require(points >= 1 && points <= static_cast<size_t>(kMaxPoints), "points within the limit");
  for (const size_t index : {size_t{0}, points / 2, points - 1}) {
    const PointParameters point = PointAt(spec, index);
    Require(PairGeometry::Create(point[kRho], point[kDelta]).ok(),
            "an accepted point makes a pair");
  }
}

inline void RequireSameAfterConversion(const EnsembleSpec& spec) {
  const v1::EnsembleSpec message = server::SpecMessage(spec);
  const server::CheckedSpec again = server::CheckSpec(message);
  Require(again.violations.empty(), "what was accepted is accepted again");
  Require(server::DeterministicBytes(server::SpecMessage(again.spec)) ==
              server::DeterministicBytes(message),
          "the core's form is exact");
}

// The server can send the error: its details fit into gRPC's trailers, have a reason, and the
// client's library returns the same code and reason.
inline void RequireSendable(const absl::Status& error, const std::string& input) {
  if (!IsOneIn(kOneIn, input)) return;
  const grpc::Status sent = server::GrpcStatus(error);
  Require(!sent.ok(), "an error is not OK");
  Require(sent.error_details().size() <= server::kMaxErrorDetails, "details fit");
  google::rpc::Status details;
  Require(details.ParseFromString(sent.error_details()), "details can be read");
  Require(details.code() == sent.error_code(), "details have the code");
  const absl::Status received = client::FromGrpc(sent);
  Require(received.code() == error.code(), "the client has the code");
  Require(!client::ErrorReason(received).empty(), "the client has a reason");
  Require(!received.message().empty(), "the client has words");
}

// Each violation has a field and a description.
inline void RequireNamed(const std::vector<FieldViolation>& violations) {
  for (const FieldViolation& violation : violations) {
    Require(!violation.field.empty() && !violation.description.empty(), "a violation is described");
  }
}

// An accepted specification has points with valid pairs, and converts to the core's form and to
// bytes and back without a change. A rejected one has violations that can be sent and that name the
// field, the value and what is permitted. True if it was accepted.
inline bool RequireJudged(const v1::EnsembleSpec& spec, const std::string& input) {
  if (HasManyPoints(spec.grid()) && !IsOneIn(kOneIn, input)) return false;
  const server::CheckedSpec checked = server::CheckSpec(spec);
  if (checked.violations.empty()) {
    RequirePointsThatMakePairs(checked.spec);
    if (IsOneIn(kOneIn, input)) RequireSameAfterConversion(checked.spec);
    return true;
  }
  questions::CheckRefusal(spec, checked.violations);
  RequireSendable(server::InvalidSpec(checked.violations), input);
  return false;
}

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
  server::RequestCheck of_next;
  Require(of_next.PageStart(next, kFirst) == start && of_next.ok(),
          "a token gives the start for which it was made");
  v1::ListResultsRequest other;
  other.set_parent("ensembleJobs/another");
  other.set_page_token(next.page_token());
  server::RequestCheck of_other;
  of_other.PageStart(other, kFirst);
  Require(!of_other.ok(), "a token is good for its list alone");
}

}  // namespace ballpiston::fuzz
