// The headers that most tests of the server need: experiments of the core, the store, a server that
// runs in the process of the test, and calls to this server. A test includes this file after the
// header that it tests.
#pragma once

#include "core/engine_version.h"
#include "core/ensemble/chunk_fold.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_shape.h"
#include "server/convert/spec.h"
#include "server/store/job_table.h"
#include "server/store/point_tables.h"
#include "server/store/store.h"
#include "tests/server/calls.h"
#include "tests/server/error_details.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/server/spec_message.h"
#include "tests/server/store_access.h"
#include "tests/server/thread_pool.h"
#include "tests/support/message_text.h"
#include "tests/support/preamble.h"
#include "tools/flows/paper.h"

namespace ballpiston::server {

using v1::EnsembleJob;

}  // namespace ballpiston::server
