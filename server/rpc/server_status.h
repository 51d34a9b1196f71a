// The server's numbers at this moment: as the message of GetServerStatus, and as metric families of
// Prometheus.
//
//   grpc_server_*   calls: the names and labels that other gRPC servers use; call_observer.h
//   ballpiston_*    everything else: base units, totals that only grow, no job's id in a label.
//                   Only the metrics of stored jobs have principals as labels
//
// The numbers here belong to the scheduler, the store and others. A scrape therefore copies them
// into a registry of its own. With a permanent registry each number would have to be counted in a
// second place.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "absl/time/time.h"
#include "ballpiston/v1/server.pb.h"
#include "prometheus/metric_family.h"
#include "server/rpc/service_context.h"

namespace ballpiston::server {

inline constexpr size_t kMostPrincipals = 1000;  // as labels

// Both read the store, but do not wait for writes. They hold no lock that a worker needs.

// The totals, and the numbers of each principal that the viewer may see. Without the fields that
// only GetServerStatus adds: rates, limits and the caller.
v1::ServerStatus StatusOf(const ServiceContext& service, const Principal& viewer);

// `certificate_expiry`: empty without TLS.
std::vector<prometheus::MetricFamily> ServerMetrics(const ServiceContext& service,
                                                    std::optional<absl::Time> certificate_expiry);

}  // namespace ballpiston::server
