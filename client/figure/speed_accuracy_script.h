// The gnuplot script of the speed-accuracy figure. It reads the CSV file beside it and writes
// speed-accuracy.svg, so that it can be changed and run again by hand.
#ifndef BALLPISTON_CLIENT_FIGURE_SPEED_ACCURACY_SCRIPT_H_
#define BALLPISTON_CLIENT_FIGURE_SPEED_ACCURACY_SCRIPT_H_

#include <string>
#include <vector>

#include "client/figure/method_measurement.h"
#include "client/figure/speed_accuracy_figure.h"

namespace ballpiston::client {

std::string SpeedAccuracyScript(const SpeedAccuracyQuestion& question,
                                const std::vector<MethodMeasurement>& measurements);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_FIGURE_SPEED_ACCURACY_SCRIPT_H_
