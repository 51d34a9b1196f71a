// The server's numbers as metric families of Prometheus: base units, totals that only grow, no
// job's id in a label. Only the metrics of usage name principals, at most kMostPrincipals.
//
//   grpc_server_*   calls: the names and labels that other gRPC servers use; call_statistics.h
//   ballpiston_*    everything else
//
// The numbers here belong to the scheduler, the store and others, which the API's status reads too.
// A scrape therefore copies one snapshot into a registry of its own. With a permanent registry each
// number would have to be counted in a second place.
#pragma once

#include <cstddef>
#include <vector>

#include "prometheus/metric_family.h"
#include "server/observability/server_snapshot.h"

namespace ballpiston::server {

inline constexpr size_t kMostPrincipals = 1000;

std::vector<prometheus::MetricFamily> ServerMetrics(const ServerSnapshot& server);

}  // namespace ballpiston::server
