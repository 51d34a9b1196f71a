// Panel d of the speed-accuracy figure: relative error of the relaxation time against work, at each
// delta in its colour, by the billiard, the jump process and the spectrum. Where the latter two may
// stand for the billiard: limit_floor.h.
#ifndef BALLPISTON_CLIENT_FIGURE_RELAXATION_PANEL_H_
#define BALLPISTON_CLIENT_FIGURE_RELAXATION_PANEL_H_

#include <string>
#include <vector>

#include "client/figure/method_measurement.h"

namespace ballpiston::client {

// The panel and its legend, as a part of the figure's gnuplot script: after its head, in a
// multiplot. Empty if no relaxation time was measured.
std::string RelaxationPanelScript(const std::vector<MethodMeasurement>& measurements);
std::string RelaxationLegendScript(const std::vector<MethodMeasurement>& measurements);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_FIGURE_RELAXATION_PANEL_H_
