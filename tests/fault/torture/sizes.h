// The size of the torture tests. By default each takes five seconds of one core or less, except the
// two tests Kills, which start a server for each failpoint. BALLPISTON_TORTURE=1 in the environment
// (`make torture`) selects the full size, 0.1 a tenth.
#pragma once

namespace ballpiston::torture {

// The share of the full size; 0 in the short form.
double ShareOfFullSize();

// `brief` in the short form; otherwise the share of `full`, at least `brief`.
int Size(int brief, int full);

// Whether to check times. A busy machine may miss them without an error of the server.
bool HoldsToTimes();

}  // namespace ballpiston::torture
