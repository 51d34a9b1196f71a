#include "tests/simulation/life.h"

#include "server/host.h"
#include "tests/fault/store/fault_disk.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"

namespace ballpiston::server {
namespace {

constexpr int kThreads = 2;
constexpr std::chrono::seconds kBetweenLimits(1);

Store::Options StoreOptions() {
  Store::Options options;
  options.readers = 2;  // so that calls wait for one
  options.reserve_bytes = size_t{256} << 10;
  return options;
}

}  // namespace

Life::Life(Machine& machine, FakeFiles* shared, const std::string& own_folder,
           std::function<void()> crash)
    : machine_(machine),
      name_(absl::StrCat("life", machine.Bits())),
      crash_(std::move(crash)),
      crashes_(std::make_shared<CrashRecord>(own_folder, OutOfMemoryKills())),
      opener_(ToyExperiments(machine,
                             [this] {
                               if (!is_over_ && crash_ != nullptr) crash_();
                             })),
      scheduler_(std::make_unique<Scheduler>(opener_, kThreads,
                                             SchedulerOptions{.least_seconds_elsewhere = 0})),
      threads_(std::make_unique<ThreadExecutor>(*scheduler_, kThreads,
                                                std::numeric_limits<double>::infinity(), crashes_)),
      cluster_(shared == nullptr ? nullptr
                                 : std::make_unique<SimulatedCluster>(
                                       machine, *scheduler_, *shared,
                                       [this] { return store_->Flush(); }, crash_ != nullptr)) {
  status_ = Start();
}

absl::Status Life::Start() {
  absl::StatusOr<std::unique_ptr<Store>> store = Store::Open(kStorePath, StoreOptions());
  if (!store.ok()) return store.status();
  store_ = *std::move(store);
  book_ = std::make_unique<JobBook>(*store_, Limits(), *scheduler_, crashes_);
  const absl::Status resumed = book_->Resume();
  if (!resumed.ok()) return resumed;
  if (cluster_ != nullptr) cluster_->Start();
  threads_->Start();
  limits_ =
      std::make_unique<PeriodicThread>(kBetweenLimits, [this] { book_->KeepLimits(WallNow()); });
  return absl::OkStatus();
}

Life::~Life() {
  if (book_ != nullptr) book_->Shutdown();
  limits_.reset();
  threads_.reset();
  cluster_.reset();
  if (store_ != nullptr) store_->Flush().IgnoreError();
  if (store_ != nullptr) store_->Close();
  book_.reset();
}

}  // namespace ballpiston::server
