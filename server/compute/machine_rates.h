// Measures the sampling rates of this machine, for the core's predictions of cost.
#pragma once

#include "core/model_choice/machine_rates.h"

namespace ballpiston::server {

// Measures the jump process and the engines on the calling thread, in about 0.3 s. The costs of
// points without samples stay 0: model_ladder.h measures them, because they include the server's
// own work.
MachineRates MeasureSamplingRates();

}  // namespace ballpiston::server
