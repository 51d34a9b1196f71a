// The size of the torture tests: by default five seconds of one core or less each; the full size
// with BALLPISTON_TORTURE=1 in the environment (`make torture`), a tenth with 0.1.
#ifndef BALLPISTON_TESTS_FAULT_TORTURE_SIZES_H_
#define BALLPISTON_TESTS_FAULT_TORTURE_SIZES_H_

namespace ballpiston::torture {

// The share of the full size; 0 in the short form.
double ShareOfFullSize();

// `brief` in the short form; otherwise the share of `full`, at least `brief`.
int Size(int brief, int full);

// Whether to check times. A busy machine may miss them without an error of the server.
bool HoldsToTimes();

}  // namespace ballpiston::torture

#endif  // BALLPISTON_TESTS_FAULT_TORTURE_SIZES_H_
