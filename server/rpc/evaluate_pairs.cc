#include "server/convert/analytic.h"
#include "server/rpc/methods.h"

namespace ballpiston::server {

absl::StatusOr<v1::EvaluatePairsResponse> EvaluatePairs(ServiceContext&, const Call&,
                                                        const v1::EvaluatePairsRequest& request) {
  return EvaluatePairs(request);
}

}  // namespace ballpiston::server
